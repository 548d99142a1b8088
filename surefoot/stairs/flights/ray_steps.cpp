// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/flights/ray_steps.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/stairs/flights/ray_plane.hpp"

namespace surefoot::stairs {
namespace {

constexpr double kGrid_m = 0.005;  ///< spacing of the tested depths
constexpr double kHighest_m = -0.03;
constexpr double kDeepest_m = 1.2;
// in range: constants
constexpr int kDepths = static_cast<int>((kDeepest_m - kHighest_m) / kGrid_m) + 1;
constexpr int kLeastRise = 10;     ///< smallest riser in units of kGrid_m; less is one tread
constexpr float kStepCost = 8.0F;  ///< a step must reduce the cost by at least this [sigma]
/// Largest cost of a bin [sigma]. A bin between two treads fits neither tread.
constexpr float kMostCost = 3.0F;
constexpr int kLeastSupport = 3;    ///< smallest number of bins of a level: 1.5 pixels
constexpr double kFirst_m = 0.08;   ///< largest distance of the first nosing from the known edge
constexpr double kUneven_m = 0.03;  ///< largest difference of risers and of goings in a flight
constexpr std::size_t kPlain = 3;   ///< this many regular steps need no further search
constexpr double kNose_bins = 1.0;  ///< one sigma of the position of a depth change
/// The depths on both sides of a level blur its depth, most of all if it has few bins. The sigma
/// from this blur is kBlur_m divided by the number of bins that support the level.
constexpr double kBlur_m = 0.1;

}  // namespace

/// Finds the cheapest path of depths that never decrease, from bin to bin.
void RaySteps::find_levels(std::span<const RayBin> bins) {
    levels_.clear();
    const std::size_t count = bins.size();
    cost_.assign(kDepths, 0.0F);
    cheapest_.resize(kDepths);
    cheapest_level_.resize(kDepths);
    from_.resize(count * kDepths);
    for (std::size_t k = 0; k < count; ++k) {
        std::int16_t* const from = from_.data() + k * kDepths;
        for (int d = 0; d < kDepths; ++d) {
            const auto i = static_cast<std::size_t>(d);
            const bool better = d == 0 || cost_[i] < cheapest_[i - 1];
            cheapest_[i] = better ? cost_[i] : cheapest_[i - 1];
            cheapest_level_[i] = better ? static_cast<std::int16_t>(d) : cheapest_level_[i - 1];
        }
        for (int d = 0; d < kDepths; ++d) from[d] = static_cast<std::int16_t>(d);
        float* const cost = cost_.data();
        const float* const cheapest = cheapest_.data();
        const std::int16_t* const level = cheapest_level_.data();
        for (int d = kLeastRise; d < kDepths && k > 0; ++d) {
            const float stepped = cheapest[d - kLeastRise] + kStepCost;
            const bool better = stepped < cost[d];
            cost[d] = better ? stepped : cost[d];
            from[d] = better ? level[d - kLeastRise] : from[d];
        }
        if (!(bins[k].depth_m == bins[k].depth_m)) continue;
        const auto per_sigma = static_cast<float>(kGrid_m / bins[k].sigma_m);
        const auto at = static_cast<float>((bins[k].depth_m - kHighest_m) / kGrid_m);
        for (int d = 0; d < kDepths; ++d)
            cost[d] += std::min(std::abs(at - static_cast<float>(d)) * per_sigma, kMostCost);
    }
    auto depth = static_cast<int>(std::min_element(cost_.begin(), cost_.end()) - cost_.begin());
    int end = static_cast<int>(count);
    for (int k = end - 1; k >= 0; --k) {
        const int before =
            from_[static_cast<std::size_t>(k) * kDepths + static_cast<std::size_t>(depth)];
        if (before == depth && k > 0) continue;
        levels_.push_back({.begin = k, .end = end, .depth_m = kHighest_m + depth * kGrid_m});
        end = k;
        depth = before;
    }
    std::reverse(levels_.begin(), levels_.end());
}

void RaySteps::measure(std::span<const RayBin> bins, Level& level) const {
    constexpr double kNear_m = 0.01;
    double w = 0.0, wd = 0.0;
    for (int k = level.begin; k < level.end; ++k) {
        const RayBin& bin = bins[static_cast<std::size_t>(k)];
        if (!(std::abs(bin.depth_m - level.depth_m) <= kNear_m + 2.0 * bin.sigma_m)) continue;
        ++level.support;
        const double weight = 1.0 / (bin.sigma_m * bin.sigma_m);
        w += weight;
        wd += weight * bin.depth_m;
    }
    if (level.support == 0) return;
    level.depth_m = wd / w;
    level.sigma_m = std::hypot(std::sqrt(kRayRows_px / kRayBin_px / w), kBlur_m / level.support);
}

/// Returns the bin at which the depth passes the middle between two levels.
double RaySteps::nose_bin(std::span<const RayBin> bins, const Level& upper, const Level& lower) {
    constexpr int kAround = 3;
    const double middle_m = 0.5 * (upper.depth_m + lower.depth_m);
    const int last = std::min(lower.begin + kAround, static_cast<int>(bins.size()) - 1);
    for (int k = std::max(upper.begin, lower.begin - kAround); k < last; ++k) {
        const double here_m = bins[static_cast<std::size_t>(k)].depth_m;
        const double next_m = bins[static_cast<std::size_t>(k) + 1].depth_m;
        if (here_m < middle_m && next_m >= middle_m)
            return k + (middle_m - here_m) / (next_m - here_m);
    }
    return lower.begin - 0.5;
}

/// An angular error [rad] times range^2 / height is the error of the nosing's position.
double RaySteps::nose_sigma_m(double run_m, double below_m) const {
    return kNose_bins * (run_m * run_m + below_m * below_m) / below_m * bin_rad_;
}

/// Finds the nosings. `height_m` is the height of the camera above the upper ground.
void RaySteps::find_noses(std::span<const RayBin> bins, double height_m) {
    const auto steepness_at = [&](double bin) {
        const auto k = std::min(saturated_integer<std::size_t>(std::floor(bin)), bins.size() - 2);
        const double share = bin - static_cast<double>(k);
        return bins[k].steepness + share * (bins[k + 1].steepness - bins[k].steepness);
    };
    noses_.clear();
    for (std::size_t k = 0; k + 1 < levels_.size(); ++k) {
        const double below_m = height_m + levels_[k].depth_m;
        const double steepness = steepness_at(nose_bin(bins, levels_[k], levels_[k + 1]));
        const double run_m = below_m / steepness;
        noses_.push_back(
            {run_m, std::hypot(nose_sigma_m(run_m, below_m), levels_[k].sigma_m / steepness)});
    }
}

/// Returns the number of steps, from the first on, that form one regular flight.
std::size_t RaySteps::regular_steps() const {
    std::size_t steps = 1;
    double riser_m = levels_[1].depth_m - levels_[0].depth_m;
    double going_m = 0.0;
    for (; steps < noses_.size(); ++steps) {
        const Level& tread = levels_[steps + 1];
        const double rise_m = tread.depth_m - levels_[steps].depth_m;
        const double run_m = noses_[steps].run_m - noses_[steps - 1].run_m;
        const bool is_step = rise_m >= config_.min_riser_m &&
                             rise_m <= config_.max_riser_m + kUneven_m &&
                             run_m >= config_.min_going_m && run_m <= config_.max_going_m;
        const bool like_others =
            std::abs(rise_m - riser_m) <= kUneven_m + 3.0 * tread.sigma_m &&
            (steps == 1 || std::abs(run_m - going_m) <= kUneven_m + 3.0 * noses_[steps].sigma_m);
        if (!is_step || !like_others) break;
        const auto n = static_cast<double>(steps);
        riser_m = (tread.depth_m - levels_[0].depth_m) / (n + 1.0);
        going_m = (noses_[steps].run_m - noses_[0].run_m) / n;
    }
    return steps;
}

std::size_t RaySteps::as_even_flight(std::span<const RayBin> bins,
                                     double height_m,
                                     std::size_t steps) {
    const Nose first = noses_.front();
    const auto flight = even_.fit(bins, height_m, first.run_m);
    if (!flight || static_cast<std::size_t>(flight->steps) <= steps) return steps;
    levels_.resize(1);
    levels_[0] = {.begin = 0, .end = 0, .depth_m = levels_[0].depth_m};
    for (std::size_t bin = 0; bin < bins.size(); ++bin) {
        const int behind = flight->steps_to(1.0 / bins[bin].steepness, height_m, first.run_m);
        const auto tread = static_cast<std::size_t>(behind);
        while (levels_.size() <= tread) {
            levels_.push_back({.begin = static_cast<int>(bin),
                               .end = static_cast<int>(bin),
                               .depth_m = static_cast<double>(levels_.size()) * flight->riser_m});
        }
        levels_.back().end = static_cast<int>(bin) + 1;
    }
    std::size_t seen = 0;
    for (; seen < levels_.size(); ++seen) {
        measure(bins, levels_[seen]);
        if (levels_[seen].support < kLeastSupport) break;
    }
    levels_.resize(seen);
    if (seen < 2) return 0;
    noses_.clear();
    for (std::size_t i = 0; i + 1 < seen; ++i) {
        const double run_m = first.run_m + static_cast<double>(i) * flight->going_m;
        noses_.push_back(
            {run_m, std::hypot(nose_sigma_m(run_m, height_m + levels_[i].depth_m), first.sigma_m)});
    }
    return seen - 1;
}

double RaySteps::log_ratio(std::span<const RayBin> bins, double height_m, std::size_t steps) {
    const auto begin = static_cast<std::size_t>(levels_.front().begin);
    const auto end = static_cast<std::size_t>(levels_[steps].end);
    double cost = 0.0;
    for (std::size_t level = 0; level <= steps; ++level)
        for (int k = levels_[level].begin; k < levels_[level].end; ++k)
            cost +=
                RayFlight::cost_of_bin(bins[static_cast<std::size_t>(k)], levels_[level].depth_m);
    const double slope = even_.cost_of_slope(
        bins.subspan(begin, end - begin), height_m, noses_.front().run_m, 2.0 * config_.smear_m);
    // Bins within kRayRows_px share one error. The BIC counts two parameters per step (position,
    // depth) and three parameters for a slope.
    const double independent = static_cast<double>(end - begin) * kRayBin_px / kRayRows_px;
    const double parameters = 2.0 * static_cast<double>(steps) - 3.0;
    return (slope - cost) * kRayBin_px / kRayRows_px -
           0.5 * parameters * std::log(std::max(2.0, independent));
}

/// Adds the visible lower ground. The map keeps the highest point of a cell and smears low steps.
Edge RaySteps::with_lower(Edge edge, std::size_t step) const {
    const Level& upper = levels_[step];
    const Level& lower = levels_[step + 1];
    edge.lower_m = edge.upper_m - (lower.depth_m - upper.depth_m);
    edge.lower_seen = true;
    edge.height_sigma_m = std::hypot(upper.sigma_m, lower.sigma_m);
    if (step + 1 < noses_.size()) edge.lower_depth_m = noses_[step + 1].run_m - noses_[step].run_m;
    return edge;
}

void RaySteps::find(const Terrain& terrain, std::span<const Edge> known, std::vector<Edge>& out) {
    out.clear();
    const Edge& first = known.front();
    const std::span<const RayBin> bins = profile_.observation(terrain, first);
    if (bins.empty()) return;
    bin_rad_ = profile_.bin_rad();
    find_levels(bins);
    for (Level& level : levels_) measure(bins, level);
    std::erase_if(levels_, [](const Level& level) { return level.support < kLeastSupport; });
    if (levels_.size() < 2 || std::abs(levels_.front().depth_m) > -kHighest_m) return;

    const Eigen::Vector3d& camera_m = terrain.view->T_map_camera.translation_m;
    const double height_m = camera_m.z() - first.upper_m;
    const double distance_m = -first.below_m(camera_m.head<2>());
    find_noses(bins, height_m);
    if (std::abs(noses_.front().run_m - distance_m) > kFirst_m) return;
    std::size_t steps = regular_steps();
    // More levels than steps mean that the matcher blurred a step.
    if (steps < kPlain && levels_.size() > steps + 1) steps = as_even_flight(bins, height_m, steps);
    if (steps < known.size()) return;
    const double log_step_ratio = log_ratio(bins, height_m, steps);

    out.assign(known.begin(), known.end());
    const std::size_t last = known.size() - 1;
    const Edge seen = with_lower(known.back(), last);
    // A single step may be a wrong measurement, so deeper ground in the map has priority.
    const bool is_deeper = seen.height_m() >= known.back().height_m() - 2.0 * seen.height_sigma_m;
    if (steps > 1 || is_deeper) out.back() = seen;
    if (!(first.height_m() > 0.0)) {  // the map does not show where the edge lies
        const Eigen::Vector2d shift_m = (noses_.front().run_m - distance_m) * first.down();
        out.front().from_m += shift_m;
        out.front().to_m += shift_m;
        out.front().across_sigma_m = noses_.front().sigma_m;
    }
    const double last_m = first.below_m(out.back().middle_m());
    const double upper_m = first.upper_m;
    for (std::size_t k = known.size(); k < steps; ++k) {
        Edge edge = first;
        const Eigen::Vector2d shift_m =
            (last_m + noses_[k].run_m - noses_[last].run_m) * first.down();
        edge.from_m += shift_m;
        edge.to_m += shift_m;
        edge.upper_m = upper_m - (levels_[k].depth_m - levels_[0].depth_m);
        edge.lower_m = upper_m - (levels_[k + 1].depth_m - levels_[0].depth_m);
        edge.lower_seen = true;
        edge.height_sigma_m = std::hypot(levels_[k].sigma_m, levels_[k + 1].sigma_m);
        edge.across_sigma_m = noses_[k].sigma_m;
        edge.upper_depth_m = noses_[k].run_m - noses_[k - 1].run_m;
        edge.lower_depth_m =
            k + 1 < noses_.size() && k + 1 < steps ? noses_[k + 1].run_m - noses_[k].run_m : 0.0;
        out.push_back(edge);
    }
    for (Edge& edge : out) edge.log_step_ratio = log_step_ratio;
}

}  // namespace surefoot::stairs
