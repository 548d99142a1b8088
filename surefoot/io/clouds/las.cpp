// SPDX-License-Identifier: Apache-2.0
// Reads LAS 1.0 to 1.4 (ASPRS, "LAS Specification 1.4 - R15"). A file has a header with scales and
// offsets, then records that begin with x, y and z as whole numbers. All numbers are little-endian.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "surefoot/io/bytes.hpp"
#include "surefoot/io/clouds/cloud_rows.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"

namespace surefoot::io {
namespace {

// Byte offsets and sizes from table 3 of the specification, public header block.
constexpr std::size_t kVersionMinor = 25;
constexpr std::size_t kHeaderSize = 94;
constexpr std::size_t kPointsAt = 96;
constexpr std::size_t kRecordCount = 100;  ///< offset of the number of variable length records
constexpr std::size_t kFormat = 104;
constexpr std::size_t kRecordBytes = 105;
constexpr std::size_t kPoints32 = 107;
constexpr std::size_t kScales = 131;
constexpr std::size_t kOffsets = 155;
constexpr std::size_t kPoints64 = 247;  ///< from 1.4 on
constexpr std::size_t kSmallestHeader = 227;
constexpr std::size_t kHeader14 = 375;

struct RecordFormat {
    std::size_t bytes;     ///< size of all fields [bytes]
    std::size_t time;      ///< byte offset of the GPS time; 0 = no GPS time
    std::size_t colour;    ///< byte offset of red; 0 = no colours
    std::size_t infrared;  ///< byte offset of the near-infrared channel; 0 = no such channel
    std::size_t waves;     ///< byte offset of the wave packet; 0 = no wave packets
};
// Point formats 0 to 10, from tables 7 to 17 of the specification.
constexpr std::array<RecordFormat, 11> kFormats = {{{20, 0, 0, 0, 0},
                                                    {28, 20, 0, 0, 0},
                                                    {26, 0, 20, 0, 0},
                                                    {34, 20, 28, 0, 0},
                                                    {57, 20, 0, 0, 28},
                                                    {63, 20, 28, 0, 34},
                                                    {30, 22, 0, 0, 0},
                                                    {36, 22, 30, 0, 0},
                                                    {38, 22, 30, 36, 0},
                                                    {59, 22, 0, 0, 30},
                                                    {67, 22, 30, 36, 38}}};
constexpr std::size_t kIntensity = 12;
constexpr std::size_t kReturns = 14;
constexpr std::size_t kFirstWideFormat = 6;  ///< formats from 6 on have another record layout
constexpr std::uint8_t kCompressed = 0xC0;   ///< bits that LAZ sets in the format number

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

/// Reads the header. `bytes` is the beginning of a file of `size` bytes.
Result<Header> parse_header(std::string_view bytes, std::uint64_t size, const std::string& file) {
    if (!bytes.starts_with("LASF")) return damaged(file, "not a LAS file ('LASF' is missing)");
    if (bytes.size() < kSmallestHeader)
        return damaged(file, "truncated LAS header; copy the file again");
    const char* data = bytes.data();
    const auto header_bytes = load_le<std::uint16_t>(data + kHeaderSize);
    const auto format = load_le<std::uint8_t>(data + kFormat);
    if (header_bytes < kSmallestHeader) {
        return damaged(file,
                       fmt::format("the LAS header has {} bytes; at least {} are needed",
                                   header_bytes,
                                   kSmallestHeader));
    }
    if ((format & kCompressed) != 0) {
        return damaged(file,
                       "compressed (LAZ) points are not supported: convert the file with "
                       "'pdal translate IN.laz OUT.las' or 'laszip'");
    }
    if (format >= kFormats.size())
        return damaged(
            file,
            fmt::format("LAS point format {} is not supported; the supported formats are 0 to 10",
                        format));
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
                       fmt::format("the LAS records have {} bytes, but format {} needs {}",
                                   header.record_bytes,
                                   format,
                                   kFormats[format].bytes));
    }
    if (header.points_at < header_bytes || header.points_at > size ||
        header.points > (size - header.points_at) / header.record_bytes) {
        return damaged(file,
                       fmt::format("truncated or damaged LAS: {} points of {} bytes from byte {} "
                                   "on do not fit into {} bytes; copy the file again",
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
        return damaged(file, "LAS scales must be positive, and LAS offsets must be finite numbers");
    return header;
}

/// Adds one value of every record to the cloud as a scalar. `value_of` gets a pointer to the start
/// of the record.
template <typename T, typename Value>
void add_scalar(const Header& header,
                std::string_view records,
                const char* name,
                const Value& value_of,
                PointCloud& cloud) {
    std::vector<T> values;
    values.reserve(header.points);
    for (std::size_t i = 0; i < header.points; ++i)
        values.push_back(static_cast<T>(value_of(records.data() + i * header.record_bytes)));
    cloud.scalars.push_back({name, std::move(values)});
}

/// Adds the fields of the points as scalars with their types. Other functions read coordinates and
/// colours; flags, wave packets and extra bytes are left out.
void add_scalars(const Header& header, std::string_view records, PointCloud& cloud) {
    const RecordFormat& format = kFormats[header.format];
    const bool wide = header.format >= kFirstWideFormat;
    const auto add = [&]<typename T>(const char* name, T, const auto& value_of) {
        add_scalar<T>(header, records, name, value_of, cloud);
    };
    const auto byte_at = [](std::size_t at) {
        return [at](const char* record) { return load_le<std::uint8_t>(record + at); };
    };
    add("intensity", std::uint16_t{}, [](const char* record) {
        return load_le<std::uint16_t>(record + kIntensity);
    });
    add("classification", std::uint8_t{}, [&](const char* record) {
        return wide ? load_le<std::uint8_t>(record + 16) : load_le<std::uint8_t>(record + 15) & 31;
    });
    add("return_number", std::uint8_t{}, [&](const char* record) {
        return load_le<std::uint8_t>(record + kReturns) & (wide ? 15 : 7);
    });
    add("number_of_returns", std::uint8_t{}, [&](const char* record) {
        const auto byte = load_le<std::uint8_t>(record + kReturns);
        return wide ? byte >> 4 : (byte >> 3) & 7;
    });
    if (wide) {
        constexpr float kUnit_deg = 0.006F;
        add("scan_angle_deg", 0.0F, [](const char* record) {
            return kUnit_deg * static_cast<float>(load_le<std::int16_t>(record + 18));
        });
    } else {
        add("scan_angle_deg", std::int8_t{}, [](const char* record) {
            return load_le<std::int8_t>(record + 16);
        });
    }
    add("user_data", std::uint8_t{}, byte_at(17));
    add("point_source_id", std::uint16_t{}, [&](const char* record) {
        return load_le<std::uint16_t>(record + (wide ? 20 : 18));
    });
    if (format.time != 0) {
        add("gps_time", 0.0, [&](const char* record) {
            return load_le<double>(record + format.time);
        });
    }
    if (format.infrared != 0) {
        add("near_infrared", std::uint16_t{}, [&](const char* record) {
            return load_le<std::uint16_t>(record + format.infrared);
        });
    }
}

/// Names the contents of the file that the cloud cannot store.
std::vector<std::string> notes_of(const Header& header,
                                  std::string_view records,
                                  bool wide_colours) {
    const RecordFormat& format = kFormats[header.format];
    std::vector<std::string> notes;
    bool flags = false;
    for (std::size_t i = 0; i < header.points && !flags; ++i) {
        const char* record = records.data() + i * header.record_bytes;
        flags = header.format >= kFirstWideFormat
                    ? load_le<std::uint8_t>(record + 15) != 0
                    : (load_le<std::uint8_t>(record + kReturns) & 0xC0) != 0 ||
                          (load_le<std::uint8_t>(record + 15) & 0xE0) != 0;
    }
    if (flags) notes.emplace_back("the flags of the LAS points are not kept");
    if (format.waves != 0) notes.emplace_back("the wave packets of the LAS points are not kept");
    if (header.record_bytes > format.bytes)
        notes.emplace_back("the extra bytes of the LAS points are not kept");
    if (wide_colours)
        notes.emplace_back("only the upper 8 of the 16 bits of the LAS colours are kept");
    return notes;
}

/// Reads colours. They have 16 bits, but many writers use only the lower eight. Returns true if a
/// colour uses more than eight bits.
bool add_colours(const Header& header, std::string_view records, PointCloud& cloud) {
    const std::size_t at = kFormats[header.format].colour;
    if (at == 0) return false;
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
    return wide;
}

}  // namespace

Result<PointCloud> parse_las(std::string_view bytes, const std::string& file) {
    const auto header = parse_header(bytes, bytes.size(), file);
    if (!header) return header.error();
    constexpr std::uint64_t kMaxPoints = 1ULL << 30;
    if (header->points > kMaxPoints)
        return damaged(
            file,
            fmt::format(
                "the file has {} points; at most {} are supported", header->points, kMaxPoints));
    const std::string_view records = bytes.substr(header->points_at);
    PointCloud cloud;
    cloud.points_m.reserve(header->points);
    for (std::size_t i = 0; i < header->points; ++i) {
        const char* record = records.data() + i * header->record_bytes;
        const Eigen::Vector3d whole(load_le<std::int32_t>(record),
                                    load_le<std::int32_t>(record + 4),
                                    load_le<std::int32_t>(record + 8));
        cloud.points_m.emplace_back(header->scale.cwiseProduct(whole) + header->offset_m);
    }
    add_scalars(*header, records, cloud);
    const bool wide_colours = add_colours(*header, records, cloud);
    cloud.notes = notes_of(*header, records, wide_colours);
    cloud.double_precision = true;
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
