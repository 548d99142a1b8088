// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/maps/map_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "surefoot/core/fnv1a.hpp"
#include "surefoot/io/bytes.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

using grid::MapRegion;

constexpr std::string_view kMagic{"SFREGION", 8};
/// Bytes of the preamble: magic, major version, minor version, size of the header.
constexpr std::size_t kPreambleBytes = 16;
/// Bytes of a header of version 1.0, preamble included.
constexpr std::size_t kHeaderBytes = 168;
constexpr std::size_t kFrameBytes = grid::kMaxFrameName + 1;
constexpr std::size_t kLayerNameBytes = 40;
constexpr std::size_t kUnitBytes = 16;
constexpr std::size_t kLayerEntryBytes = 64;
constexpr std::size_t kChecksumBytes = 8;
constexpr std::uint32_t kMaxLayers = 256;
constexpr std::uint32_t kMaxCellBytes = 64;

template <typename T>
constexpr std::uint32_t type_code() {
    static_assert(std::is_same_v<T, float> || std::is_same_v<T, std::uint32_t> ||
                  std::is_same_v<T, std::int64_t>);
    if constexpr (std::is_same_v<T, float>) return 1;
    if constexpr (std::is_same_v<T, std::uint32_t>) return 2;
    return 3;
}

/// Writes a name into a field of fixed size, padded with zeros.
void store_name(std::string& out, std::string_view name, std::size_t bytes) {
    out += name;
    out.append(bytes - name.size(), '\0');
}

/// Reads the name in a field; no value unless it ends with a zero and only zeros follow.
std::optional<std::string> load_name(std::string_view field) {
    const std::size_t end = field.find('\0');
    if (end == field.npos) return std::nullopt;
    if (field.find_first_not_of('\0', end) != field.npos) return std::nullopt;
    return std::string(field.substr(0, end));
}

/// Replaces every NaN by the same NaN, so that all NaN have the same four bytes in the file.
template <typename T>
T canonical(T value) {
    if constexpr (std::is_same_v<T, float>) {
        return std::isnan(value) ? std::numeric_limits<float>::quiet_NaN() : value;
    } else {
        return value;
    }
}

/// Visits the numbers of the header in file order; reading and writing share this list.
template <typename Region, typename Visit>
void for_each_number(Region& r, const Visit& visit) {
    visit(r.stamp_ns);
    visit(r.frame_since_ns);
    visit(r.config_hash);
    visit(r.resolution_m);
    visit(r.box.first_ix);
    visit(r.box.first_iy);
    visit(r.box.nx);
    visit(r.box.ny);
    for (int axis = 0; axis < 3; ++axis) visit(r.T_frame_body.translation_m[axis]);
    visit(r.T_frame_body.rotation.x());
    visit(r.T_frame_body.rotation.y());
    visit(r.T_frame_body.rotation.z());
    visit(r.T_frame_body.rotation.w());
}

/// One entry of the layer table.
struct LayerEntry {
    std::string name;
    std::string unit;
    std::uint32_t type = 0;
    std::uint32_t cell_bytes = 0;
    const char* cells = nullptr;
};

/// Reads a file from front to back. The caller must check that enough bytes exist.
struct Cursor {
    const char* at;
    template <typename T>
    T number() {
        const T value = load_le<T>(at);
        at += sizeof(T);
        return value;
    }
    std::string_view field(std::size_t bytes) {
        const std::string_view text(at, bytes);
        at += bytes;
        return text;
    }
};

/// Version and header size from the preamble.
struct Outline {
    std::uint16_t minor = 0;
    std::size_t header_bytes = 0;
};

Error damaged(const std::string& file, const std::string& what) {
    return input_error(fmt::format("{}: {}; make or copy the map again", file, what));
}

Result<Outline> check_outline(std::string_view bytes, const std::string& file) {
    if (bytes.substr(0, kMagic.size()) != kMagic)
        return input_error(file + ": not a map region (wrong first bytes)");
    if (bytes.size() < kPreambleBytes + kChecksumBytes)
        return damaged(file, fmt::format("truncated map region: {} bytes", bytes.size()));
    Cursor cursor{bytes.data() + kMagic.size()};
    const auto major = cursor.number<std::uint16_t>();
    Outline outline{cursor.number<std::uint16_t>(), cursor.number<std::uint32_t>()};
    // Check the version first: for another version even the position of the checksum is unknown.
    if (major != kMapFileMajor) {
        return input_error(fmt::format(
            "{}: map region of version {}.{}; this program reads version {}: {}",
            file,
            major,
            outline.minor,
            kMapFileMajor,
            major > kMapFileMajor ? "use a newer program" : "make or copy the map again"));
    }
    const std::size_t without_checksum = bytes.size() - kChecksumBytes;
    if (map_checksum(bytes.substr(0, without_checksum)) !=
        load_le<std::uint64_t>(bytes.data() + without_checksum)) {
        return damaged(file, "truncated or damaged map region: its checksum is wrong");
    }
    if (outline.header_bytes < kHeaderBytes || outline.header_bytes > without_checksum) {
        return damaged(
            file,
            fmt::format("the header of the map region has {} bytes; {} to {} are allowed",
                        outline.header_bytes,
                        kHeaderBytes,
                        without_checksum));
    }
    return outline;
}

Status read_header(Cursor& cursor, MapRegion& region, std::uint32_t& layers) {
    for_each_number(region, [&](auto& value) {
        value = cursor.number<std::remove_reference_t<decltype(value)>>();
    });
    const auto frame = load_name(cursor.field(kFrameBytes));
    layers = cursor.number<std::uint32_t>();
    const auto reserved = cursor.number<std::uint32_t>();
    if (!frame) return input_error("the name of the frame is not filled up with zeros");
    region.frame = *frame;
    if (reserved != 0)
        return input_error(fmt::format("reserved bytes hold {}, but must be 0", reserved));
    if (auto problem = region.box.problem()) return input_error(*problem);
    if (layers > kMaxLayers) {
        return input_error(
            fmt::format("the map has {} layers; at most {} are allowed", layers, kMaxLayers));
    }
    return {};
}

Result<std::vector<LayerEntry>> read_layer_table(Cursor& cursor, std::uint32_t count) {
    std::vector<LayerEntry> entries;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto name = load_name(cursor.field(kLayerNameBytes));
        const auto unit = load_name(cursor.field(kUnitBytes));
        LayerEntry entry{.name = name.value_or(""),
                         .unit = unit.value_or(""),
                         .type = cursor.number<std::uint32_t>(),
                         .cell_bytes = cursor.number<std::uint32_t>()};
        if (!name || !unit || entry.name.empty())
            return input_error(fmt::format("layer {} has no valid name or unit", i));
        if (entry.cell_bytes < 1 || entry.cell_bytes > kMaxCellBytes) {
            return input_error(fmt::format("layer {} has {} bytes per cell; 1 to {} are allowed",
                                           quoted(entry.name),
                                           entry.cell_bytes,
                                           kMaxCellBytes));
        }
        const auto same = [&](const LayerEntry& other) { return other.name == entry.name; };
        if (std::any_of(entries.begin(), entries.end(), same))
            return input_error(fmt::format("layer {} appears twice", quoted(entry.name)));
        entries.push_back(std::move(entry));
    }
    return entries;
}

/// Moves a layer from `entries` to `out`.
template <typename T>
Status load_layer(const grid::RegionLayer& layer,
                  const grid::LatticeBox& box,
                  std::vector<LayerEntry>& entries,
                  Image<T>& out) {
    const auto entry = std::find_if(
        entries.begin(), entries.end(), [&](const LayerEntry& e) { return e.name == layer.name; });
    if (entry == entries.end()) return input_error(fmt::format("layer {} is missing", layer.name));
    if (entry->unit != layer.unit || entry->type != type_code<T>() ||
        entry->cell_bytes != sizeof(T)) {
        return input_error(
            fmt::format("layer {} has type {}, {} bytes and unit {}; it must have type {}, {} "
                        "bytes and unit {}",
                        layer.name,
                        entry->type,
                        entry->cell_bytes,
                        quoted(entry->unit),
                        type_code<T>(),
                        sizeof(T),
                        quoted(layer.unit)));
    }
    out = Image<T>(box.nx, box.ny);
    Cursor cursor{entry->cells};
    for (std::size_t i = 0; i < out.size(); ++i)
        out.data()[i] = canonical(cursor.template number<T>());
    entries.erase(entry);
    return {};
}

/// Reads everything after the preamble; the caller adds the file name to errors.
Status read_region(std::string_view bytes, const Outline& outline, MapFile& out) {
    MapRegion& region = out.region;
    Cursor cursor{bytes.data() + kPreambleBytes};
    std::uint32_t layers = 0;
    if (Status status = read_header(cursor, region, layers); !status) return status;
    const std::uint64_t cells =
        static_cast<std::uint64_t>(region.box.nx) * static_cast<std::uint64_t>(region.box.ny);
    std::uint64_t needed =
        outline.header_bytes + std::uint64_t{layers} * kLayerEntryBytes + kChecksumBytes;
    cursor.at = bytes.data() + outline.header_bytes;
    if (needed > bytes.size())
        return input_error(fmt::format("{} bytes are too few for {} layers", bytes.size(), layers));
    auto entries = read_layer_table(cursor, layers);
    if (!entries) return entries.error();
    for (LayerEntry& entry : *entries) {
        // If the file is too short, this pointer is not used, because the size check below fails.
        entry.cells = bytes.data() + std::min<std::uint64_t>(needed - kChecksumBytes, bytes.size());
        needed += cells * entry.cell_bytes;
    }
    if (needed != bytes.size()) {
        return input_error(
            fmt::format("the file has {} bytes, but {} x {} cells of its {} layers need {}",
                        bytes.size(),
                        region.box.nx,
                        region.box.ny,
                        layers,
                        needed));
    }
    Status first;
    grid::for_each_layer([&](const grid::RegionLayer& layer, auto member, auto) {
        if (first) first = load_layer(layer, region.box, *entries, region.*member);
    });
    if (!first) return first;
    for (const LayerEntry& entry : *entries) out.skipped_layers.push_back(entry.name);
    if (const auto problem = region.problem()) return input_error(*problem);
    return {};
}

}  // namespace

std::uint64_t map_checksum(std::string_view bytes) noexcept {
    return fnv1a(bytes);
}

Result<std::string> format_map(const MapRegion& region) {
    if (const auto problem = region.problem())
        return output_error("the map region is not written: " + *problem);
    std::string out(kMagic);
    store_le(out, kMapFileMajor);
    store_le(out, kMapFileMinor);
    store_le(out, static_cast<std::uint32_t>(kHeaderBytes));
    for_each_number(region, [&](const auto& value) { store_le(out, value); });
    store_name(out, region.frame, kFrameBytes);
    std::uint32_t layers = 0;
    grid::for_each_layer([&](const grid::RegionLayer&, auto, auto) { ++layers; });
    store_le(out, layers);
    store_le(out, std::uint32_t{0});
    SUREFOOT_ASSERT(out.size() == kHeaderBytes);
    grid::for_each_layer([&](const grid::RegionLayer& layer, auto, auto unknown) {
        store_name(out, layer.name, kLayerNameBytes);
        store_name(out, layer.unit, kUnitBytes);
        store_le(out, type_code<decltype(unknown)>());
        store_le(out, static_cast<std::uint32_t>(sizeof(unknown)));
    });
    grid::for_each_layer([&](const grid::RegionLayer&, auto member, auto) {
        const auto& cells = region.*member;
        std::for_each_n(
            cells.data(), cells.size(), [&](auto value) { store_le(out, canonical(value)); });
    });
    store_le(out, map_checksum(out));
    return out;
}

Status write_map(const std::string& path, const MapRegion& region) {
    const Result<std::string> bytes = format_map(region);
    if (!bytes) return output_error(path + ": " + bytes.error().message);
    return write_file(path, *bytes);
}

Result<MapFile> parse_map(std::string_view bytes, const std::string& file) {
    const Result<Outline> outline = check_outline(bytes, file);
    if (!outline) return outline.error();
    MapFile out;
    out.minor = outline->minor;
    if (Status status = read_region(bytes, *outline, out); !status)
        return damaged(file, "invalid map region: " + status.error().message);
    return out;
}

Result<MapFile> read_map(const std::string& path) {
    const Result<std::string> bytes = read_file(path, limits::kMapBytes);
    if (!bytes) return bytes.error();
    return parse_map(*bytes, path);
}

}  // namespace surefoot::io
