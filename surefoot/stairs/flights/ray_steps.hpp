// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/flights/ray_flight.hpp"
#include "surefoot/stairs/flights/ray_profile.hpp"
#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Finds steps down behind an edge in the current frame (RayProfile): the most likely staircase
/// through the depths (dynamic programming, Viterbi 1967). Only its regular steps are kept.
class RaySteps {
  public:
    explicit RaySteps(const StairsConfig& config) : config_(config), even_(config) {}
    /// Writes the edges of a flight down, from the top: the `known` edges (at least one), then
    /// further edges. The last known edge gets the visible ground below it. Writes nothing if fewer
    /// steps are visible than known.
    void find(const Terrain& terrain, std::span<const Edge> known, std::vector<Edge>& out);

  private:
    struct Level {
        int begin = 0;  ///< index of the first bin
        int end = 0;
        double depth_m = 0.0;
        double sigma_m = 0.0;
        int support = 0;  ///< number of bins that agree with the level
    };
    struct Nose {
        double run_m = 0.0;  ///< horizontal distance from the camera
        double sigma_m = 0.0;
    };
    void find_levels(std::span<const RayBin> bins);
    void measure(std::span<const RayBin> bins, Level& level) const;
    [[nodiscard]] static double nose_bin(std::span<const RayBin> bins,
                                         const Level& upper,
                                         const Level& lower);
    /// Position sigma of a nosing at this distance from the camera, from pixel errors alone.
    [[nodiscard]] double nose_sigma_m(double run_m, double below_m) const;
    void find_noses(std::span<const RayBin> bins, double height_m);
    [[nodiscard]] std::size_t regular_steps() const;
    /// Replaces levels and nosings by a flight of more than `steps` equal steps that explains the
    /// bins. Returns the number of its visible steps, or `steps` without such a flight.
    [[nodiscard]] std::size_t as_even_flight(std::span<const RayBin> bins,
                                             double height_m,
                                             std::size_t steps);
    /// Log likelihood ratio of the first `steps` steps to ground that slopes.
    [[nodiscard]] double log_ratio(std::span<const RayBin> bins,
                                   double height_m,
                                   std::size_t steps);
    [[nodiscard]] Edge with_lower(Edge edge, std::size_t step) const;

    StairsConfig config_;
    RayProfile profile_;
    RayFlight even_;
    double bin_rad_ = 0.0;
    std::vector<float> cost_;
    std::vector<float> cheapest_;  ///< lowest cost over this level and all higher levels
    std::vector<std::int16_t> from_;
    std::vector<std::int16_t> cheapest_level_;
    std::vector<Level> levels_;
    std::vector<Nose> noses_;
};

}  // namespace surefoot::stairs
