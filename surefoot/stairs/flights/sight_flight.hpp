// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "surefoot/stairs/flights/sight_profile.hpp"
#include "surefoot/stairs/stairs_config.hpp"

namespace surefoot::stairs {

/// A flight down with steps that are all alike, as far as it is in sight.
struct EvenFlight {
    int steps = 0;
    double riser_m = 0.0;
    double going_m = 0.0;
    double cost = 0.0;  ///< sum over the bins of what they leave it by, in sigma, each at most 3

    /// After how many steps a line of sight meets it, `run_per_m` of run over fall: from a camera
    /// `height_m` above the ground above the first nose, which is `first_run_m` away.
    [[nodiscard]] int steps_to(double run_per_m, double height_m, double first_run_m) const {
        int k = 0;
        while (k < steps && (height_m + k * riser_m) * run_per_m > first_run_m + k * going_m) ++k;
        return k;
    }
};

/// The even flight that explains best what is seen behind an edge: rise, going and number of steps
/// that are tried one by one, then finer. One tread alone may be blurred by a matcher until it is
/// none; what all treads and the floor below them say together is not.
class SightFlight {
  public:
    explicit SightFlight(const StairsConfig& config) : config_(config) {}
    /// `height_m`: of the camera above the ground above the first nose, which is `first_run_m` from
    /// it. Nothing where steps explain it no better than a slope or one fall does.
    [[nodiscard]] std::optional<EvenFlight> fit(std::span<const SightBin> bins,
                                                double height_m,
                                                double first_run_m);

    /// The least cost of ground that slopes evenly down to a floor, over at least `least_run_m`,
    /// as smooth ground does. It begins near the first nose.
    [[nodiscard]] double cost_of_slope(std::span<const SightBin> bins,
                                       double height_m,
                                       double first_run_m,
                                       double least_run_m);
    /// What a bin costs whose ground should lie at `depth_m`.
    [[nodiscard]] static double cost_of_bin(const SightBin& bin, double depth_m);

  private:
    /// A bin that tells, by the run at which its line of sight meets the ground above.
    struct Point {
        double run_per_m = 0.0;  ///< run over fall
        double depth_m = 0.0;
        double per_sigma = 0.0;
    };
    [[nodiscard]] double cost(const EvenFlight& flight, double most) const;
    [[nodiscard]] double cost_of_no_flight() const;
    void take(std::span<const SightBin> bins, double height_m, double first_run_m);
    [[nodiscard]] double cost_of_slope_to(double floor_m,
                                          double slope,
                                          double first_run_m,
                                          double most) const;
    void refine(EvenFlight& best) const;

    StairsConfig config_;
    double height_m_ = 0.0;
    double first_run_m_ = 0.0;
    std::vector<Point> points_;
};

}  // namespace surefoot::stairs
