// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/step_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kReach_m = 2.5;  ///< to either side of the seed
constexpr int kRounds = 3;
constexpr double kLeastShare = 0.3;  ///< of a slice that must be known
constexpr double kLevel_m = 0.015;   ///< neighbouring slices of a tread differ by less
/// Edge points further from where the treads pass into each other belong to something else.
constexpr double kNear_m = 0.07;
constexpr double kSide_m = 0.4;  ///< a step may be so much wider than the seed, on either side
constexpr double kHuber_m = 0.012;
/// Ground that the seed was measured on.
constexpr double kTread_m = 0.03;
/// Steps of a flight differ by 5 mm by the code (NZ D1/AS1), by more where they are badly made.
constexpr double kUneven_m = 0.02;
constexpr double kCorrelation_m = 0.1;

}  // namespace

void StepFitter::find_treads(const Terrain& terrain, const EdgeLine& line) {
    treads_.clear();
    const auto [slices, begin_m] = profiler_.slices(terrain, line, kReach_m, kReach_m);
    const double cell_m = terrain.geometry.resolution_m;
    const auto known = [&](std::size_t k) { return slices[k].known_share >= kLeastShare; };
    const auto least = static_cast<std::size_t>(std::max(2.0, std::floor(0.05 / cell_m + 0.5)));
    for (std::size_t first = 0; first < slices.size();) {
        if (!known(first)) {
            ++first;
            continue;
        }
        std::size_t last = first;
        double sum_m = slices[first].height_m * slices[first].known_share;
        double weight = slices[first].known_share;
        double var_m2 = 0.0;
        while (last + 1 < slices.size() && known(last + 1) &&
               std::abs(slices[last + 1].height_m - slices[last].height_m) <= kLevel_m &&
               std::abs(slices[last + 1].height_m - sum_m / weight) <= 2.0 * kLevel_m) {
            ++last;
            sum_m += slices[last].height_m * slices[last].known_share;
            weight += slices[last].known_share;
        }
        if (last - first + 1 >= least) {
            for (std::size_t k = first; k <= last; ++k)
                var_m2 += slices[k].known_share * std::max(std::pow(slices[k].scatter_m, 2),
                                                           std::pow(slices[k].sigma_m, 2));
            const double area_m2 = weight * cell_m * length_m_;
            const double independent = std::max(1.0, area_m2 / (kCorrelation_m * kCorrelation_m));
            treads_.push_back({begin_m + static_cast<double>(first) * cell_m,
                               begin_m + static_cast<double>(last + 1) * cell_m,
                               sum_m / weight,
                               std::sqrt(var_m2 / weight / independent)});
        }
        first = last + 1;
    }
}

void StepFitter::join_treads() {
    // Pieces of one tread come together.
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
        } else {
            joined.push_back(tread);
        }
    }
    treads_ = std::move(joined);
}

namespace {

double place_between(const auto& upper, const auto& lower) {
    // In a shadow the edge is where the upper tread ends.
    return std::min(0.5 * (upper.end_m + lower.begin_m), upper.end_m + kNear_m);
}

}  // namespace

void StepFitter::find_steps(const Edge& seed) {
    steps_.clear();
    const int treads = static_cast<int>(treads_.size());
    const auto at = [&](int k) -> const Tread& { return treads_[static_cast<std::size_t>(k)]; };
    int upper = -1;
    int lower = treads;
    for (int k = 0; k < treads; ++k) {
        const bool is_upper = std::abs(at(k).height_m - seed.upper_m) <= kTread_m;
        const bool is_lower = std::abs(at(k).height_m - seed.lower_m) <= kTread_m;
        if (is_upper && at(k).begin_m < 0.0) upper = k;
        if (is_lower && at(k).end_m > 0.0 && lower == treads) lower = k;
    }
    if (upper < 0 || lower == treads || lower <= upper) return;
    steps_.push_back(
        {.at_m = place_between(at(upper), at(lower)), .upper = at(upper), .lower = at(lower)});
    while (grow(upper, -1)) {
    }
    while (grow(lower, +1)) {
    }
}

/// One step further up (-1) or down (+1) from a tread, if there is a proven one. What looks like a
/// short tread in between is where a riser was seen badly.
bool StepFitter::grow(int& from, int way) {
    const bool up = way < 0;
    const int treads = static_cast<int>(treads_.size());
    const Tread tread = treads_[static_cast<std::size_t>(from)];
    if (tread.end_m - tread.begin_m > config_.max_going_m) return false;  // floor or landing
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

void StepFitter::take_points(std::span<const EdgePoint> points, const EdgeLine& line) {
    members_.clear();
    const Vector2d along = line.along();
    const Vector2d down = line.down();
    for (const EdgePoint& point : points) {
        const Vector2d d_m = point.at_m.cast<double>() - line.from_m;
        const double t_m = d_m.dot(along);
        if (t_m < -kSide_m || t_m > length_m_ + kSide_m) continue;
        const double s_m = d_m.dot(down);
        const Vector2d side(point.side == Side::plus_x    ? 1.0
                            : point.side == Side::minus_x ? -1.0
                                                          : 0.0,
                            point.side == Side::plus_y    ? 1.0
                            : point.side == Side::minus_y ? -1.0
                                                          : 0.0);
        if (side.dot(down) < 0.1) continue;
        for (std::size_t k = 0; k < steps_.size(); ++k) {
            const Tread& upper = steps_[k].upper;
            const Tread& lower = steps_[k].lower;
            // In a shadow the edge is where the upper tread ends.
            if (s_m < upper.end_m - kNear_m || s_m > lower.begin_m + kNear_m) continue;
            if (std::abs(static_cast<double>(point.upper_m) - upper.height_m) > kNear_m) continue;
            members_.push_back({k, s_m, t_m});
            break;
        }
    }
}

double StepFitter::place_steps() {
    // s = offset of the step + turn t: Gauss-Newton with Huber's weights, the offsets eliminated.
    for (Step& step : steps_) {
        along_m_.clear();
        for (const Member& member : members_)
            if (&steps_[member.step] == &step) along_m_.push_back(member.s_m);
        step.points = static_cast<int>(along_m_.size());
        if (along_m_.empty()) continue;
        const auto middle = along_m_.begin() + static_cast<std::ptrdiff_t>(along_m_.size() / 2);
        std::nth_element(along_m_.begin(), middle, along_m_.end());
        step.at_m = *middle;
    }
    const double middle_t_m = 0.5 * length_m_;
    double turn_rad = 0.0;
    struct Sums {
        double w = 0.0, t = 0.0, s = 0.0, tt = 0.0, ts = 0.0, ss = 0.0;
    };
    std::vector<Sums> sums(steps_.size());
    for (int round = 0; round < 6; ++round) {
        std::fill(sums.begin(), sums.end(), Sums{});
        for (const Member& member : members_) {
            const double t_m = member.t_m - middle_t_m;
            const double residual_m = member.s_m - steps_[member.step].at_m - turn_rad * t_m;
            const double size_m = std::abs(residual_m);
            const double w = size_m <= kHuber_m ? 1.0 : kHuber_m / size_m;
            Sums& sum = sums[member.step];
            sum.w += w;
            sum.t += w * t_m;
            sum.s += w * member.s_m;
            sum.tt += w * t_m * t_m;
            sum.ts += w * t_m * member.s_m;
            sum.ss += w * residual_m * residual_m;
        }
        double tt = 0.0, ts = 0.0;
        for (const Sums& sum : sums) {
            if (!(sum.w > 0.0)) continue;
            tt += sum.tt - sum.t * sum.t / sum.w;
            ts += sum.ts - sum.t * sum.s / sum.w;
        }
        if (!(tt > 0.0)) return 0.0;
        turn_rad = ts / tt;
        for (std::size_t k = 0; k < steps_.size(); ++k) {
            if (!(sums[k].w > 0.0)) continue;
            steps_[k].at_m = (sums[k].s - turn_rad * sums[k].t) / sums[k].w;
            steps_[k].rms_m = std::sqrt(sums[k].ss / sums[k].w);
        }
    }
    return turn_rad;
}

void StepFitter::measure_extents(const grid::GridGeometry& grid) {
    for (std::size_t k = 0; k < steps_.size(); ++k) {
        along_m_.clear();
        for (const Member& member : members_)
            if (member.step == k) along_m_.push_back(member.t_m);
        if (along_m_.empty()) continue;
        std::sort(along_m_.begin(), along_m_.end());
        double best_m = -1.0;
        for (std::size_t begin = 0; begin < along_m_.size();) {
            std::size_t end = begin + 1;
            while (end < along_m_.size() && along_m_[end] - along_m_[end - 1] <= config_.max_gap_m)
                ++end;
            if (along_m_[end - 1] - along_m_[begin] > best_m) {
                best_m = along_m_[end - 1] - along_m_[begin];
                steps_[k].from_m = along_m_[begin] - 0.5 * grid.resolution_m;
                steps_[k].to_m = along_m_[end - 1] + 0.5 * grid.resolution_m;
            }
            begin = end;
        }
    }
}

void StepFitter::fit(const Terrain& terrain,
                     std::span<const EdgePoint> points,
                     const Edge& seed,
                     std::vector<Edge>& out) {
    out.clear();
    EdgeLine line;
    line.from_m = seed.from_m;
    line.to_m = seed.to_m;
    length_m_ = line.length_m();
    for (int round = 0; round < kRounds; ++round) {
        find_treads(terrain, line);
        join_treads();
        find_steps(seed);
        if (steps_.size() < 2) return;
        take_points(points, line);
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
        const double independent = std::max(1.0, (step->to_m - step->from_m) / kCorrelation_m);
        edge.across_sigma_m =
            std::max(step->rms_m, 0.25 * terrain.geometry.resolution_m) / std::sqrt(independent);
        edge.angle_sigma_rad = edge.across_sigma_m * std::sqrt(12.0) / edge.length_m() /
                               std::sqrt(static_cast<double>(steps_.size()));
        edge.upper_depth_m = step->at_m - upper.begin_m;
        edge.lower_depth_m = lower.end_m - step->at_m;
        out.push_back(edge);
    }
    if (out.size() < 2) out.clear();
}

}  // namespace surefoot::stairs
