// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/classes/ground_classes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/geometry/statistics.hpp"
#include "surefoot/grid/whole_cells.hpp"
#include "surefoot/stairs/edges/slice_mean.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr std::int32_t kNone = PatchMap::kNone;

/// A slope must be within its limit by at least this many sigma of the slope.
constexpr double kSigmas = 2.0;
constexpr double kUnseenDrop_m = 0.15;  ///< depth of the marked drop behind ground that ends
/// Largest height error over the depth of a tread, from its tilt and from map distortion (see
/// flights.cpp).
constexpr double kTread_m = 0.035;
constexpr double kLeastSigma_m = 0.001;  ///< smallest sigma of a level; no map is more accurate
constexpr std::size_t kLeastTreadCells = 12;

double square(double value) {
    return value * value;
}

Vector2d direction(double yaw_rad) {
    return {std::cos(yaw_rad), std::sin(yaw_rad)};
}

bool can_stand(GroundClass name) {
    switch (name) {
        case GroundClass::floor:
        case GroundClass::tread:
        case GroundClass::riser:
        case GroundClass::ramp:
        case GroundClass::kerb:
        case GroundClass::sill: return true;
        default: return false;
    }
}

/// The cells [ix0, ix1) x [iy0, iy1) around all points plus a rim, clipped to the map.
struct CellBox {
    int ix0 = 0, ix1 = 0, iy0 = 0, iy1 = 0;
};
template <typename Points>
CellBox box_around(const grid::GridGeometry& grid, const Points& points_m, double rim_m) {
    Vector2d low_m = Vector2d::Constant(std::numeric_limits<double>::infinity());
    Vector2d high_m = -low_m;
    for (const Vector2d& p_m : points_m) {
        low_m = low_m.cwiseMin(p_m);
        high_m = high_m.cwiseMax(p_m);
    }
    if (!low_m.allFinite() || !high_m.allFinite()) return {};
    const auto cell = [&](double at_m, double origin_m, int n) {
        const double k = std::floor((at_m - origin_m) / grid.resolution_m);
        return std::clamp(grid::whole_cells(k), 0, n);
    };
    CellBox box;
    box.ix0 = cell(low_m.x() - rim_m, grid.origin_m.x(), grid.nx);
    box.iy0 = cell(low_m.y() - rim_m, grid.origin_m.y(), grid.ny);
    box.ix1 = std::min(grid.nx, cell(high_m.x() + rim_m, grid.origin_m.x(), grid.nx) + 1);
    box.iy1 = std::min(grid.ny, cell(high_m.y() + rim_m, grid.origin_m.y(), grid.ny) + 1);
    return box;
}

std::pair<Vector2d, Vector2d> ends_of(const LineFeature& line) {
    const Vector2d way = direction(line.pose.yaw_rad);
    const Vector2d half_m = 0.5 * line.length_m * Vector2d(-way.y(), way.x());
    const Vector2d middle_m = line.pose.p_m.head<2>();
    return {middle_m - half_m, middle_m + half_m};
}

bool is_inside(const std::array<Vector2d, 4>& quad, const Vector2d& p_m) {
    int left = 0;
    for (std::size_t k = 0; k < quad.size(); ++k) {
        const Vector2d side_m = quad[(k + 1) % quad.size()] - quad[k];
        const Vector2d to_m = p_m - quad[k];
        left += side_m.x() * to_m.y() - side_m.y() * to_m.x() >= 0.0 ? 1 : 0;
    }
    return left == 0 || left == 4;
}

/// The common height of many cells.
struct TreadLevel {
    double height_m = 0.0;
    double sigma_m = 0.0;
};
/// Returns the mean of the cells that differ from the median by at most 2.5 times the scatter. Each
/// square of kCorrelation_m has one independent error. `sorted_m` is working memory.
TreadLevel level_of(const std::vector<float>& heights_m,
                    std::vector<float>& sorted_m,
                    double var_m2,
                    double cell_m2) {
    constexpr double kTrim = 2.5;
    sorted_m = heights_m;
    const float median_m = upper_median_in_place(sorted_m);
    const double scatter_m =
        std::max({robust_sigma_about(median_m, sorted_m), std::sqrt(var_m2), kLeastSigma_m});
    double sum_m = 0.0, count = 0.0;
    for (const float height_m : heights_m) {
        const auto off_m = static_cast<double>(height_m - median_m);
        if (std::abs(off_m) > kTrim * scatter_m) continue;
        sum_m += off_m;
        count += 1.0;
    }
    const double errors = std::max(1.0, count * cell_m2 / square(kCorrelation_m));
    return {static_cast<double>(median_m) + sum_m / count,
            std::max(kLeastSigma_m, scatter_m / std::sqrt(errors))};
}

double var_at(const Terrain& terrain, int ix, int iy) {
    return terrain.height_var_m2.empty() ? 0.0
                                         : static_cast<double>(terrain.height_var_m2.row(iy)[ix]);
}

}  // namespace

void GroundClassifier::classify(const Terrain& terrain,
                                const TerrainFeatures& features,
                                const PatchMap& patches,
                                GroundClasses& out) {
    const grid::GridGeometry& grid = terrain.geometry;
    out.of_cell.resize(grid.nx, grid.ny);
    out.tread_height_m.resize(grid.nx, grid.ny);
    out.tread_height_m.fill(kNanF);
    out.tread_sigma_m.resize(grid.nx, grid.ny);
    out.tread_sigma_m.fill(kNanF);
    walk_.find(terrain, features, patches);
    name_patches(patches);
    name_cells(terrain, patches, out);
    for (const LineFeature& drop : features.drops)
        if (!drop.bottom_seen) name_unseen_drop(terrain, drop, out);
    for (const Flight& flight : features.flights) name_treads(terrain, flight, out);
    for (const LineFeature& kerb : features.kerbs) {
        const auto [from_m, to_m] = ends_of(kerb);
        const double other_m = kerb.pose.p_m.z() + kerb.height_m;
        name_edge(terrain,
                  from_m,
                  to_m,
                  std::minmax({kerb.pose.p_m.z(), other_m}),
                  GroundClass::kerb,
                  out);
    }
    for (const Flight& flight : features.flights) {
        for (const Edge& edge : flight.edges) {
            const bool is_kerb = flight.steps == 1 && edge.height_m() <= config_.kerb_m;
            name_edge(terrain,
                      edge.from_m,
                      edge.to_m,
                      {edge.lower_m, edge.upper_m},
                      is_kerb ? GroundClass::kerb : GroundClass::riser,
                      out);
        }
    }
    for (const LineFeature& sill : features.sills) name_sill(terrain, sill, out);
    name_tunnels(terrain, out);
}

double GroundClassifier::off_the_way_m(const NearGround& ground, double height_m) const {
    const double above_m = height_m - static_cast<double>(ground.height_m);
    const double ramp_m =
        std::tan(config_.classes.ramp_deg * kRadPerDeg) * static_cast<double>(ground.distance_m);
    if (std::abs(above_m) <= ramp_m) return 0.0;
    return above_m > 0.0 ? above_m - ramp_m : above_m + ramp_m;
}

GroundClass GroundClassifier::walked_class(const PlanarPatch& patch) const {
    const double unsure_rad = kSigmas * patch.slope_sigma_rad;
    const double level_rad = config_.classes.level_deg * kRadPerDeg;
    const double slope_rad = patch.slope_rad();
    if (slope_rad + unsure_rad <= level_rad) return GroundClass::floor;
    if (slope_rad - unsure_rad >= level_rad &&
        slope_rad + unsure_rad <= config_.classes.ramp_deg * kRadPerDeg)
        return GroundClass::ramp;
    return GroundClass::unknown;
}

GroundClass GroundClassifier::other_class(const PlanarPatch& patch, double above_m) const {
    if (above_m < -config_.drop_m) return GroundClass::drop;
    if (above_m <= config_.classes.max_step_m) return GroundClass::unknown;
    const bool is_top = patch.slope_rad() <= config_.classes.ramp_deg * kRadPerDeg &&
                        patch.width_m >= config_.classes.min_table_m &&
                        above_m <= config_.classes.max_table_m;
    return is_top ? GroundClass::table : GroundClass::wall;
}

void GroundClassifier::name_patches(const PatchMap& patches) {
    const std::size_t count = patches.patches.size();
    above_m_.assign(count, 0.0);
    above_count_.assign(count, 0);
    for (int by = 0; by < patches.of_block.height(); ++by) {
        for (int bx = 0; bx < patches.of_block.width(); ++bx) {
            const std::int32_t id = patches.of_block.row(by)[bx];
            const NearGround& ground =
                walk_.near_ground()[static_cast<std::size_t>(by * patches.of_block.width() + bx)];
            if (id == kNone || ground.distance_m == kFar) continue;
            const Vector2d p_m = patches.block_middle_m(bx, by);
            const auto i = static_cast<std::size_t>(id);
            above_m_[i] += off_the_way_m(ground, patches.patches[i].height_m(p_m));
            ++above_count_[i];
        }
    }
    class_.assign(count, GroundClass::unknown);
    for (std::size_t i = 0; i < count; ++i) {
        if (walk_.walked(i)) {
            class_[i] = walked_class(patches.patches[i]);
        } else if (above_count_[i] > 0) {
            class_[i] = other_class(patches.patches[i], above_m_[i] / above_count_[i]);
        }
    }
}

/// Returns the class of a cell whose height is unknown.
GroundClass GroundClassifier::unseen_class(const NearGround& ground, float free_above_m) const {
    if (!(free_above_m == free_above_m) || ground.distance_m == kFar) return GroundClass::unknown;
    return off_the_way_m(ground, static_cast<double>(free_above_m)) < -config_.drop_m
               ? GroundClass::drop
               : GroundClass::unknown;
}

void GroundClassifier::name_cells(const Terrain& terrain,
                                  const PatchMap& patches,
                                  GroundClasses& out) const {
    const auto most_var_m2 = static_cast<float>(square(config_.classes.max_sigma_m));
    for (int iy = 0; iy < terrain.geometry.ny; ++iy) {
        const float* height_m = terrain.height_m.row(iy);
        const float* var_m2 =
            terrain.height_var_m2.empty() ? nullptr : terrain.height_var_m2.row(iy);
        const float* free_m = terrain.free_above_m.empty() ? nullptr : terrain.free_above_m.row(iy);
        const std::int32_t* of_cell = patches.of_cell.row(iy);
        const NearGround* near =
            walk_.near_ground().data() +
            static_cast<std::ptrdiff_t>(iy / patches.block_cells) * patches.of_block.width();
        GroundClass* to = out.of_cell.row(iy);
        int in_block = 0;
        for (int ix = 0; ix < terrain.geometry.nx; ++ix) {
            const NearGround& ground = *near;
            if (++in_block == patches.block_cells) {
                in_block = 0;
                ++near;
            }
            to[ix] = GroundClass::unknown;
            if (!(height_m[ix] == height_m[ix])) {
                if (free_m != nullptr) to[ix] = unseen_class(ground, free_m[ix]);
            } else if (of_cell[ix] != kNone) {
                to[ix] = class_[static_cast<std::size_t>(of_cell[ix])];
            } else if (ground.distance_m != kFar) {
                const double above_m = off_the_way_m(ground, static_cast<double>(height_m[ix]));
                if (above_m > config_.classes.max_step_m) to[ix] = GroundClass::wall;
                if (above_m < -config_.drop_m) to[ix] = GroundClass::drop;
            }
            if (var_m2 != nullptr && var_m2[ix] > most_var_m2 && can_stand(to[ix]))
                to[ix] = GroundClass::unknown;
        }
    }
}

void GroundClassifier::name_unseen_drop(const Terrain& terrain,
                                        const LineFeature& line,
                                        GroundClasses& out) const {
    const auto [from_m, to_m] = ends_of(line);
    const Vector2d behind_m = kUnseenDrop_m * direction(line.pose.yaw_rad);
    const Quad quad{from_m, to_m, to_m + behind_m, from_m + behind_m};
    const CellBox box = box_around(terrain.geometry, quad, 0.0);
    for (int iy = box.iy0; iy < box.iy1; ++iy) {
        for (int ix = box.ix0; ix < box.ix1; ++ix) {
            if (!terrain.known(ix, iy) && is_inside(quad, terrain.geometry.center_m({ix, iy})))
                out.of_cell.row(iy)[ix] = GroundClass::drop;
        }
    }
}

void GroundClassifier::name_treads(const Terrain& terrain,
                                   const Flight& flight,
                                   GroundClasses& out) {
    const bool up = flight.kind == FlightKind::up;
    for (std::size_t i = 0; i + 1 < flight.edges.size(); ++i) {
        const Edge& near = flight.edges[i];
        const Edge& far = flight.edges[i + 1];
        const double expected_m =
            0.5 * (up ? near.upper_m + far.lower_m : near.lower_m + far.upper_m);
        name_tread(terrain, {near.from_m, near.to_m, far.to_m, far.from_m}, expected_m, out);
    }
}

/// Fits the level of the cells inside the quad and marks the cells on that level.
void GroundClassifier::name_tread(const Terrain& terrain,
                                  const Quad& quad,
                                  double expected_m,
                                  GroundClasses& out) {
    const grid::GridGeometry& grid = terrain.geometry;
    const CellBox box = box_around(grid, quad, 0.0);
    const auto for_inside = [&](const auto& f) {
        for (int iy = box.iy0; iy < box.iy1; ++iy)
            for (int ix = box.ix0; ix < box.ix1; ++ix)
                if (is_inside(quad, grid.center_m({ix, iy}))) f(ix, iy);
    };
    const double most_var_m2 = square(config_.classes.max_sigma_m);
    heights_m_.clear();
    double var_m2 = 0.0;
    for_inside([&](int ix, int iy) {
        if (!terrain.known(ix, iy) || var_at(terrain, ix, iy) > most_var_m2) return;
        heights_m_.push_back(terrain.height_m.row(iy)[ix]);
        var_m2 += var_at(terrain, ix, iy);
    });
    if (heights_m_.size() < kLeastTreadCells) return;
    var_m2 /= static_cast<double>(heights_m_.size());
    const TreadLevel level = level_of(heights_m_, sorted_m_, var_m2, square(grid.resolution_m));
    if (!(std::abs(level.height_m - expected_m) <= std::max(kTread_m, 3.0 * level.sigma_m))) return;
    const PatchConfig& on_plane = config_.patches;
    for_inside([&](int ix, int iy) {
        GroundClass& name = out.of_cell.row(iy)[ix];
        if (!terrain.known(ix, iy)) {
            // A hole shows free space below the tread. A part that the next tread hides shows no
            // free space.
            const float free_m =
                terrain.free_above_m.empty() ? kNanF : terrain.free_above_m.row(iy)[ix];
            const bool is_hole = static_cast<double>(free_m) < level.height_m - config_.drop_m;
            name = is_hole ? GroundClass::drop : GroundClass::unknown;
            return;
        }
        const double off_m = static_cast<double>(terrain.height_m.row(iy)[ix]) - level.height_m;
        const double cell_var_m2 = var_at(terrain, ix, iy);
        const double within_m2 = std::clamp(square(on_plane.sigma_factor) * cell_var_m2,
                                            square(on_plane.tolerance_m),
                                            square(on_plane.max_tolerance_m));
        if (square(off_m) <= within_m2 && cell_var_m2 <= most_var_m2) {
            name = GroundClass::tread;
            out.tread_height_m.row(iy)[ix] = static_cast<float>(level.height_m);
            out.tread_sigma_m.row(iy)[ix] = static_cast<float>(level.sigma_m);
        } else if (can_stand(name)) {
            name = GroundClass::unknown;
        }
    });
}

/// Gives the class `name` to known cells that the line crosses, and to cells beside the line at a
/// height between both levels.
void GroundClassifier::name_edge(const Terrain& terrain,
                                 const Vector2d& from_m,
                                 const Vector2d& to_m,
                                 std::pair<double, double> levels_m,
                                 GroundClass name,
                                 GroundClasses& out) const {
    const grid::GridGeometry& grid = terrain.geometry;
    const double length_m = (to_m - from_m).norm();
    if (!(length_m > 0.0)) return;
    const Vector2d along = (to_m - from_m) / length_m;
    const double beside_m = 0.5 * config_.smear_m;
    const double crossed_m = 0.5 * grid.resolution_m * (std::abs(along.x()) + std::abs(along.y()));
    const double quarter_m = 0.25 * (levels_m.second - levels_m.first);
    const CellBox box = box_around(grid, std::array{from_m, to_m}, beside_m);
    for (int iy = box.iy0; iy < box.iy1; ++iy) {
        for (int ix = box.ix0; ix < box.ix1; ++ix) {
            const Vector2d to_cell_m = grid.center_m({ix, iy}) - from_m;
            const double t_m = to_cell_m.dot(along);
            const double off_m = std::abs(along.x() * to_cell_m.y() - along.y() * to_cell_m.x());
            if (t_m < 0.0 || t_m > length_m || off_m > std::max(beside_m, crossed_m)) continue;
            const auto z_m = static_cast<double>(terrain.height_m.row(iy)[ix]);
            // Skips objects on the step and unknown cells.
            if (!(z_m >= levels_m.first - kTread_m && z_m <= levels_m.second + kTread_m)) continue;
            const bool is_between =
                z_m > levels_m.first + quarter_m && z_m < levels_m.second - quarter_m;
            if (off_m <= crossed_m || (is_between && off_m <= beside_m))
                out.of_cell.row(iy)[ix] = name;
        }
    }
}

/// Gives the class sill to cells of at least half of the sill's height, within half of
/// `stairs.doors.max_depth_m` before and behind the sill.
void GroundClassifier::name_sill(const Terrain& terrain,
                                 const LineFeature& sill,
                                 GroundClasses& out) const {
    const auto [from_m, to_m] = ends_of(sill);
    const Vector2d half_m = 0.5 * config_.doors.max_depth_m * direction(sill.pose.yaw_rad);
    const Quad quad{from_m - half_m, to_m - half_m, to_m + half_m, from_m + half_m};
    const CellBox box = box_around(terrain.geometry, quad, 0.0);
    for (int iy = box.iy0; iy < box.iy1; ++iy) {
        for (int ix = box.ix0; ix < box.ix1; ++ix) {
            const double above_m =
                static_cast<double>(terrain.height_m.row(iy)[ix]) - sill.pose.p_m.z();
            if (above_m >= 0.5 * sill.height_m && above_m <= sill.height_m + kTread_m &&
                is_inside(quad, terrain.geometry.center_m({ix, iy})))
                out.of_cell.row(iy)[ix] = GroundClass::sill;
        }
    }
}

void GroundClassifier::name_tunnels(const Terrain& terrain, GroundClasses& out) const {
    if (terrain.clearance_m.empty()) return;
    const auto headroom_m = static_cast<float>(config_.classes.headroom_m);
    for (int iy = 0; iy < terrain.geometry.ny; ++iy) {
        const float* clearance_m = terrain.clearance_m.row(iy);
        GroundClass* to = out.of_cell.row(iy);
        for (int ix = 0; ix < terrain.geometry.nx; ++ix)
            if (clearance_m[ix] < headroom_m && can_stand(to[ix])) to[ix] = GroundClass::tunnel;
    }
}

GroundClasses classify_ground(const StairsConfig& config,
                              const Terrain& terrain,
                              const TerrainFeatures& features) {
    PatchMap patches;
    PatchFinder(config.patches).find(terrain, patches);
    GroundClasses classes;
    GroundClassifier(config).classify(terrain, features, patches, classes);
    return classes;
}

std::array<int, kGroundClassNames.size()> count_classes(const GroundClasses& classes) {
    std::array<int, kGroundClassNames.size()> count{};
    for (std::size_t i = 0; i < classes.of_cell.size(); ++i)
        ++count[static_cast<std::size_t>(classes.of_cell.data()[i])];
    return count;
}

}  // namespace surefoot::stairs
