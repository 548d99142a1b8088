// SPDX-License-Identifier: Apache-2.0
// LAS 1.0 to 1.4 (ASPRS, "LAS Specification 1.4 - R15"): a header with scales and offsets, then
// records that begin with x, y and z as whole numbers. Everything is little-endian.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "io/bytes.hpp"
#include "io/cloud_rows.hpp"
#include "io/point_cloud.hpp"

namespace surefoot::io {
namespace {

// Table 3, public header block.
constexpr std::size_t kVersionMinor = 25;
constexpr std::size_t kHeaderSize = 94;
constexpr std::size_t kPointsAt = 96;
constexpr std::size_t kRecordCount = 100;  ///< of variable length records
constexpr std::size_t kFormat = 104;
constexpr std::size_t kRecordBytes = 105;
constexpr std::size_t kPoints32 = 107;
constexpr std::size_t kScales = 131;
constexpr std::size_t kOffsets = 155;
constexpr std::size_t kPoints64 = 247;  ///< from 1.4 on
constexpr std::size_t kSmallestHeader = 227;
constexpr std::size_t kHeader14 = 375;

struct RecordFormat {
    std::size_t bytes;   ///< of the fields below
    std::size_t colour;  ///< where red begins; 0 = no colours
};
// Tables 7 to 17.
constexpr std::array<RecordFormat, 11> kFormats = {{{20, 0},
                                                    {28, 0},
                                                    {26, 20},
                                                    {34, 28},
                                                    {57, 0},
                                                    {63, 28},
                                                    {30, 0},
                                                    {36, 30},
                                                    {38, 30},
                                                    {59, 0},
                                                    {67, 30}}};
constexpr std::size_t kIntensity = 12;
constexpr std::uint8_t kCompressed = 0xC0;  ///< bits that LAZ sets in the format

struct Header {
    std::size_t header_bytes = 0;
    std::size_t points_at = 0;
    std::size_t record_bytes = 0;
    std::size_t format = 0;
    std::uint64_t points = 0;
    Eigen::Vector3d scale = Eigen::Vector3d::Ones();
    Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();
};

Error damaged(const std::string& file, const std::string& what) {
    return input_error(fmt::format("{}: {}", file, what));
}

/// `size`: of the whole file, of which `bytes` is the beginning.
Result<Header> parse_header(std::string_view bytes, std::uint64_t size, const std::string& file) {
    if (!bytes.starts_with("LASF")) return damaged(file, "not a LAS file ('LASF' is missing)");
    if (bytes.size() < kSmallestHeader) return damaged(file, "truncated LAS header");
    const char* data = bytes.data();
    const auto header_bytes = load_le<std::uint16_t>(data + kHeaderSize);
    const auto format = load_le<std::uint8_t>(data + kFormat);
    if (header_bytes < kSmallestHeader) {
        return damaged(
            file,
            fmt::format("LAS header of {} bytes, at least {}", header_bytes, kSmallestHeader));
    }
    if ((format & kCompressed) != 0) {
        return damaged(file,
                       "compressed (LAZ) points, which nothing here reads: convert the file with "
                       "'pdal translate IN.laz OUT.las' or 'laszip'");
    }
    if (format >= kFormats.size())
        return damaged(file, fmt::format("LAS point format {}, 0 to 10 are known", format));
    Header header;
    header.header_bytes = header_bytes;
    header.format = format;
    header.points_at = load_le<std::uint32_t>(data + kPointsAt);
    header.record_bytes = load_le<std::uint16_t>(data + kRecordBytes);
    header.points = load_le<std::uint32_t>(data + kPoints32);
    if (load_le<std::uint8_t>(data + kVersionMinor) >= 4 && header_bytes >= kHeader14 &&
        bytes.size() >= kHeader14)
        header.points = load_le<std::uint64_t>(data + kPoints64);
    if (header.record_bytes < kFormats[format].bytes) {
        return damaged(file,
                       fmt::format("LAS records of {} bytes, format {} needs {}",
                                   header.record_bytes,
                                   format,
                                   kFormats[format].bytes));
    }
    if (header.points_at < header_bytes || header.points_at > size ||
        header.points > (size - header.points_at) / header.record_bytes) {
        return damaged(
            file,
            fmt::format("truncated or damaged LAS: {} points of {} bytes from byte {} on do not "
                        "fit into {} bytes",
                        header.points,
                        header.record_bytes,
                        header.points_at,
                        size));
    }
    for (int axis = 0; axis < 3; ++axis) {
        header.scale[axis] = load_le<double>(data + kScales + 8 * axis);
        header.offset_m[axis] = load_le<double>(data + kOffsets + 8 * axis);
    }
    if (!header.scale.allFinite() || !header.offset_m.allFinite() || header.scale.minCoeff() <= 0.0)
        return damaged(file, "LAS scales must be positive, and offsets numbers");
    return header;
}

/// Classification: five bits of one byte, or a byte of its own from format 6 on.
float class_of(const char* record, std::size_t format) {
    return static_cast<float>(format < 6 ? load_le<std::uint8_t>(record + 15) & 31
                                         : load_le<std::uint8_t>(record + 16));
}

/// Colours have 16 bits, of which many writers use the lower eight alone.
void add_colours(const Header& header, std::string_view records, PointCloud& cloud) {
    const std::size_t at = kFormats[header.format].colour;
    if (at == 0) return;
    const auto channel = [&](std::size_t i, std::size_t c) {
        return load_le<std::uint16_t>(records.data() + i * header.record_bytes + at + 2 * c);
    };
    bool wide = false;
    for (std::size_t i = 0; i < header.points; ++i)
        wide = wide || channel(i, 0) > 255 || channel(i, 1) > 255 || channel(i, 2) > 255;
    const int shift = wide ? 8 : 0;
    for (std::size_t i = 0; i < header.points; ++i) {
        cloud.colours.push_back({static_cast<std::uint8_t>(channel(i, 0) >> shift),
                                 static_cast<std::uint8_t>(channel(i, 1) >> shift),
                                 static_cast<std::uint8_t>(channel(i, 2) >> shift)});
    }
}

}  // namespace

Result<PointCloud> parse_las(std::string_view bytes, const std::string& file) {
    const auto header = parse_header(bytes, bytes.size(), file);
    if (!header) return header.error();
    constexpr std::uint64_t kMaxPoints = 1ULL << 30;
    if (header->points > kMaxPoints)
        return damaged(file, fmt::format("{} points, at most {}", header->points, kMaxPoints));
    const std::string_view records = bytes.substr(header->points_at);
    PointCloud cloud;
    cloud.points_m.reserve(header->points);
    CloudScalar intensity{"intensity", {}};
    CloudScalar classification{"classification", {}};
    for (std::size_t i = 0; i < header->points; ++i) {
        const char* record = records.data() + i * header->record_bytes;
        const Eigen::Vector3d whole(load_le<std::int32_t>(record),
                                    load_le<std::int32_t>(record + 4),
                                    load_le<std::int32_t>(record + 8));
        cloud.points_m.emplace_back(header->scale.cwiseProduct(whole) + header->offset_m);
        intensity.values.push_back(load_le<std::uint16_t>(record + kIntensity));
        classification.values.push_back(class_of(record, header->format));
    }
    add_colours(*header, records, cloud);
    cloud.scalars = {std::move(intensity), std::move(classification)};
    cloud.width = static_cast<int>(header->points);
    return cloud;
}

std::optional<CloudRows> las_rows(std::string_view head, std::uint64_t size) {
    const auto header = parse_header(head, size, "");
    if (!header || header->header_bytes > head.size()) return std::nullopt;
    CloudRows rows;
    rows.first_byte = header->points_at;
    rows.rows = header->points;
    rows.row_bytes = header->record_bytes;
    rows.head = [copy = std::string(head.substr(0, header->header_bytes))](std::uint64_t count) {
        std::string bytes = copy;
        const auto put = [&](std::size_t at, auto value) {
            std::string packed;
            store_le(packed, value);
            bytes.replace(at, packed.size(), packed);
        };
        put(kPointsAt, static_cast<std::uint32_t>(bytes.size()));
        put(kRecordCount, std::uint32_t{0});
        put(kPoints32, static_cast<std::uint32_t>(count));
        if (bytes.size() >= kHeader14) put(kPoints64, count);
        return bytes;
    };
    return rows;
}

}  // namespace surefoot::io
