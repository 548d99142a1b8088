// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/flights/step_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/grid/whole_cells.hpp"
#include "surefoot/stairs/edges/slice_mean.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kReach_m = 2.5;  ///< depth of the examined ground on either side of the seed
constexpr int kRounds = 3;
constexpr double kLeastTread_m = 0.05;
constexpr double kLevel_m = 0.015;  ///< largest difference of neighbouring slices of a tread
/// Edge points farther from the border of two treads belong to another object.
constexpr double kNear_m = 0.07;
constexpr double kFar_m = 0.1;   ///< largest distance of a riser's face from its tread's end
constexpr double kSide_m = 0.4;  ///< largest extension of a step beyond the seed, on either side
/// A step that is shorter than this share of the common extent of its two neighbours gets this
/// common extent.
constexpr double kRagged = 0.5;
/// Tolerance of the height of the ground on which the seed was measured.
constexpr double kTread_m = 0.03;
/// Largest difference of the steps of a flight. The code allows 5 mm (NZ D1/AS1); badly built steps
/// differ more.
constexpr double kUneven_m = 0.02;

}  // namespace

void StepFitter::find_treads(const Terrain& terrain, const EdgeLine& line) {
    treads_.clear();
    const EdgeProfiler::Slices all = profiler_.slices(terrain, line, kReach_m, kReach_m);
    const int least = std::max(2, grid::whole_cells(std::round(kLeastTread_m / all.cell_m)));
    for (int first = 0; first < all.count();) {
        if (!all.known(first)) {
            ++first;
            continue;
        }
        int length = all.strip(first, +1);
        if (length > 0) {
            add_tread(all, first, length, 0);
        } else {
            length = level_run(all, first);
            // The border slices of a tread may contain parts of its neighbours.
            if (length >= least)
                add_tread(all, first, length, length >= 8 ? 2 : length >= 4 ? 1 : 0);
        }
        first += length;
    }
}

/// Returns the number of slices, from `first` on, that are level with each other.
int StepFitter::level_run(const EdgeProfiler::Slices& all, int first) {
    double sum_m = all.at(first).height_m * all.at(first).known_share;
    double weight = all.at(first).known_share;
    int length = 1;
    for (; all.known(first + length); ++length) {
        const EdgeProfiler::Slice& next = all.at(first + length);
        if (std::abs(next.height_m - all.at(first + length - 1).height_m) > kLevel_m ||
            std::abs(next.height_m - sum_m / weight) > 2.0 * kLevel_m)
            break;
        sum_m += next.height_m * next.known_share;
        weight += next.known_share;
    }
    return length;
}

void StepFitter::add_tread(const EdgeProfiler::Slices& all, int first, int length, int margin) {
    const SliceMean mean = mean_of(all, first + margin, +1, length - 2 * margin, length_m_);
    treads_.push_back({all.begin_m + first * all.cell_m,
                       all.begin_m + (first + length) * all.cell_m,
                       mean.height_m,
                       mean.sigma_m,
                       mean.scatter_m});
}

void StepFitter::join_treads() {
    // Joins pieces of one tread.
    std::vector<Tread> joined;
    for (const Tread& tread : treads_) {
        if (!joined.empty() &&
            std::abs(tread.height_m - joined.back().height_m) < config_.min_height_m) {
            Tread& last = joined.back();
            const double a_m = last.end_m - last.begin_m;
            const double b_m = tread.end_m - tread.begin_m;
            last.height_m = (a_m * last.height_m + b_m * tread.height_m) / (a_m + b_m);
            last.end_m = tread.end_m;
            last.sigma_m = std::min(last.sigma_m, tread.sigma_m);
            last.scatter_m = std::max(last.scatter_m, tread.scatter_m);
        } else {
            joined.push_back(tread);
        }
    }
    treads_ = std::move(joined);
}

namespace {

double place_between(const auto& upper, const auto& lower) {
    // Behind the upper tread, an occluded region may begin. So the edge lies at most kNear_m behind
    // the end of the upper tread.
    return std::min(0.5 * (upper.end_m + lower.begin_m), upper.end_m + kNear_m);
}

}  // namespace

void StepFitter::find_steps(const Edge& seed) {
    steps_.clear();
    const int treads = static_cast<int>(treads_.size());
    const auto at = [&](int k) -> const Tread& { return treads_[static_cast<std::size_t>(k)]; };
    int upper = -1;
    int lower = treads;
    // Behind a board without a riser the ground below is visible. So the two treads nearest to the
    // line count, not the ground on which the seed was measured.
    const bool open = seed.height_m() > config_.max_riser_m;
    for (int k = 0; k < treads; ++k) {
        const double rise_m = upper < 0 ? 0.0 : at(upper).height_m - at(k).height_m;
        const bool is_upper =
            open ? at(k).begin_m + at(k).end_m < 0.0
                 : at(k).begin_m < 0.0 && std::abs(at(k).height_m - seed.upper_m) <= kTread_m;
        const bool is_lower = open ? rise_m >= config_.min_riser_m && rise_m <= config_.max_riser_m
                                   : std::abs(at(k).height_m - seed.lower_m) <= kTread_m;
        if (is_upper)
            upper = k;
        else if (is_lower && at(k).end_m > 0.0 && lower == treads)
            lower = k;
    }
    if (upper < 0 || lower == treads || lower <= upper) return;
    steps_.push_back(
        {.at_m = place_between(at(upper), at(lower)), .upper = at(upper), .lower = at(lower)});
    while (grow(upper, -1)) {
    }
    while (grow(lower, +1)) {
    }
}

/// Adds one step up (-1) or down (+1) from a tread, if the treads prove it. An apparent short tread
/// in between is a badly measured riser.
bool StepFitter::grow(int& from, int way) {
    const bool up = way < 0;
    const int treads = static_cast<int>(treads_.size());
    const Tread tread = treads_[static_cast<std::size_t>(from)];
    if (tread.end_m - tread.begin_m > config_.max_going_m)
        return false;  // floor or landing: too long for a tread
    const double last_m = up ? steps_.front().at_m : steps_.back().at_m;
    double usual_m = 0.0;
    for (const Step& step : steps_)
        usual_m += (step.upper.height_m - step.lower.height_m) / static_cast<double>(steps_.size());
    for (int beyond = from + way; beyond >= 0 && beyond < treads; beyond += way) {
        const Tread& next = treads_[static_cast<std::size_t>(beyond)];
        const Tread& upper = up ? next : tread;
        const Tread& lower = up ? tread : next;
        const double rise_m = upper.height_m - lower.height_m;
        const double at_m = place_between(upper, lower);
        const double going_m = std::abs(at_m - last_m);
        if (going_m > config_.max_going_m || rise_m > config_.max_riser_m) return false;
        const double sigma_m = std::hypot(upper.sigma_m, lower.sigma_m);
        const bool usual = std::abs(rise_m - usual_m) <= kUneven_m + 2.0 * sigma_m;
        const bool ends = next.end_m - next.begin_m > config_.max_going_m;
        if (going_m < config_.min_going_m || rise_m < config_.min_height_m || sigma_m > kUneven_m ||
            !(usual || ends))
            continue;
        const Step step{.at_m = at_m, .upper = upper, .lower = lower};
        steps_.insert(up ? steps_.begin() : steps_.end(), step);
        from = beyond;
        return true;
    }
    return false;
}

void StepFitter::find_borders(const Terrain& terrain, const EdgeLine& line) {
    borders_.clear();
    for (std::size_t k = 0; k < steps_.size(); ++k) {
        const Step& step = steps_[k];
        const double rise_m = step.upper.height_m - step.lower.height_m;
        BorderSearch search;
        search.edge = static_cast<int>(k);
        search.at_m = step.upper.end_m;
        search.upper_m = step.upper.height_m;
        search.below_m = upper_tolerance_m(step.upper.scatter_m, rise_m);
        search.cell_reach = config_.cell_reach;
        search.beside_m = kSide_m;
        const std::size_t before = borders_.size();
        if (sees_faces_) {
            BorderSearch face = search;
            face.at_m = step.at_m;
            add_face_points(terrain, line, face, borders_);
            // A board without a riser has no face, but the front of the next board is visible.
            if (borders_.size() > before &&
                std::abs(borders_[(before + borders_.size()) / 2].s_m - step.upper.end_m) > kFar_m)
                borders_.resize(before);
        }
        if (borders_.size() < before + kLeastPoints)
            add_border_points(terrain, line, search, borders_);
    }
}

/// Returns the turn of the common direction [rad].
double StepFitter::place_steps() {
    places_.assign(steps_.size(), ParallelEdge{});
    for (std::size_t k = 0; k < steps_.size(); ++k) places_[k].at_m = steps_[k].upper.end_m;
    const double turn_rad = fit_parallel(borders_, 0.5 * length_m_, places_);
    for (std::size_t k = 0; k < steps_.size(); ++k) {
        steps_[k].at_m = places_[k].at_m;
        steps_[k].rms_m = places_[k].rms_m;
        steps_[k].points = places_[k].points;
    }
    return turn_rad;
}

void StepFitter::measure_extents(const grid::GridGeometry& grid) {
    for (std::size_t k = 0; k < steps_.size(); ++k) {
        const Extent extent =
            longest_run(borders_, static_cast<int>(k), steps_[k].at_m, kNear_m, config_.max_gap_m);
        steps_[k].from_m = extent.from_m - 0.5 * grid.resolution_m;
        steps_[k].to_m = extent.to_m + 0.5 * grid.resolution_m;
    }
    // Between two steps the treads prove a step, even if its face is ragged.
    for (std::size_t k = 1; k + 1 < steps_.size(); ++k) {
        const Step& above = steps_[k - 1];
        const Step& below = steps_[k + 1];
        const double from_m = std::max(above.from_m, below.from_m);
        const double to_m = std::min(above.to_m, below.to_m);
        Step& step = steps_[k];
        if (step.to_m - step.from_m >= kRagged * (to_m - from_m)) continue;
        step.from_m = from_m;
        step.to_m = to_m;
        step.rms_m = std::max(step.rms_m, kNear_m);
    }
}

void StepFitter::fit(const Terrain& terrain, const Edge& seed, std::vector<Edge>& out) {
    out.clear();
    EdgeLine line;
    line.from_m = seed.from_m;
    line.to_m = seed.to_m;
    length_m_ = line.length_m();
    sees_faces_ = !terrain.density_ratio.empty() && seed.below_m(terrain.stance_m) > 0.0;
    for (int round = 0; round < kRounds; ++round) {
        find_treads(terrain, line);
        join_treads();
        find_steps(seed);
        if (steps_.size() < 2) return;
        find_borders(terrain, line);
        const double turn_rad = place_steps();
        if (round + 1 == kRounds) break;
        // The line turns about its middle.
        const Vector2d middle_m = 0.5 * (line.from_m + line.to_m);
        const Vector2d along = (line.along() + turn_rad * line.down()).normalized();
        line.from_m = middle_m - 0.5 * length_m_ * along;
        line.to_m = middle_m + 0.5 * length_m_ * along;
    }
    measure_extents(terrain.geometry);
    const Vector2d along = line.along();
    const Vector2d down = line.down();
    for (auto step = steps_.rbegin(); step != steps_.rend(); ++step) {
        if (step->to_m - step->from_m < config_.min_length_m) continue;
        const Tread& upper = step->upper;
        const Tread& lower = step->lower;
        Edge edge;
        edge.from_m = line.from_m + step->from_m * along + step->at_m * down;
        edge.to_m = line.from_m + step->to_m * along + step->at_m * down;
        edge.upper_m = upper.height_m;
        edge.lower_m = lower.height_m;
        edge.lower_seen = true;
        edge.height_sigma_m = std::hypot(upper.sigma_m, lower.sigma_m);
        edge.across_sigma_m = std::hypot(
            across_sigma_m(terrain.geometry, {edge.from_m, edge.to_m}, step->rms_m),
            sees_faces_ && terrain.view
                ? terrain.view->range_error_m(kFaceShared_px, edge.middle_m(), edge.upper_m)
                : 0.0);
        edge.angle_sigma_rad = edge.across_sigma_m * std::sqrt(12.0) / edge.length_m() /
                               std::sqrt(static_cast<double>(steps_.size()));
        edge.upper_depth_m = step->at_m - upper.begin_m;
        edge.lower_depth_m = lower.end_m - step->at_m;
        out.push_back(edge);
    }
    if (out.size() < 2) out.clear();
}

}  // namespace surefoot::stairs
