// SPDX-License-Identifier: Apache-2.0
#include "io/snapshot_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>

#include "io/bytes.hpp"
#include "io/file.hpp"
#include "surefoot/grid/snapshot_fields.hpp"

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

/// Enums are stored as their bytes.
template <typename T>
auto stored(T value) {
    if constexpr (std::is_enum_v<T>) {
        return static_cast<std::underlying_type_t<T>>(value);
    } else {
        return value;
    }
}

/// Largest byte that is an enumerator.
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

bool has_sound_size(const MapSnapshot& s) noexcept {
    return s.nx >= 1 && s.ny >= 1 && s.nx <= MapSnapshot::kMaxSide &&
           s.ny <= MapSnapshot::kMaxSide && s.edge_count >= 0 &&
           s.edge_count <= MapSnapshot::kMaxEdges;
}

std::size_t cells_of(const MapSnapshot& s) {
    return static_cast<std::size_t>(s.nx) * static_cast<std::size_t>(s.ny);
}

Error damaged(const std::string& file, std::string_view what) {
    return input_error(fmt::format("{}: {}; make the map again", file, what));
}

}  // namespace

Result<std::string> format_snapshot(const MapSnapshot& snapshot) {
    if (!grid::is_intact(snapshot)) {
        return output_error(
            "the map snapshot is not intact (checksum or header); it is not written");
    }
    // Cells beyond nx * ny mean nothing and are not stored; the stored checksum is of zeros there.
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
    auto snapshot = std::make_unique<MapSnapshot>();  // a megabyte: not for every wrong file
    snapshot->magic = magic;
    snapshot->layout = layout;
    grid::for_each_header_field(*snapshot, [&](const char*, auto& field) { reader(field); });
    if (!reader.complete) return damaged(file, "truncated map snapshot: its header is cut off");
    if (!has_sound_size(*snapshot)) {
        return damaged(file,
                       fmt::format("map snapshot of {} x {} cells and {} edges; 1 to {} cells a "
                                   "side and 0 to {} edges are possible",
                                   snapshot->nx,
                                   snapshot->ny,
                                   snapshot->edge_count,
                                   MapSnapshot::kMaxSide,
                                   MapSnapshot::kMaxEdges));
    }
    grid::for_each_snapshot_layer(*snapshot, [&](auto& layer) {
        std::for_each_n(layer.begin(), cells_of(*snapshot), [&](auto& cell) { reader(cell); });
    });
    for (int i = 0; i < snapshot->edge_count; ++i) {
        for_each_field(snapshot->edges[static_cast<std::size_t>(i)],
                       [&](auto& field) { reader(field); });
    }
    std::uint64_t checksum = 0;
    reader(checksum);
    if (!reader.complete || !reader.rest.empty()) {
        return damaged(file,
                       fmt::format("{} map snapshot: {} bytes for {} x {} cells",
                                   reader.complete ? "too long a" : "truncated",
                                   bytes.size(),
                                   snapshot->nx,
                                   snapshot->ny));
    }
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
