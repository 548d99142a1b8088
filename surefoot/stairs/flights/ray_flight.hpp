// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "surefoot/stairs/flights/ray_profile.hpp"
#include "surefoot/stairs/stairs_config.hpp"

namespace surefoot::stairs {

/// The visible part of a flight down whose steps are all alike.
struct EvenFlight {
    int steps = 0;
    double riser_m = 0.0;
    double going_m = 0.0;
    double cost = 0.0;  ///< sum over the bins of |residual| in sigma, each at most 3

    /// Number of steps that a ray with `run_per_m` (run / fall) passes before it meets the flight.
    /// Camera: `height_m` above the upper ground, `first_run_m` before the first nosing.
    [[nodiscard]] int steps_to(double run_per_m, double height_m, double first_run_m) const {
        int k = 0;
        while (k < steps && (height_m + k * riser_m) * run_per_m > first_run_m + k * going_m) ++k;
        return k;
    }
};

/// Finds the flight of equal steps that best explains the depths behind an edge. It tries rise,
/// going and number of steps on a grid, then refines them. A matcher may blur a single tread beyond
/// recognition; all treads and the floor below them together stay recognisable.
class RayFlight {
  public:
    explicit RayFlight(const StairsConfig& config) : config_(config) {}
    /// Camera: `height_m` above the upper ground, `first_run_m` before the first nosing. Returns
    /// nothing if a slope or a single fall explains the bins almost as well.
    [[nodiscard]] std::optional<EvenFlight> fit(std::span<const RayBin> bins,
                                                double height_m,
                                                double first_run_m);

    /// The lowest cost of smooth ground: an even slope down to a floor over at least `least_run_m`.
    /// The slope begins near the first nosing.
    [[nodiscard]] double cost_of_slope(std::span<const RayBin> bins,
                                       double height_m,
                                       double first_run_m,
                                       double least_run_m);
    /// Cost of a bin if its ground lies at `depth_m`.
    [[nodiscard]] static double cost_of_bin(const RayBin& bin, double depth_m);

  private:
    /// A bin with data, and the direction of its ray.
    struct Point {
        double run_per_m = 0.0;  ///< horizontal run of the ray per metre that it falls
        double depth_m = 0.0;
        double per_sigma = 0.0;
    };
    [[nodiscard]] double cost(const EvenFlight& flight, double most) const;
    [[nodiscard]] double cost_of_no_flight() const;
    void take(std::span<const RayBin> bins, double height_m, double first_run_m);
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
