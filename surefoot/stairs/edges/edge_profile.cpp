// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/edges/edge_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/geometry/statistics.hpp"
#include "surefoot/grid/whole_cells.hpp"
#include "surefoot/stairs/edges/edge_cells.hpp"
#include "surefoot/stairs/edges/slice_mean.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kNothing = std::numeric_limits<double>::infinity();
constexpr double kUpper_m = 0.7;  ///< depth of the examined ground before an edge
constexpr double kLower_m = 1.2;
constexpr double kLeastShare = 0.25;  ///< smallest share of known cells in a slice
/// Largest difference of neighbouring slices of level ground; a ramp of 1:8 has 3 mm in 25 mm.
constexpr double kLevel_m = 0.012;
constexpr double kMeasured_m = 0.15;  ///< depth of level ground that gives the height
constexpr double kStrip_m = 0.2;      ///< largest visible depth of a tread between occluded regions
constexpr double kStripRange_m = 0.06;
constexpr double kBeside_m = 0.3;   ///< largest extension of an edge beyond the ends of its line
constexpr double kHalfTurn = 0.02;  ///< half of the largest turn [rad] of an edge against its line
/// Ground that ends is known over this depth before the edge and unknown behind.
constexpr double kEnd_m = 0.25;
constexpr double kEndRms_m = 0.025;
/// The end of the ground may be ragged by this much on either side of the line.
constexpr double kRagged_m = 0.075;
/// Largest slope that noise on level ground explains.
constexpr double kLeastSlope = 0.06;
constexpr double kSloping_m = 0.3;  ///< depth of ground that gives the slope

}  // namespace

EdgeProfiler::Slices EdgeProfiler::slices(const Terrain& terrain,
                                          const EdgeLine& line,
                                          double upper_m,
                                          double lower_m) {
    slice(terrain, line, upper_m, lower_m);
    return {slices_, -upper_slices_ * resolution_m_, resolution_m_};
}

bool EdgeProfiler::Slices::known(int slice) const {
    return slice >= 0 && slice < count() && at(slice).known_share >= kLeastShare;
}

int EdgeProfiler::Slices::strip(int slice, int way) const {
    if (!known(slice) || known(slice - way)) return 0;
    const int most = grid::whole_cells(kStrip_m / cell_m);
    double lowest_m = at(slice).height_m;
    double highest_m = lowest_m;
    int length = 1;
    for (; known(slice + length * way); ++length) {
        lowest_m = std::min(lowest_m, at(slice + length * way).height_m);
        highest_m = std::max(highest_m, at(slice + length * way).height_m);
    }
    return length <= most && highest_m - lowest_m <= kStripRange_m ? length : 0;
}

void EdgeProfiler::slice(const Terrain& terrain,
                         const EdgeLine& line,
                         double upper_m,
                         double lower_m) {
    resolution_m_ = terrain.geometry.resolution_m;
    length_m_ = line.length_m();
    upper_slices_ = grid::whole_cells(std::ceil(upper_m / resolution_m_));
    const int lower_slices = grid::whole_cells(std::ceil(lower_m / resolution_m_));
    const auto slices = static_cast<std::size_t>(upper_slices_ + lower_slices);
    slices_.assign(slices, Slice{});
    for (Slice& slice : slices_) slice.free_above_m = kNothing;
    cells_.assign(slices, 0);
    samples_.clear();
    gather(terrain, line);

    // Sorts the samples by slice, within a slice in row order.
    first_.assign(slices + 1, 0);
    for (const Sample& sample : samples_) ++first_[static_cast<std::size_t>(sample.slice) + 1];
    for (std::size_t k = 0; k < slices; ++k) first_[k + 1] += first_[k];
    sorted_.resize(samples_.size());
    next_.assign(first_.begin(), first_.end());
    for (const Sample& sample : samples_)
        sorted_[next_[static_cast<std::size_t>(sample.slice)]++] = sample;
    for (std::size_t k = 0; k < slices; ++k)
        if (first_[k + 1] > first_[k])
            measure_slice(std::span(sorted_).subspan(first_[k], first_[k + 1] - first_[k]),
                          cells_[k],
                          slices_[k]);
}

/// Collects the cells between the ends of the line and of the slices, row by row.
void EdgeProfiler::gather(const Terrain& terrain, const EdgeLine& line) {
    const auto visit = [&](int ix, int iy, double at_slice, double) {
        const int k = static_cast<int>(at_slice);  // in range: for_each_cell_about() checks it
        const auto slice = static_cast<std::size_t>(k);
        ++cells_[slice];
        const float height_m = terrain.height_m.row(iy)[ix];
        if (height_m == height_m) {
            const float var_m2 =
                terrain.height_var_m2.empty() ? 0.0F : terrain.height_var_m2.row(iy)[ix];
            samples_.push_back({k, height_m, var_m2});
        } else if (!terrain.free_above_m.empty()) {
            const auto free_m = static_cast<double>(terrain.free_above_m.row(iy)[ix]);
            if (free_m < slices_[slice].free_above_m) slices_[slice].free_above_m = free_m;
        }
    };
    for_each_cell_about(
        terrain.geometry, line, upper_slices_, static_cast<int>(slices_.size()), visit);
}

void EdgeProfiler::measure_slice(std::span<const Sample> samples, int cells, Slice& slice) {
    slice.known_share = static_cast<double>(samples.size()) / cells;
    values_.clear();
    double var_m2 = 0.0;
    for (const Sample& sample : samples) {
        values_.push_back(sample.height_m);
        var_m2 += static_cast<double>(sample.var_m2);
    }
    const float middle = upper_median_in_place(values_);
    const auto middle_m = static_cast<double>(middle);
    slice.scatter_m = robust_sigma_about(middle, values_);
    slice.sigma_m = std::sqrt(var_m2 / static_cast<double>(samples.size()));
    // The mean of the inliers is more accurate than the median.
    const double most_m = 2.5 * std::max(slice.scatter_m, 1e-4);
    double sum_m = 0.0;
    int agreeing = 0;
    for (const Sample& sample : samples) {
        if (std::abs(static_cast<double>(sample.height_m) - middle_m) > most_m) continue;
        sum_m += static_cast<double>(sample.height_m);
        ++agreeing;
    }
    slice.height_m = agreeing > 0 ? sum_m / agreeing : middle_m;
}

/// Returns the level ground near slice `first`, from there on in steps of `step`.
Level EdgeProfiler::level_from(int first, int step) const {
    const Slices all{slices_, 0.0, resolution_m_};
    const int slices = all.count();
    const auto known = [&](int k) { return all.known(k); };
    const auto level_with_next = [&](int k) {
        return known(k) && known(k + step) &&
               std::abs(at(k).height_m - at(k + step).height_m) <= kLevel_m;
    };
    // The longest level piece counts, up to the needed depth. Beside a riser, depth noise can make
    // a few slices agree.
    const int enough = std::max(1, grid::whole_cells(std::round(kMeasured_m / resolution_m_)));
    const int furthest = grid::whole_cells(std::ceil(2.0 * config_.smear_m / resolution_m_));
    int begin = first;
    int length = 0;
    for (int k = first, tried = 0; k >= 0 && k < slices && length < enough;) {
        int run = all.strip(k, step);
        if (run == 0 && known(k))
            for (run = 1; level_with_next(k + (run - 1) * step);) ++run;
        if (run > length) {
            begin = k;
            length = run;
        }
        const int passed = std::max(1, run);
        k += passed * step;
        tried += passed;
        // Behind a long occluded region the level ground begins farther away. So the search ends
        // here only if it has found level ground.
        if (tried > furthest && length > 0) break;
    }
    Level level;
    level.sigma_m = kNothing;
    if (length == 0) return level;
    const int end = begin + (length - 1) * step;
    level.ends_unknown = !known(end + step);
    level.begin_m = std::abs(begin - first) * resolution_m_;
    level.end_m = (std::abs(end - first) + 1) * resolution_m_;

    const int used = std::min(enough, length);
    const SliceMean mean = mean_of(all, begin, step, used, length_m_);
    level.height_m = mean.height_m;
    level.sigma_m = mean.sigma_m;
    level.scatter_m = mean.scatter_m;
    level.middle_m = level.begin_m + 0.5 * used * resolution_m_;
    const int most_sloping = std::max(1, grid::whole_cells(std::round(kSloping_m / resolution_m_)));
    level.slope = slope_of(begin, step, std::min(most_sloping, length));
    return level;
}

/// Returns rise over run away from the edge over `count` slices; 0 for fewer than three slices.
double EdgeProfiler::slope_of(int begin, int step, int count) const {
    if (count < 3) return 0.0;
    const double middle = 0.5 * (count - 1);
    double moment = 0.0, squares = 0.0;
    for (int i = 0; i < count; ++i) {
        moment += (i - middle) * at(begin + i * step).height_m;
        squares += (i - middle) * (i - middle);
    }
    return moment / squares / resolution_m_;
}

/// True if the ground is known and level before the line and unknown behind it, although the camera
/// would see level ground there.
bool EdgeProfiler::ground_ends(const Terrain& terrain,
                               const EdgeLine& line,
                               const Level& upper) const {
    constexpr double kKnownShare = 0.9;
    constexpr double kUnknownShare = 0.15;
    if (!terrain.view || upper.end_m < kEnd_m || line.rms_m > kEndRms_m ||
        line.length_m() < config_.min_width_m)
        return false;
    // Only a line that the rays of the camera cross can be a ground end. At a line along the rays,
    // the view ends, not the ground.
    const Vector2d middle_m = 0.5 * (line.from_m + line.to_m);
    const Vector2d observed_m = middle_m - terrain.view->T_map_camera.translation_m.head<2>();
    if (observed_m.dot(line.down()) < 0.7 * observed_m.norm()) return false;
    const int cells = grid::whole_cells(kEnd_m / resolution_m_);
    const int ragged = grid::whole_cells(kRagged_m / resolution_m_);
    for (int k = ragged; k < cells; ++k) {
        if (at(upper_slices_ - 1 - k).known_share < kKnownShare ||
            at(upper_slices_ + k).known_share > kUnknownShare)
            return false;
    }
    for (const double share : {0.1, 0.5, 0.9}) {
        const Vector2d p_m = line.from_m + share * (line.to_m - line.from_m) + kEnd_m * line.down();
        if (!terrain.view->shows({p_m.x(), p_m.y(), upper.height_m})) return false;
    }
    return true;
}

/// Moves the edge to its visible face, or else to the end of the upper ground. Returns the rms of
/// the points that place the edge.
double EdgeProfiler::place(const Terrain& terrain,
                           const EdgeLine& line,
                           const Level& upper,
                           Edge& edge) {
    BorderSearch search;
    search.upper_m = edge.upper_m;
    search.below_m = upper_tolerance_m(upper.scatter_m, edge.height_m());
    search.inside_m = config_.smear_m;
    search.cell_reach = config_.cell_reach;
    search.beside_m = kBeside_m;
    borders_.clear();
    const Vector2d to_stance_m = terrain.stance_m - line.from_m;
    if (to_stance_m.dot(line.down()) > 0.0) {  // the face is towards the stance
        add_face_points(terrain, line, search, borders_);
    }
    if (borders_.size() < kLeastPoints) add_border_points(terrain, line, search, borders_);
    ParallelEdge placed{.rms_m = line.rms_m};
    const double middle_t_m = 0.5 * length_m_;
    const double turn_rad = fit_parallel(borders_, middle_t_m, {&placed, 1});
    if (placed.points < 3) return line.rms_m;
    const Vector2d along = (line.along() + turn_rad * line.down()).normalized();
    const Vector2d middle_m = line.from_m + middle_t_m * line.along() + placed.at_m * line.down();
    Extent extent = longest_run(borders_,
                                0,
                                placed.at_m,
                                config_.fit_tolerance_m + kHalfTurn * length_m_,
                                config_.max_gap_m);
    if (extent.to_m - extent.from_m < 0.5 * length_m_) extent = {0.0, length_m_};
    const double half_cell_m = 0.5 * resolution_m_;
    edge.from_m = middle_m + (extent.from_m - half_cell_m - middle_t_m) * along;
    edge.to_m = middle_m + (extent.to_m + half_cell_m - middle_t_m) * along;
    return placed.rms_m;
}

std::optional<Edge> EdgeProfiler::measure(const Terrain& terrain, const EdgeLine& line) {
    slice(terrain, line, kUpper_m, kLower_m);
    Level upper = level_from(upper_slices_ - 1, -1);
    Level lower = level_from(upper_slices_, +1);
    if (!std::isfinite(upper.sigma_m)) return std::nullopt;
    // A continuous slope is no edge: the slopes of both sides explain the height.
    const double slope = std::min(upper.slope, -lower.slope);
    if (slope > kLeastSlope) {
        upper.height_m -= slope * upper.middle_m;
        lower.height_m += slope * lower.middle_m;
    }

    Edge edge;
    edge.from_m = line.from_m;
    edge.to_m = line.to_m;
    edge.upper_m = upper.height_m;
    edge.upper_depth_m = upper.end_m;
    double bound_m = kNothing;
    double bound_at_m = kNothing;
    const int shadow_end = std::isfinite(lower.sigma_m)
                               ? grid::whole_cells(std::round(lower.begin_m / resolution_m_))
                               : grid::whole_cells(config_.shadow_per_height / resolution_m_);
    for (int k = 0; k < shadow_end && upper_slices_ + k < static_cast<int>(slices_.size()); ++k) {
        const Slice& slice = at(upper_slices_ + k);
        if (slice.free_above_m < bound_m) {
            bound_m = slice.free_above_m;
            bound_at_m = k * resolution_m_;
        }
    }
    // Ground behind a deep occluded region may belong to another object.
    const bool near =
        lower.begin_m <=
        config_.shadow_per_height * (upper.height_m - lower.height_m) + config_.smear_m;
    const auto stands_out = [&](double lower_m, double sigma_m) {
        return upper.height_m - lower_m >=
               std::max(config_.min_height_m, config_.sigma_factor * sigma_m);
    };
    const double both_sigma_m = std::hypot(upper.sigma_m, lower.sigma_m);
    edge.height_sigma_m = upper.sigma_m;
    if (std::isfinite(lower.sigma_m) && near && lower.height_m <= bound_m + kLevel_m &&
        stands_out(lower.height_m, both_sigma_m)) {
        edge.lower_seen = true;
        edge.lower_m = lower.height_m;
        edge.lower_depth_m = lower.end_m;
        edge.height_sigma_m = both_sigma_m;
    } else if (bound_at_m <= kLower_m && stands_out(bound_m, upper.sigma_m)) {
        edge.lower_m = bound_m;
    } else if (ground_ends(terrain, line, upper)) {
        // Bounds the unseen lower ground by the ray that passes over the edge.
        const Eigen::Vector3d& camera_m = terrain.view->T_map_camera.translation_m;
        const Vector2d middle_m = 0.5 * (line.from_m + line.to_m);
        const double fall =
            (camera_m.z() - upper.height_m) / (camera_m.head<2>() - middle_m).norm();
        edge.lower_m = upper.height_m - kEnd_m * fall;
    } else {
        edge.lower_m = edge.upper_m;
        return edge;
    }
    const double rms_m = place(terrain, line, upper, edge);
    edge.across_sigma_m = across_sigma_m(terrain.geometry, {edge.from_m, edge.to_m}, rms_m);
    edge.angle_sigma_rad = edge.across_sigma_m * std::sqrt(12.0) / std::max(line.length_m(), 0.05);
    return edge;
}

}  // namespace surefoot::stairs
