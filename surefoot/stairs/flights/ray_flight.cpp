// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/flights/ray_flight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::stairs {
namespace {

constexpr double kRiserStep_m = 0.008;
constexpr double kGoingStep_m = 0.02;
constexpr double kShortestGoing_m = 0.2;  ///< limit of real stairs; spirals have unequal steps
constexpr double kLongestGoing_m = 0.4;
constexpr int kMostSteps = 8;  ///< more steps are never visible
constexpr double kDeepest_m =
    1.3;  ///< lowest tested floor below the first edge, if the ground has no steps
constexpr double kFloorStep_m = 0.025;
constexpr double kSteepest = 0.9;  ///< steepest slope; a steeper slope counts as an immediate fall
constexpr double kSlopeStep = 0.03;
/// Largest cost of a bin [sigma]. A bin between two treads fits neither tread.
constexpr double kMostCost = 3.0;
constexpr double kLeastSigma_m = 0.01;  ///< one sigma of the error that the bins of a tread share
constexpr double kLeastGain = 16.0;     ///< smallest cost gain of a flight over all alternatives
constexpr int kRefinements = 4;         ///< each refinement halves the search steps

}  // namespace

double RayFlight::cost(const EvenFlight& flight, double most) const {
    double sum = 0.0;
    for (const Point& point : points_) {
        const double depth_m =
            flight.steps_to(point.run_per_m, height_m_, first_run_m_) * flight.riser_m;
        sum += std::min(std::abs(point.depth_m - depth_m) * point.per_sigma, kMostCost);
        if (sum >= most) return most;
    }
    return sum;
}

/// Returns the cost of ground that falls from `first_run_m` on and then is level. A slope above
/// kSteepest is a vertical fall.
double RayFlight::cost_of_slope_to(double floor_m,
                                   double slope,
                                   double first_run_m,
                                   double most) const {
    double sum = 0.0;
    for (const Point& point : points_) {
        // The ray meets the slope where depth = slope (run - first run).
        const double beyond_m = height_m_ * point.run_per_m - first_run_m;
        const double left = 1.0 - slope * point.run_per_m;
        double depth_m = floor_m;
        if (beyond_m <= 0.0)
            depth_m = 0.0;
        else if (left > 0.0 && slope <= kSteepest)
            depth_m = std::min(floor_m, slope * beyond_m / left);
        sum += std::min(std::abs(point.depth_m - depth_m) * point.per_sigma, kMostCost);
        if (sum >= most) break;
    }
    return sum;
}

/// Returns the lowest cost of ground that falls evenly or at once, and then is level.
double RayFlight::cost_of_no_flight() const {
    double least = std::numeric_limits<double>::infinity();
    for (double floor_m = kFloorStep_m; floor_m <= kDeepest_m; floor_m += kFloorStep_m)
        for (double slope = kSlopeStep; slope <= kSteepest + kSlopeStep; slope += kSlopeStep)
            least = std::min(least, cost_of_slope_to(floor_m, slope, first_run_m_, least));
    return least;
}

double RayFlight::cost_of_slope(std::span<const RayBin> bins,
                                double height_m,
                                double first_run_m,
                                double least_run_m) {
    constexpr int kPlaces = 3;  // from half a tread before the nosing to half a tread behind
    constexpr double kPlace_m = 0.05;
    take(bins, height_m, first_run_m);
    double least = std::numeric_limits<double>::infinity();
    for (int place = -kPlaces; place <= kPlaces; ++place) {
        const double begin_m = first_run_m + place * kPlace_m;
        for (double slope = kSlopeStep; slope <= kSteepest; slope += 2.0 * kSlopeStep)
            for (double floor_m = slope * least_run_m; floor_m <= kDeepest_m;
                 floor_m += 2.0 * kFloorStep_m)
                least = std::min(least, cost_of_slope_to(floor_m, slope, begin_m, least));
    }
    return least;
}

double RayFlight::cost_of_bin(const RayBin& bin, double depth_m) {
    if (!(bin.depth_m == bin.depth_m) || !(bin.steepness > 0.0)) return 0.0;
    return std::min(std::abs(bin.depth_m - depth_m) / std::hypot(bin.sigma_m, kLeastSigma_m),
                    kMostCost);
}

void RayFlight::refine(EvenFlight& best) const {
    double riser_step_m = 0.5 * kRiserStep_m;
    double going_step_m = 0.5 * kGoingStep_m;
    for (int round = 0; round < kRefinements; ++round) {
        const EvenFlight from = best;
        for (int i = -2; i <= 2; ++i) {
            for (int k = -2; k <= 2; ++k) {
                EvenFlight tried = from;
                tried.riser_m += i * riser_step_m;
                tried.going_m += k * going_step_m;
                tried.cost = cost(tried, best.cost);
                if (tried.cost < best.cost) best = tried;
            }
        }
        riser_step_m *= 0.5;
        going_step_m *= 0.5;
    }
}

void RayFlight::take(std::span<const RayBin> bins, double height_m, double first_run_m) {
    height_m_ = height_m;
    first_run_m_ = first_run_m;
    points_.clear();
    for (const RayBin& bin : bins) {
        if (!(bin.depth_m == bin.depth_m) || !(bin.steepness > 0.0)) continue;
        points_.push_back(
            {1.0 / bin.steepness, bin.depth_m, 1.0 / std::hypot(bin.sigma_m, kLeastSigma_m)});
    }
}

std::optional<EvenFlight> RayFlight::fit(std::span<const RayBin> bins,
                                         double height_m,
                                         double first_run_m) {
    take(bins, height_m, first_run_m);
    EvenFlight best;
    best.cost = std::numeric_limits<double>::infinity();
    for (int steps = 2; steps <= kMostSteps; ++steps) {
        for (double riser_m = config_.min_riser_m; riser_m <= config_.max_riser_m;
             riser_m += kRiserStep_m) {
            for (double going_m = kShortestGoing_m; going_m <= kLongestGoing_m;
                 going_m += kGoingStep_m) {
                EvenFlight tried{steps, riser_m, going_m, 0.0};
                tried.cost = cost(tried, best.cost);
                if (tried.cost < best.cost) best = tried;
            }
        }
    }
    if (best.steps < 2) return std::nullopt;
    refine(best);
    if (!(best.cost + kLeastGain < cost_of_no_flight())) return std::nullopt;
    return best;
}

}  // namespace surefoot::stairs
