// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/maps/snapshot_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>

#include "surefoot/grid/snapshot_fields.hpp"
#include "surefoot/io/bytes.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::io {
namespace {

using grid::MapSnapshot;

template <typename Edge, typename Visit>
void for_each_field(Edge& edge, Visit visit) {
    visit(edge.from_x_tenth_mm);
    visit(edge.from_y_tenth_mm);
    visit(edge.to_x_tenth_mm);
    visit(edge.to_y_tenth_mm);
    visit(edge.upper_tenth_mm);
    visit(edge.lower_tenth_mm);
    visit(edge.height_sigma_tenth_mm);
    visit(edge.across_sigma_tenth_mm);
}

/// Returns the value to store; an enum is stored as its number.
template <typename T>
auto stored(T value) {
    if constexpr (std::is_enum_v<T>) {
        return static_cast<std::underlying_type_t<T>>(value);
    } else {
        return value;
    }
}

/// Returns the number of the last enumerator of an enum.
constexpr std::uint8_t last_of(grid::EvidenceSource) {
    return 2;
}
constexpr std::uint8_t last_of(grid::GravitySource) {
    return 2;
}
constexpr std::uint8_t last_of(grid::SnapshotHealth) {
    return 2;
}
constexpr std::uint8_t last_of(CameraState) {
    return 7;
}

struct Reader {
    std::string_view rest;
    bool complete = true;
    bool known_values = true;

    template <typename T>
    void operator()(T& value) {
        using Stored = decltype(stored(value));
        if (rest.size() < sizeof(Stored)) {
            complete = false;
            return;
        }
        const Stored loaded = load_le<Stored>(rest.data());
        rest.remove_prefix(sizeof(Stored));
        if constexpr (std::is_enum_v<T>) {
            known_values = known_values && loaded <= last_of(T{});
            value = loaded <= last_of(T{}) ? static_cast<T>(loaded) : T{};
        } else {
            value = loaded;
        }
    }
};

std::size_t cells_of(const MapSnapshot& s) {
    return static_cast<std::size_t>(s.nx) * static_cast<std::size_t>(s.ny);
}

/// Bytes of one cell and of one edge in the file.
constexpr std::size_t kCellBytes = sizeof(std::int32_t) + 4 * sizeof(std::uint16_t) + 2;
constexpr std::size_t kEdgeBytes = 8 * sizeof(std::int32_t);

/// Header bytes before nx, ny and the number of edges. With these sizes a wrong file length is
/// detected before a megabyte is allocated.
constexpr std::size_t kBeforeSizes =
    sizeof(MapSnapshot::magic) + sizeof(MapSnapshot::layout) + sizeof(MapSnapshot::version) +
    sizeof(MapSnapshot::config_hash) + sizeof(MapSnapshot::frame_time_ns) +
    sizeof(MapSnapshot::pose_time_ns) + sizeof(MapSnapshot::resolution_tenth_mm);

struct Sizes {
    std::int32_t nx = 0;
    std::int32_t ny = 0;
    std::int32_t edge_count = 0;

    [[nodiscard]] bool are_possible() const {
        return nx >= 1 && ny >= 1 && nx <= MapSnapshot::kMaxSide && ny <= MapSnapshot::kMaxSide &&
               edge_count >= 0 && edge_count <= MapSnapshot::kMaxEdges;
    }
    /// Returns the bytes of cells, edges and checksum, without the header.
    [[nodiscard]] std::size_t bytes() const {
        return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * kCellBytes +
               static_cast<std::size_t>(edge_count) * kEdgeBytes + sizeof(MapSnapshot::checksum);
    }
};

Error damaged(const std::string& file, std::string_view what) {
    return input_error(fmt::format("{}: {}; make the map again", file, what));
}

}  // namespace

Result<std::string> format_snapshot(const MapSnapshot& snapshot) {
    if (!grid::is_intact(snapshot)) {
        return output_error(
            "the map snapshot is not intact (checksum or header); it is not written");
    }
    // Cells beyond nx * ny are unused and not stored; the stored checksum assumes zeros there.
    const auto clean = std::make_unique<MapSnapshot>(snapshot);
    clean->padding = {};
    std::fill(clean->edges.begin() + clean->edge_count, clean->edges.end(), grid::SnapshotEdge{});
    grid::for_each_snapshot_layer(*clean, [used = cells_of(snapshot)](auto& layer) {
        std::fill(layer.begin() + static_cast<std::ptrdiff_t>(used),
                  layer.end(),
                  typename std::decay_t<decltype(layer)>::value_type{});
    });
    std::string out;
    const auto put = [&out](const auto& value) { store_le(out, stored(value)); };
    put(clean->magic);
    put(clean->layout);
    grid::for_each_header_field(*clean, [&](const char*, const auto& value) { put(value); });
    grid::for_each_snapshot_layer(
        *clean, [&](const auto& layer) { std::for_each_n(layer.begin(), cells_of(*clean), put); });
    for (int i = 0; i < clean->edge_count; ++i)
        for_each_field(clean->edges[static_cast<std::size_t>(i)], put);
    grid::seal(*clean);
    put(clean->checksum);
    return out;
}

Status write_snapshot(const std::string& path, const MapSnapshot& snapshot) {
    const Result<std::string> bytes = format_snapshot(snapshot);
    if (!bytes) return output_error(path + ": " + bytes.error().message);
    return write_file(path, *bytes);
}

Result<std::unique_ptr<MapSnapshot>> parse_snapshot(std::string_view bytes,
                                                    const std::string& file) {
    Reader reader{bytes};
    decltype(MapSnapshot::magic) magic = 0;
    decltype(MapSnapshot::layout) layout = 0;
    reader(magic);
    reader(layout);
    if (!reader.complete || magic != MapSnapshot::kMagic) {
        return input_error(file + ": not a map snapshot (wrong first bytes)");
    }
    if (layout != MapSnapshot::kLayout) {
        return damaged(file,
                       fmt::format("map snapshot of layout {}; this program reads layout {}",
                                   layout,
                                   MapSnapshot::kLayout));
    }
    if (bytes.size() < kBeforeSizes + sizeof(Sizes))
        return damaged(file, "truncated map snapshot: its header is cut off");
    Reader ahead{bytes.substr(kBeforeSizes)};
    Sizes sizes;
    ahead(sizes.nx);
    ahead(sizes.ny);
    ahead(sizes.edge_count);
    if (!sizes.are_possible()) {
        return damaged(file,
                       fmt::format("map snapshot of {} x {} cells and {} edges; 1 to {} cells on a "
                                   "side and 0 to {} edges are allowed",
                                   sizes.nx,
                                   sizes.ny,
                                   sizes.edge_count,
                                   MapSnapshot::kMaxSide,
                                   MapSnapshot::kMaxEdges));
    }
    const auto wrong_length = [&](const char* what) {
        return damaged(file,
                       fmt::format("{} map snapshot: {} bytes for {} x {} cells",
                                   what,
                                   bytes.size(),
                                   sizes.nx,
                                   sizes.ny));
    };
    if (bytes.size() < kBeforeSizes + sizeof(Sizes) + sizes.bytes())
        return wrong_length("truncated");
    auto snapshot = std::make_unique<MapSnapshot>();
    snapshot->magic = magic;
    snapshot->layout = layout;
    grid::for_each_header_field(*snapshot, [&](const char*, auto& field) { reader(field); });
    grid::for_each_snapshot_layer(*snapshot, [&](auto& layer) {
        std::for_each_n(layer.begin(), cells_of(*snapshot), [&](auto& cell) { reader(cell); });
    });
    for (int i = 0; i < snapshot->edge_count; ++i) {
        for_each_field(snapshot->edges[static_cast<std::size_t>(i)],
                       [&](auto& field) { reader(field); });
    }
    std::uint64_t checksum = 0;
    reader(checksum);
    if (!reader.complete) return wrong_length("truncated");
    if (!reader.rest.empty()) return wrong_length("too long a");
    grid::seal(*snapshot);
    if (!reader.known_values || snapshot->checksum != checksum || !grid::is_sealed(*snapshot)) {
        return damaged(file, "damaged map snapshot: its checksum or header is wrong");
    }
    return snapshot;
}

Result<std::unique_ptr<MapSnapshot>> read_snapshot(const std::string& path) {
    const Result<std::string> bytes = read_file(path, 2 * sizeof(MapSnapshot));
    if (!bytes) return bytes.error();
    return parse_snapshot(*bytes, path);
}

}  // namespace surefoot::io
