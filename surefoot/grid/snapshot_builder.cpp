// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/snapshot_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/grid/whole_cells.hpp"

namespace surefoot::grid {
namespace {

constexpr double kTenthMmPerM = 1e4;
constexpr double kFarthestM = 1e5;    ///< largest distance of pose, map and edges from odom
constexpr double kHighestM = 1000.0;  ///< a height beyond +-1000 m is a damaged number, not ground

/// Needs lengths within kFarthestM; check() and is_sound() ensure this.
std::int64_t tenth_mm(double length_m) {
    return std::llround(length_m * kTenthMmPerM);  // in range: at most 10^9
}
/// Needs heights within kHighestM.
std::int32_t height_tenth_mm(double height_m) {
    return static_cast<std::int32_t>(tenth_mm(height_m));  // in range: at most 10^7
}
std::int32_t tenth_mm_up(double length_m) {
    return static_cast<std::int32_t>(std::ceil(length_m * kTenthMmPerM));  // in range: at most 10^7
}

/// Rounds a length up to 0.1 mm. NaN, negative and too large lengths become the largest value,
/// which marks them as bad.
std::uint16_t saturated_up(double length_m) {
    const double scaled = std::ceil(length_m * kTenthMmPerM);
    if (!(scaled >= 0.0 && scaled < 65535.0)) return 0xffff;
    return static_cast<std::uint16_t>(scaled);  // in range, as checked
}

/// Rounds an angle up to microradians. Unknown and too large angles become unknown.
std::uint32_t microradians_up(double angle_rad) {
    const double scaled = std::ceil(angle_rad * 1e6);
    constexpr double kLargest = 1e9;
    if (!(scaled >= 0.0 && scaled <= kLargest)) return MapSnapshot::kUnknownTilt;
    return static_cast<std::uint32_t>(scaled);  // in range, as checked
}

/// Part of the grid that fits into a snapshot: its first cell and its size.
struct Window {
    int x = 0;
    int y = 0;
    int nx = 0;
    int ny = 0;
};

Window window_around_body(const SnapshotInput& input) {
    const auto start = [](double body_m, double origin_m, double res_m, int n, int size) {
        const double first = std::floor((body_m - origin_m) / res_m) - size / 2.0;
        return clamped_integer<int>(first, 0, n - size);
    };
    const GridGeometry& g = input.geometry;
    const Eigen::Vector3d& body_m = input.T_odom_body.translation_m;
    Window window{
        0, 0, std::min(g.nx, MapSnapshot::kMaxSide), std::min(g.ny, MapSnapshot::kMaxSide)};
    window.x = start(body_m.x(), g.origin_m.x(), g.resolution_m, g.nx, window.nx);
    window.y = start(body_m.y(), g.origin_m.y(), g.resolution_m, g.ny, window.ny);
    return window;
}

template <typename T>
bool has_size(ImageView<const T> layer, const GridGeometry& geometry) {
    return layer.width == geometry.nx && layer.height == geometry.ny;
}

Status check(const SnapshotInput& input) {
    const GridGeometry& g = input.geometry;
    const auto refuse = [](const std::string& why) {
        return Status(usage_error("map snapshot: " + why));
    };
    if (g.nx < 1 || g.ny < 1)
        return refuse("the map has no cells; its width and height must be at least 1 cell");
    if (!(g.resolution_m >= 0.005 && g.resolution_m <= 0.2))
        return refuse("the map has cells of " + std::to_string(g.resolution_m) +
                      " m; the gate needs 0.005 to 0.2 m: change elevation.resolution_m");
    const double cells = g.resolution_m * kTenthMmPerM;
    if (std::abs(cells - std::round(cells)) > 1e-6)
        return refuse("cells of " + std::to_string(g.resolution_m) +
                      " m are not a whole number of 0.1 mm; change elevation.resolution_m");
    if (!g.origin_m.allFinite() || g.origin_m.cwiseAbs().maxCoeff() > kFarthestM ||
        !input.T_odom_body.all_finite() ||
        input.T_odom_body.translation_m.cwiseAbs().maxCoeff() > kFarthestM)
        return refuse(
            "the pose or the origin of the map is not finite, or is farther than 100 km from the "
            "origin of odom");
    for (const auto& [name, length_m] : {std::pair{"connect_step_m", input.connect_step_m},
                                         std::pair{"drop_step_m", input.drop_step_m},
                                         std::pair{"drop_reach_m", input.drop_reach_m}}) {
        if (!(length_m >= 0.0 && length_m <= kHighestM))
            return refuse(std::string(name) + " of " + std::to_string(length_m) +
                          " m; it must be 0 to 1000 m");
    }
    if (!has_size(input.height_m, g) || !has_size(input.variance_m2, g))
        return refuse("the layers of height and variance must have the size of the map");
    for (const auto& layer :
         {input.drift_m, input.clearance_m, input.free_above_m, input.drop_evidence}) {
        if (!layer.empty() && !has_size(layer, g))
            return refuse("an optional layer does not have the size of the map");
    }
    if (!input.hidden.empty() && !has_size(input.hidden, g))
        return refuse("the layer of hidden cells does not have the size of the map");
    return {};
}

void write_header(const SnapshotInput& input, const Window& window, MapSnapshot& out) {
    const GridGeometry& g = input.geometry;
    out.magic = MapSnapshot::kMagic;
    out.layout = MapSnapshot::kLayout;
    out.version = input.version;
    out.config_hash = input.config_hash;
    out.frame_time_ns = input.frame_time_ns;
    out.pose_time_ns = input.pose_time_ns;
    out.resolution_tenth_mm = height_tenth_mm(g.resolution_m);
    out.nx = window.nx;
    out.ny = window.ny;
    out.origin_x_tenth_mm =
        tenth_mm(g.origin_m.x()) + window.x * std::int64_t{out.resolution_tenth_mm};
    out.origin_y_tenth_mm =
        tenth_mm(g.origin_m.y()) + window.y * std::int64_t{out.resolution_tenth_mm};
    const Eigen::Vector3d& t = input.T_odom_body.translation_m;
    out.body_x_tenth_mm = tenth_mm(t.x());
    out.body_y_tenth_mm = tenth_mm(t.y());
    out.body_z_tenth_mm = tenth_mm(t.z());
    const double yaw = yaw_rad(input.T_odom_body);
    out.body_cos_yaw = std::cos(yaw);
    out.body_sin_yaw = std::sin(yaw);
    out.gravity_source = input.gravity_source;
    out.tilt_sigma_urad = microradians_up(input.tilt_sigma_rad);
    out.health = input.health;
    out.camera = input.camera;
    out.padding = {};
}

/// Sets used cells to unknown and all other cells to zero, so that equal maps have equal bytes.
void clear_cells(MapSnapshot& out) {
    const auto used = static_cast<std::ptrdiff_t>(out.nx) * out.ny;
    const auto clear = [used](auto& layer, auto unknown) {
        std::fill(layer.begin(), layer.begin() + used, unknown);
        std::fill(layer.begin() + used, layer.end(), decltype(unknown){});
    };
    clear(out.height_tenth_mm, MapSnapshot::kUnknownHeight);
    clear(out.sigma_tenth_mm, std::uint16_t{0xffff});
    clear(out.drift_tenth_mm, std::uint16_t{0xffff});
    clear(out.clearance_tenth_mm, MapSnapshot::kNoCeiling);
    clear(out.component, MapSnapshot::kNoComponent);
    clear(out.drop_evidence, std::uint8_t{0});
    clear(out.source, EvidenceSource::unknown);
    out.edges.fill({});
}

void write_cell(const SnapshotInput& input, int u, int v, MapSnapshot& out, std::size_t at) {
    if (!input.hidden.empty() && input.hidden.at(u, v) != 0) return;  // the cell stays unknown
    const auto value = [u, v](ImageView<const float> layer) {
        return static_cast<double>(layer.at(u, v));
    };
    if (!input.drop_evidence.empty()) {
        const double evidence = value(input.drop_evidence);
        // A damaged number never proves that there is no drop.
        out.drop_evidence[at] = std::isnan(evidence)
                                    ? std::uint8_t{255}
                                    : saturated_integer<std::uint8_t>(std::round(255.0 * evidence));
    }
    const double height_m = value(input.height_m);
    if (!(std::abs(height_m) <= kHighestM)) {
        const double free_m = input.free_above_m.empty() ? std::nan("") : value(input.free_above_m);
        if (std::abs(free_m) <= kHighestM) out.height_tenth_mm[at] = tenth_mm_up(free_m);
        return;
    }
    out.height_tenth_mm[at] = height_tenth_mm(height_m);
    out.sigma_tenth_mm[at] = saturated_up(std::sqrt(value(input.variance_m2)));
    if (!input.drift_m.empty()) out.drift_tenth_mm[at] = saturated_up(value(input.drift_m));
    if (!input.clearance_m.empty()) {
        const double clearance_m = value(input.clearance_m);
        // NaN = no obstacle above was observed. A negative clearance is damaged data and becomes 0:
        // no room.
        const double scaled = std::floor(std::max(clearance_m, 0.0) * kTenthMmPerM);
        if (!std::isnan(clearance_m) && scaled < 65535.0)
            out.clearance_tenth_mm[at] =
                static_cast<std::uint16_t>(scaled);  // in range, as checked
    }
    out.source[at] = EvidenceSource::measured;
}

double distance_m(const SnapshotInput::Edge& edge, const Eigen::Vector2d& point_m) {
    const Eigen::Vector2d way_m = edge.to_m - edge.from_m;
    const double square_m2 = way_m.squaredNorm();
    const double share = square_m2 > 0.0
                             ? std::clamp((point_m - edge.from_m).dot(way_m) / square_m2, 0.0, 1.0)
                             : 0.0;
    return (edge.from_m + share * way_m - point_m).norm();
}

bool is_sound(const SnapshotInput::Edge& edge) {
    return edge.from_m.allFinite() && edge.to_m.allFinite() &&
           edge.from_m.cwiseAbs().maxCoeff() <= kFarthestM &&
           edge.to_m.cwiseAbs().maxCoeff() <= kFarthestM && std::abs(edge.upper_m) <= kHighestM &&
           std::abs(edge.lower_m) <= kHighestM && edge.height_sigma_m >= 0.0 &&
           edge.height_sigma_m <= kHighestM && edge.across_sigma_m >= 0.0 &&
           edge.across_sigma_m <= kHighestM;
}

/// Writes the nearest edges, nearest first. Leaves out edges with damaged numbers.
void write_edges(const SnapshotInput& input, MapSnapshot& out) {
    std::vector<std::pair<double, const SnapshotInput::Edge*>> sorted;
    const Eigen::Vector2d body_m = input.T_odom_body.translation_m.head<2>();
    for (const SnapshotInput::Edge& edge : input.edges)
        if (is_sound(edge)) sorted.emplace_back(distance_m(edge, body_m), &edge);
    std::sort(sorted.begin(), sorted.end());  // keeps the input order of equal distances
    const std::size_t count =
        std::min(sorted.size(), static_cast<std::size_t>(MapSnapshot::kMaxEdges));
    out.edge_count = static_cast<std::int32_t>(count);
    const auto from_origin = [](double p_m, std::int64_t origin_tenth_mm) {
        // The window begins before the body or at the corner of the map. So its origin and the
        // edges lie within kFarthestM of the origin of odom (10^9 units of 0.1 mm).
        // in range: the difference of two such numbers is below 2^31
        return static_cast<std::int32_t>(tenth_mm(p_m) - origin_tenth_mm);
    };
    for (std::size_t i = 0; i < count; ++i) {
        const SnapshotInput::Edge& edge = *sorted[i].second;
        SnapshotEdge& to = out.edges[i];
        to.from_x_tenth_mm = from_origin(edge.from_m.x(), out.origin_x_tenth_mm);
        to.from_y_tenth_mm = from_origin(edge.from_m.y(), out.origin_y_tenth_mm);
        to.to_x_tenth_mm = from_origin(edge.to_m.x(), out.origin_x_tenth_mm);
        to.to_y_tenth_mm = from_origin(edge.to_m.y(), out.origin_y_tenth_mm);
        to.upper_tenth_mm = height_tenth_mm(edge.upper_m);
        to.lower_tenth_mm = height_tenth_mm(edge.lower_m);
        to.height_sigma_tenth_mm = tenth_mm_up(edge.height_sigma_m);
        to.across_sigma_tenth_mm = tenth_mm_up(edge.across_sigma_m);
    }
}

/// Flood fill with an explicit stack. Every cell is pushed once, and its index fits 16 bits.
class Labeller {
  public:
    Labeller(MapSnapshot& map, std::int32_t step_tenth_mm) : map_(map), step_(step_tenth_mm) {}

    void label_all() {
        std::uint32_t label = 0;
        const int count = map_.nx * map_.ny;
        for (int at = 0; at < count; ++at) {
            if (!is_free(at)) continue;
            if (++label > 0xffff) return;  // the gate refuses all other cells (kNoComponent)
            fill(at, static_cast<std::uint16_t>(label));
        }
    }

  private:
    [[nodiscard]] bool is_free(int at) const {
        const auto i = static_cast<std::size_t>(at);
        return map_.source[i] == EvidenceSource::measured &&
               map_.component[i] == MapSnapshot::kNoComponent;
    }
    void push(int at, std::uint16_t label) {
        map_.component[static_cast<std::size_t>(at)] = label;
        stack_[size_++] = static_cast<std::uint16_t>(at);
    }
    void fill(int seed, std::uint16_t label) {
        push(seed, label);
        while (size_ > 0) {
            const int at = stack_[--size_];
            const int ix = at % map_.nx;
            const int iy = at / map_.nx;
            if (ix > 0) join(at, at - 1, label);
            if (ix + 1 < map_.nx) join(at, at + 1, label);
            if (iy > 0) join(at, at - map_.nx, label);
            if (iy + 1 < map_.ny) join(at, at + map_.nx, label);
        }
    }
    void join(int from, int to, std::uint16_t label) {
        if (!is_free(to)) return;
        const std::int32_t rise = map_.height_tenth_mm[static_cast<std::size_t>(to)] -
                                  map_.height_tenth_mm[static_cast<std::size_t>(from)];
        if (std::abs(rise) <= step_) push(to, label);
    }

    MapSnapshot& map_;
    std::int32_t step_;
    std::array<std::uint16_t, MapSnapshot::kMaxCells> stack_{};
    std::size_t size_ = 0;
};

/// Cells of a row or column in the order of a walk: forward, or backward with a negative stride.
struct Line {
    std::ptrdiff_t first = 0;
    std::ptrdiff_t stride = 1;
    int count = 0;
};

/// Marks the upper cells of drops along a line; see build_snapshot().
void mark_drops_on_line(const Line& line,
                        std::int32_t step_tenth_mm,
                        int reach_cells,
                        MapSnapshot& out) {
    std::ptrdiff_t upper = -1;
    int upper_i = 0;
    for (int i = 0; i < line.count; ++i) {
        const std::ptrdiff_t cell = line.first + i * line.stride;
        // The ground of the cell lies at this height or lower.
        const std::int32_t ceiling = out.height_tenth_mm[static_cast<std::size_t>(cell)];
        if (upper >= 0 && i - upper_i <= reach_cells && ceiling != MapSnapshot::kUnknownHeight &&
            ceiling - out.height_tenth_mm[static_cast<std::size_t>(upper)] < -step_tenth_mm) {
            out.drop_evidence[static_cast<std::size_t>(upper)] = 255;
        }
        if (out.source[static_cast<std::size_t>(cell)] != EvidenceSource::measured) continue;
        upper = cell;
        upper_i = i;
    }
}

void mark_drops(const SnapshotInput& input, MapSnapshot& out) {
    const std::int32_t step = height_tenth_mm(input.drop_step_m);
    const int reach =
        std::max(1, whole_cells(std::round(input.drop_reach_m / input.geometry.resolution_m)));
    const std::ptrdiff_t nx = out.nx;
    const std::ptrdiff_t ny = out.ny;
    for (std::ptrdiff_t iy = 0; iy < ny; ++iy) {
        mark_drops_on_line({iy * nx, 1, out.nx}, step, reach, out);
        mark_drops_on_line({iy * nx + nx - 1, -1, out.nx}, step, reach, out);
    }
    for (std::ptrdiff_t ix = 0; ix < nx; ++ix) {
        mark_drops_on_line({ix, nx, out.ny}, step, reach, out);
        mark_drops_on_line({ix + (ny - 1) * nx, -nx, out.ny}, step, reach, out);
    }
}

}  // namespace

Status build_snapshot(const SnapshotInput& input, MapSnapshot& out) {
    if (Status status = check(input); !status) {
        out.magic = 0;
        out.nx = out.ny = 0;
        return status;
    }
    const Window window = window_around_body(input);
    write_header(input, window, out);
    clear_cells(out);
    std::size_t at = 0;
    for (int v = window.y; v < window.y + window.ny; ++v) {
        for (int u = window.x; u < window.x + window.nx; ++u) write_cell(input, u, v, out, at++);
    }
    Labeller(out, height_tenth_mm(input.connect_step_m)).label_all();
    mark_drops(input, out);
    write_edges(input, out);
    seal(out);
    return {};
}

}  // namespace surefoot::grid
