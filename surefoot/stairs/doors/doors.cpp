// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/doors/doors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/geometry/statistics.hpp"
#include "surefoot/grid/whole_cells.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

/// Depth of ground examined before and behind a door.
constexpr double kGround_m = 0.4;
/// Within this distance of a wall the heights are wrong: a matcher rounds off the corner.
constexpr double kCorner_m = 0.075;
/// Largest offset along the way between the middles of facing jambs, caused by noise of the wall.
constexpr double kOffset_m = 0.15;
/// Apparent extra thickness of a wall on each side, caused by noise.
constexpr double kWallNoise_m = 0.25;
/// A cell at least this much above the ground is the foot of a jamb. It may contain wall and floor
/// and then has a height between both.
constexpr double kFoot_m = 0.1;
/// Behind a sill the matcher returns to ground level only after this many sill heights.
constexpr double kShadowPerHeight = 5.0;
constexpr double kLongestShadow_m = 0.25;
constexpr double kBin_m = 0.025;
constexpr double kSample_m = 0.05;
constexpr double kHalfProfile_m = 0.8;

double square(double x) {
    return x * x;
}

struct Range {
    double from = 0.0;
    double to = 0.0;

    /// Keeps the part where |slope x + offset| <= limit. Precondition for slope 0: |offset| <=
    /// limit.
    void cut(double slope, double offset, double limit) {
        if (std::abs(slope) < 1e-9) return;
        const double a = (-limit - offset) / slope;
        const double b = (limit - offset) / slope;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    }
};

}  // namespace

struct DoorFinder::Jamb {
    double at_m = 0.0;  ///< distance from the bottleneck's middle, across; >= 0 on both sides
    double sigma_m = 0.0;
    double front_m = 0.0;  ///< front end of the jamb along the way
    double back_m = 0.0;
    [[nodiscard]] bool faces(const Jamb& other) const {
        return front_m <= other.back_m && other.front_m <= back_m &&
               std::abs(front_m + back_m - other.front_m - other.back_m) <= 2.0 * kOffset_m;
    }
};

/// An opening in its own frame: across = to the left, along = away from the stance.
struct DoorFinder::Opening {
    Vector2d bottleneck_m;
    Vector2d across;
    double width_m = 0.0;
    double middle_m = 0.0;  ///< position of the middle across, from the bottleneck
    double sigma_m = 0.0;
    double front_m = 0.0;  ///< front of the jambs along the way, from the bottleneck
    double back_m = 0.0;
    double before_m = 0.0;  ///< height of the ground before the jambs
    double behind_m = 0.0;
    float wall_from_m = 0.0F;  ///< cells of this height or more are not ground
    /// A row of cells from the middle outwards ends at the first cell of this height or more: the
    /// foot of a jamb; sills are lower.
    float foot_from_m = 0.0F;

    [[nodiscard]] Vector2d along() const { return {across.y(), -across.x()}; }
};

struct DoorFinder::Sill {
    double above_before_m = 0.0;  ///< height above the ground before the jambs; 0 = not visible
    double ridge_m = 0.0;         ///< height above the ground on both sides; 0 = not visible
    double sigma_m = 0.0;
    double along_m = 0.0;  ///< position of the ridge along the way
};

/// The ground on one side of the jambs, as a straight line along the way.
struct DoorFinder::GroundLine {
    bool known = false;
    double at_m = 0.0;  ///< position of the end of the line at the jambs, along the way
    double height_m = 0.0;
    double slope = 0.0;
    double point_var_m2 = 0.0;  ///< variance of the mean height over the width, at one position
    double var_m2 = 0.0;        ///< variance of height_m
    [[nodiscard]] double height_at(double along_m) const {
        return height_m + slope * (along_m - at_m);
    }
};

void DoorFinder::find(const Terrain& terrain,
                      std::vector<Door>& doors,
                      std::vector<LineFeature>& sills) {
    SUREFOOT_ASSERT(!config_.problem());
    doors.clear();
    sills.clear();
    cell_m_ = terrain.geometry.resolution_m;
    const BottleneckLimits limits{
        config_.min_width_m, config_.max_width_m, config_.max_depth_m, config_.rise_m};
    for (const Bottleneck& bottleneck : bottlenecks_.find(terrain, limits)) {
        Opening opening;
        opening.bottleneck_m = bottleneck.middle_m;
        opening.width_m = bottleneck.width_m;
        opening.across = bottleneck.across;
        if (opening.along().dot(bottleneck.middle_m - terrain.stance_m) < 0.0)
            opening.across = -opening.across;
        if (!measure(terrain, opening)) continue;
        if (const auto ridge = sill(opening)) report(opening, *ridge, doors, sills);
    }
}

void DoorFinder::report(const Opening& opening,
                        const Sill& sill,
                        std::vector<Door>& doors,
                        std::vector<LineFeature>& sills) {
    const Vector2d along = opening.along();
    const Vector2d axis_m = opening.bottleneck_m + opening.middle_m * opening.across;
    const Vector2d middle_m = axis_m + 0.5 * (opening.front_m + opening.back_m) * along;
    Door door;
    door.pose.p_m = {middle_m.x(), middle_m.y(), opening.before_m};
    door.pose.yaw_rad = std::atan2(along.y(), along.x());
    door.width_m = opening.width_m;
    door.width_sigma_m = opening.sigma_m;
    door.sill_m = sill.above_before_m;
    door.sill_sigma_m = sill.sigma_m;
    door.clearance_m = clearance_m(opening);
    doors.push_back(door);
    if (sill.ridge_m == 0.0) return;
    const Vector2d ridge_m = axis_m + sill.along_m * along;
    LineFeature line;
    line.pose = {{ridge_m.x(), ridge_m.y(), opening.before_m}, door.pose.yaw_rad};
    line.height_m = sill.ridge_m;
    line.length_m = opening.width_m;
    line.sigma_m = sill.sigma_m;
    line.across_sigma_m = kBin_m;
    sills.push_back(line);
}

/// Returns false if the opening is not a door.
bool DoorFinder::measure(const Terrain& terrain, Opening& opening) {
    const auto before_m = ground_m(terrain, opening, -0.6, -0.2);
    if (!before_m || !ground_m(terrain, opening, -0.2, 0.2)) return false;
    const auto behind_m = ground_m(terrain, opening, 0.2, 0.6);
    if (!behind_m) return false;
    opening.before_m = *before_m;
    opening.behind_m = *behind_m;
    opening.wall_from_m = static_cast<float>(std::min(*before_m, *behind_m) + config_.rise_m);
    opening.foot_from_m = static_cast<float>(std::max(*before_m, *behind_m) + kFoot_m);
    gather(terrain, opening);
    if (!turn_to_walls(opening)) return false;
    const auto left = jamb(terrain, opening, 1.0);
    const auto right = jamb(terrain, opening, -1.0);
    if (!left || !right) return false;
    opening.width_m = left->at_m + right->at_m;
    opening.middle_m = 0.5 * (left->at_m - right->at_m);
    opening.sigma_m = std::sqrt(square(left->sigma_m) + square(right->sigma_m));
    opening.front_m = std::min(left->front_m, right->front_m);
    opening.back_m = std::max(left->back_m, right->back_m);
    if (opening.width_m < config_.min_width_m || opening.width_m > config_.max_width_m ||
        opening.back_m - opening.front_m > config_.max_depth_m || !left->faces(*right))
        return false;
    return has_wall(opening, 1.0, *left) && has_wall(opening, -1.0, *right) &&
           !goes_on(opening, 1.0, *left) && !goes_on(opening, -1.0, *right);
}

void DoorFinder::gather(const Terrain& terrain, const Opening& opening) {
    const grid::GridGeometry& g = terrain.geometry;
    const Vector2d& across = opening.across;
    const Vector2d along = opening.along();
    const double across_m = 0.5 * opening.width_m + config_.wall_length_m + 0.3;
    const double rows_m = across_m * std::abs(across.y()) + kHalfProfile_m * std::abs(along.y());
    const Vector2d bottleneck = (opening.bottleneck_m - g.origin_m) / cell_m_;
    const int last_y = std::min(g.ny - 1, grid::whole_cells(bottleneck.y() + rows_m / cell_m_));
    near_.clear();
    for (int iy = std::max(0, grid::whole_cells(bottleneck.y() - rows_m / cell_m_)); iy <= last_y;
         ++iy) {
        const double y_m = (iy + 0.5 - bottleneck.y()) * cell_m_;
        Range x_m{-g.nx * cell_m_, g.nx * cell_m_};
        x_m.cut(across.x(), across.y() * y_m, across_m);
        x_m.cut(along.x(), along.y() * y_m, kHalfProfile_m);
        // If an opening is almost parallel to the rows, the range may exceed all integers.
        const auto cell_at = [&](double offset_m) {
            return bottleneck.x() + offset_m / cell_m_ - 0.5;
        };
        const int last_x = std::min(g.nx - 1, grid::whole_cells(std::floor(cell_at(x_m.to))));
        for (int ix = std::max(0, grid::whole_cells(std::ceil(cell_at(x_m.from)))); ix <= last_x;
             ++ix) {
            if (!terrain.known(ix, iy)) continue;
            Near cell;
            cell.offset_m = {(ix + 0.5 - bottleneck.x()) * cell_m_, y_m};
            cell.height_m = terrain.height_m.row(iy)[ix];
            cell.var_m2 = terrain.height_var_m2.empty() ? 0.0F : terrain.height_var_m2.row(iy)[ix];
            cell.clearance_m = terrain.clearance_m.empty() ? static_cast<float>(kNan)
                                                           : terrain.clearance_m.row(iy)[ix];
            near_.push_back(cell);
        }
    }
}

/// Returns the median height of the ground from `from_m` to `to_m` along the way. Returns nothing
/// if less than 60 % of the samples are known.
std::optional<double> DoorFinder::ground_m(const Terrain& terrain,
                                           const Opening& opening,
                                           double from_m,
                                           double to_m) {
    const double half_m = 0.5 * opening.width_m - 0.1;
    const double apart_m = std::max(cell_m_, kSample_m);
    int places = 0;
    values_.clear();
    for (double along_m = from_m + 0.5 * apart_m; along_m < to_m; along_m += apart_m) {
        for (double across_m = -half_m; across_m <= half_m; across_m += apart_m) {
            const Vector2d place_m =
                opening.bottleneck_m + across_m * opening.across + along_m * opening.along();
            const auto cell = terrain.geometry.cell_at(place_m.x(), place_m.y());
            ++places;
            if (cell && terrain.known(cell->ix, cell->iy))
                values_.push_back(terrain.height_m.row(cell->iy)[cell->ix]);
        }
    }
    if (static_cast<double>(values_.size()) < 0.6 * places || values_.empty()) return std::nullopt;
    return static_cast<double>(upper_median_in_place(values_));
}

/// Fits a line through the cells of both walls. Minimises the absolute distances, because most
/// distant cells are false points behind a jamb, all on one side. Method: least squares, reweighted
/// with the inverse of the previous distance. Returns false if the line turns too far.
bool DoorFinder::turn_to_walls(Opening& opening) const {
    constexpr int kRounds = 6;
    constexpr double kSure_m = 0.03;      // nearer cells have equal weights; about one cell
    constexpr double kMaxTurn_rad = 0.6;  // the blocks give the direction more accurately than this
    const Vector2d first = opening.across;
    double offset_m = 0.0;
    for (int round = 0; round < kRounds; ++round) {
        int cells = 0;
        double n = 0.0;
        double p = 0.0;
        double q = 0.0;
        double pp = 0.0;
        double pq = 0.0;
        for (const Near& cell : near_) {
            if (cell.height_m < opening.wall_from_m) continue;
            const double across_m = cell.offset_m.dot(opening.across);
            const double along_m = cell.offset_m.dot(opening.along());
            if (std::abs(along_m - offset_m) > kWallNoise_m) continue;
            const double weight = 1.0 / std::max(kSure_m, std::abs(along_m - offset_m));
            n += weight;
            p += weight * across_m;
            q += weight * along_m;
            pp += weight * across_m * across_m;
            pq += weight * across_m * along_m;
            ++cells;
        }
        if (cells < 6) return false;
        const double slope = (n * pq - p * q) / std::max(1e-9, n * pp - p * p);
        offset_m = (q - slope * p) / n;
        opening.across = (opening.across + slope * opening.along()).normalized();
    }
    return opening.across.dot(first) > std::cos(kMaxTurn_rad);
}

/// Walks from the middle of the opening outwards, one row of cells after another.
void DoorFinder::find_row_ends(const Terrain& terrain, const Opening& opening, double side) {
    const grid::GridGeometry& g = terrain.geometry;
    const Vector2d along = opening.along();
    const bool rows_along_x = std::abs(opening.across.x()) >= std::abs(opening.across.y());
    const int axis = rows_along_x ? 0 : 1;
    const int other = 1 - axis;
    const int step = side * opening.across[axis] > 0.0 ? 1 : -1;
    const double depth_m = 0.5 * config_.max_depth_m + 0.1;
    const double reach_m = 0.5 * config_.max_width_m + 0.2;
    const double lines_m = depth_m * std::abs(along[other]) + reach_m * std::abs(along[axis]);
    const double begin = (opening.bottleneck_m[other] - g.origin_m[other] - lines_m) / cell_m_;
    const double end = begin + 2.0 * lines_m / cell_m_;
    ends_.clear();
    for (int line = std::max(0, grid::whole_cells(begin));
         line <= std::min((rows_along_x ? g.ny : g.nx) - 1, grid::whole_cells(end));
         ++line) {
        const double line_m = g.origin_m[other] + (line + 0.5) * cell_m_;
        const double at_m = (line_m - opening.bottleneck_m[other]) / along[other];
        const double start_m = opening.bottleneck_m[axis] + at_m * along[axis] - g.origin_m[axis];
        int unknown = 0;
        for (int i = grid::whole_cells(std::floor(start_m / cell_m_));; i += step) {
            const grid::Cell cell = rows_along_x ? grid::Cell{i, line} : grid::Cell{line, i};
            if (!g.contains(cell)) break;
            const Vector2d offset_m = g.center_m(cell) - opening.bottleneck_m;
            const double across_m = side * offset_m.dot(opening.across);
            if (across_m > reach_m) break;
            if (std::abs(offset_m.dot(along)) > depth_m) continue;
            const float height_m = terrain.height_m.row(cell.iy)[cell.ix];
            if (height_m >= opening.foot_from_m) {
                ends_.push_back({across_m, offset_m.dot(along)});
                break;
            }
            unknown = height_m == height_m ? 0 : unknown + 1;
            if (unknown >= 2) break;  // the wall may begin anywhere in the unknown cells
        }
    }
}

std::optional<DoorFinder::Jamb> DoorFinder::jamb(const Terrain& terrain,
                                                 const Opening& opening,
                                                 double side) {
    find_row_ends(terrain, opening, side);
    std::sort(ends_.begin(), ends_.end(), [](const RowEnd& a, const RowEnd& b) {
        return a.across_m < b.across_m;
    });
    // At a straight wall the last cells of the rows lie within one cell of each other.
    const double spread_m = (1.0 + 1e-6) * cell_m_;
    std::size_t most = 0;
    const auto alike_from = [&](std::size_t i) {
        std::size_t j = i;
        while (j < ends_.size() && ends_[j].across_m - ends_[i].across_m <= spread_m) ++j;
        return j - i;
    };
    for (std::size_t i = 0; i < ends_.size(); ++i) most = std::max(most, alike_from(i));
    if (most < 2) return std::nullopt;
    std::size_t first = 0;
    while (2 * alike_from(first) < most || alike_from(first) < 2) ++first;
    const std::size_t count = alike_from(first);
    Jamb jamb;
    jamb.front_m = std::numeric_limits<double>::infinity();
    jamb.back_m = -jamb.front_m;
    for (std::size_t i = first; i < first + count; ++i) {
        jamb.at_m += ends_[i].across_m / static_cast<double>(count);
        jamb.front_m = std::min(jamb.front_m, ends_[i].along_m);
        jamb.back_m = std::max(jamb.back_m, ends_[i].along_m);
    }
    const double sine = std::min(std::abs(opening.across.x()), std::abs(opening.across.y()));
    const double cosine = std::max(std::abs(opening.across.x()), std::abs(opening.across.y()));
    jamb.at_m += 0.5 * sine * cell_m_;
    // In one row the error is uniform over one cell. From row to row the jamb moves by a part of a
    // cell, so the rows sample different parts of a cell. At 45 deg it moves by a whole cell, so
    // all rows sample the same part.
    const double moves = std::min(sine / cosine, 1.0 - sine / cosine);
    const double parts = 1.0 + moves * static_cast<double>(count - 1);
    jamb.sigma_m =
        std::sqrt(square(cell_m_ * cosine) / (12.0 * parts) + square(config_.jamb_sigma_m));
    return jamb;
}

bool DoorFinder::has_wall(const Opening& opening, double side, const Jamb& jamb) {
    const double bin_m = std::max(cell_m_, kBin_m);
    // in range: wall_length_m is at most 10 m (describe()), and bin_m is at least kBin_m
    const auto bins = static_cast<std::size_t>(std::max(1.0, config_.wall_length_m / bin_m));
    hits_.assign(bins, 0);
    float highest_m = -std::numeric_limits<float>::infinity();
    const double middle_m = 0.5 * (opening.front_m + opening.back_m);
    for (const Near& cell : near_) {
        if (cell.height_m < opening.wall_from_m) continue;
        if (std::abs(cell.offset_m.dot(opening.along()) - middle_m) > kWallNoise_m) continue;
        const double bin = (side * cell.offset_m.dot(opening.across) - jamb.at_m) / bin_m + 0.5;
        if (!(bin >= 0.0 && bin < static_cast<double>(bins))) continue;
        hits_[static_cast<std::size_t>(bin)] = 1;  // in range: as checked
        highest_m = std::max(highest_m, cell.height_m);
    }
    const auto hits = std::count(hits_.begin(), hits_.end(), 1);
    return static_cast<double>(highest_m) >=
               std::min(opening.before_m, opening.behind_m) + config_.wall_height_m &&
           static_cast<double>(hits) >= 0.7 * static_cast<double>(bins);
}

/// True if the wall continues along the way before or behind the jamb. Then the jamb is the side of
/// an object that stands along the way.
bool DoorFinder::goes_on(const Opening& opening, double side, const Jamb& jamb) const {
    constexpr double kBeside_m = 0.25;
    constexpr double kAway_m = 0.15;  // beyond the noise of the visible wall
    constexpr double kFar_m = 0.45;
    double at_jamb = 0.0;
    double before = 0.0;
    double behind = 0.0;
    for (const Near& cell : near_) {
        if (cell.height_m < opening.wall_from_m) continue;
        const double beside_m = side * cell.offset_m.dot(opening.across) - jamb.at_m;
        if (beside_m < 0.0 || beside_m > kBeside_m) continue;
        const double along_m = cell.offset_m.dot(opening.along());
        const double before_m = opening.front_m - along_m;
        const double behind_m = along_m - opening.back_m;
        at_jamb += before_m <= 0.0 && behind_m <= 0.0 ? 1.0 : 0.0;
        before += before_m >= kAway_m && before_m <= kFar_m ? 1.0 : 0.0;
        behind += behind_m >= kAway_m && behind_m <= kFar_m ? 1.0 : 0.0;
    }
    const double depth_m = opening.back_m - opening.front_m + cell_m_;
    const double half = 0.5 * at_jamb / depth_m * (kFar_m - kAway_m);
    return before > half || behind > half;
}

void DoorFinder::take_profile(const Opening& opening) {
    const double bin_m = std::max(cell_m_, kBin_m);
    const double half_m = 0.5 * opening.width_m - kCorner_m;
    // in range: bin_m is at least kBin_m
    profile_.assign(static_cast<std::size_t>(2.0 * kHalfProfile_m / bin_m) + 1, {});
    for (const Near& cell : near_) {
        if (cell.height_m >= opening.wall_from_m) continue;
        if (std::abs(cell.offset_m.dot(opening.across) - opening.middle_m) > half_m) continue;
        const double along_m = cell.offset_m.dot(opening.along());
        const int k = std::clamp(grid::whole_cells((along_m + kHalfProfile_m) / bin_m),
                                 0,
                                 static_cast<int>(profile_.size()) - 1);
        Bin& bin = profile_[static_cast<std::size_t>(k)];
        bin.sum_m += static_cast<double>(cell.height_m);
        bin.var_sum_m2 += static_cast<double>(cell.var_m2);
        bin.count += 1;
    }
}

/// Fits a line to the profile from the jambs, at `at_m`, to `far_m`.
DoorFinder::GroundLine DoorFinder::ground_line(const Opening& opening,
                                               double at_m,
                                               double far_m) const {
    const double bin_m = std::max(cell_m_, kBin_m);
    const double least = 0.3 * (opening.width_m - 2.0 * kCorner_m) * bin_m / square(cell_m_);
    const auto bin_at = [&](double along_m) {
        return grid::whole_cells(std::floor((along_m + kHalfProfile_m) / bin_m));
    };
    const int first = std::max(0, bin_at(std::min(at_m, far_m)));
    const int last = std::min(static_cast<int>(profile_.size()) - 1, bin_at(std::max(at_m, far_m)));
    double n = 0.0;
    double x = 0.0;
    double z = 0.0;
    double xx = 0.0;
    double xz = 0.0;
    double zz = 0.0;
    double cell_var_m2 = 0.0;
    for (int i = first; i <= last; ++i) {
        const Bin& bin = profile_[static_cast<std::size_t>(i)];
        if (bin.count < least) continue;
        const double bin_x = (i + 0.5) * bin_m - kHalfProfile_m - at_m;
        n += 1.0;
        x += bin_x;
        z += bin.mean_m();
        xx += bin_x * bin_x;
        xz += bin_x * bin.mean_m();
        zz += square(bin.mean_m());
        cell_var_m2 += bin.var_sum_m2 / bin.count;
    }
    GroundLine line;
    if (n < 4.0) return line;
    line.known = true;
    line.at_m = at_m;
    const double sxx = xx - x * x / n;
    line.slope = (xz - x * z / n) / sxx;
    line.height_m = (z - line.slope * x) / n;
    const double rest_m2 = std::max(0.0, (zz - z * z / n) - square(line.slope) * sxx) / (n - 2.0);
    const double errors_across = std::max(1.0, opening.width_m / config_.correlation_m);
    const double errors_along = std::max(1.0, n * bin_m / config_.correlation_m);
    line.point_var_m2 = std::max(rest_m2, cell_var_m2 / n / errors_across);
    // The variance at the end of a line has one part from its mean and three parts from its slope.
    line.var_m2 = 4.0 * line.point_var_m2 / errors_along;
    return line;
}

/// Measures the sill. Returns nothing if the ground beside the jambs is not known well enough.
std::optional<DoorFinder::Sill> DoorFinder::sill(const Opening& opening) {
    take_profile(opening);
    const double bin_m = std::max(cell_m_, kBin_m);
    const double front_m = opening.front_m - kCorner_m;
    const double back_m = opening.back_m + kCorner_m;
    const GroundLine before = ground_line(opening, front_m, front_m - kGround_m);
    if (!before.known) return std::nullopt;
    double top_m = 0.0;
    for (std::size_t i = 0; i + 1 < profile_.size(); ++i) {
        const double along_m = static_cast<double>(i + 1) * bin_m - kHalfProfile_m;
        if (along_m < front_m || along_m > back_m || profile_[i].count == 0) continue;
        top_m = std::max(top_m, profile_[i].mean_m() - before.height_at(along_m));
    }
    // A matcher fills the occluded region behind a sill, beginning at the sill.
    const double seen_m = back_m + std::min(kShadowPerHeight * top_m, kLongestShadow_m);
    const GroundLine behind = ground_line(opening, seen_m, seen_m + kGround_m);
    if (!behind.known) return std::nullopt;
    Sill sill;
    sill.sigma_m = std::sqrt(std::max(before.point_var_m2, behind.point_var_m2) +
                             0.5 * (before.var_m2 + behind.var_m2));
    const double least_m = std::max(config_.min_sill_m, config_.sigma_factor * sill.sigma_m);
    // If the ground has a step, a ridge must be higher than both sides. If the ground has no step,
    // the ridge must be higher than the line between both sides, which is more certain than an
    // extrapolation.
    const double middle_m = 0.5 * (front_m + back_m);
    const bool step = std::abs(behind.height_at(middle_m) - before.height_at(middle_m)) > least_m;
    double ridge_m = 0.0;
    double above_m = 0.0;
    for (std::size_t i = 0; i + 1 < profile_.size(); ++i) {
        const Bin& a = profile_[i];
        const Bin& b = profile_[i + 1];
        const double along_m = static_cast<double>(i + 1) * bin_m - kHalfProfile_m;
        if (along_m < front_m || along_m > back_m || a.count == 0 || b.count == 0) continue;
        const double share = (along_m - front_m) / (seen_m - front_m);
        const double line_m = (1.0 - share) * before.height_m + share * behind.height_m;
        const double base_m = step ? before.height_at(along_m) : line_m;
        const double high_m = step ? std::max(base_m, behind.height_at(along_m)) : line_m;
        const double height_m = 0.5 * (a.mean_m() + b.mean_m());
        above_m = std::max(above_m, height_m - base_m);
        if (height_m - high_m <= ridge_m) continue;
        ridge_m = height_m - high_m;
        sill.along_m = along_m;
    }
    sill.above_before_m = above_m >= least_m ? above_m : 0.0;
    sill.ridge_m = ridge_m >= least_m ? ridge_m : 0.0;
    return sill;
}

/// Returns the smallest free height that more than a single wrong match supports.
double DoorFinder::clearance_m(const Opening& opening) {
    values_.clear();
    for (const Near& cell : near_) {
        const double along_m = cell.offset_m.dot(opening.along());
        const double across_m = cell.offset_m.dot(opening.across) - opening.middle_m;
        if (along_m < opening.front_m || along_m > opening.back_m) continue;
        if (std::abs(across_m) > 0.5 * opening.width_m - 0.1) continue;
        if (std::isfinite(cell.clearance_m) && cell.height_m < opening.wall_from_m)
            values_.push_back(cell.clearance_m);
    }
    const auto rank =
        saturated_integer<std::size_t>(std::max(1.0, square(config_.overhead_side_m / cell_m_))) -
        1;
    if (values_.size() <= rank) return kNan;
    const auto place = values_.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(values_.begin(), place, values_.end());
    return static_cast<double>(*place);
}

void DoorConfig::describe(ConfigVisitor& visitor) {
    visitor.number("min_width_m", min_width_m, 0.1, 10.0, "smallest width of a door opening");
    visitor.number("max_width_m", max_width_m, 0.1, 10.0, "largest width of a door opening");
    visitor.number("max_depth_m",
                   max_depth_m,
                   0.05,
                   10.0,
                   "largest depth of a door; deeper passages are corridors");
    visitor.number(
        "rise_m",
        rise_m,
        0.01,
        2.0,
        "smallest height above the neighbouring ground at which a cell may belong to a wall");
    visitor.number("wall_height_m",
                   wall_height_m,
                   0.01,
                   3.0,
                   "a wall must be visible up to at least this height above the ground");
    visitor.number("wall_length_m",
                   wall_length_m,
                   0.01,
                   10.0,
                   "smallest length of the wall on each side of a door");
    visitor.number(
        "min_sill_m", min_sill_m, 0.0, 1.0, "smallest height of a sill that is reported");
    visitor.number(
        "sigma_factor",
        sigma_factor,
        0.0,
        100.0,
        "smallest height of a sill above the floor, as a multiple of the sigma of this height");
    visitor.number(
        "correlation_m",
        correlation_m,
        0.001,
        10.0,
        "distance on the ground over which the errors of the stereo matcher are correlated");
    visitor.number("jamb_sigma_m",
                   jamb_sigma_m,
                   0.0,
                   1.0,
                   "one sigma of the position of a jamb, without the error from the cell size");
    visitor.number("overhead_side_m",
                   overhead_side_m,
                   0.0,
                   1.0,
                   "side length of a square; an overhead object of smaller area may be a wrong "
                   "match and does not limit the clearance");
}

std::optional<std::string> DoorConfig::problem() const {
    if (max_width_m < min_width_m) {
        return fmt::format(
            "stairs.doors.max_width_m = {} must not be below stairs.doors.min_width_m = {}",
            max_width_m,
            min_width_m);
    }
    if (wall_height_m >= rise_m) return std::nullopt;
    return fmt::format("stairs.doors.wall_height_m = {} must not be below stairs.doors.rise_m = {}",
                       wall_height_m,
                       rise_m);
}

}  // namespace surefoot::stairs
