// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/flights/sight_flight.hpp"
#include "surefoot/stairs/flights/sight_profile.hpp"
#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Steps down behind an edge, read from one look (SightProfile): the most likely staircase through
/// the depths (dynamic programming, Viterbi 1967), of which so many steps are kept as are regular.
class SightSteps {
  public:
    explicit SightSteps(const StairsConfig& config) : config_(config), even_(config) {}
    /// Edges of the flight whose upper ones are `known` (at least one), from the top down: those,
    /// with what is seen of the ground below the last of them, and the further ones. Empty if
    /// fewer are seen than are known.
    void find(const Terrain& terrain, std::span<const Edge> known, std::vector<Edge>& out);

  private:
    struct Level {
        int begin = 0;  ///< bins
        int end = 0;
        double depth_m = 0.0;
        double sigma_m = 0.0;
        int support = 0;  ///< bins that agree
    };
    struct Nose {
        double run_m = 0.0;  ///< from the camera
        double sigma_m = 0.0;
    };
    void find_levels(std::span<const SightBin> bins);
    void measure(std::span<const SightBin> bins, Level& level) const;
    [[nodiscard]] static double nose_bin(std::span<const SightBin> bins,
                                         const Level& upper,
                                         const Level& lower);
    /// Of a nose so far from the camera and so far below it, by the pixels alone.
    [[nodiscard]] double nose_sigma_m(double run_m, double below_m) const;
    void find_noses(std::span<const SightBin> bins, double height_m);
    [[nodiscard]] std::size_t regular_steps() const;
    /// Levels and noses of the even flight that explains the bins; how many steps of it are seen.
    /// Nothing changes where there is none of more than `steps`.
    [[nodiscard]] std::size_t as_even_flight(std::span<const SightBin> bins,
                                             double height_m,
                                             std::size_t steps);
    /// ln of the likelihood ratio: the first so many steps over ground that slopes.
    [[nodiscard]] double log_ratio(std::span<const SightBin> bins,
                                   double height_m,
                                   std::size_t steps);
    [[nodiscard]] Edge with_lower(Edge edge, std::size_t step) const;

    StairsConfig config_;
    SightProfile profile_;
    SightFlight even_;
    double bin_rad_ = 0.0;
    std::vector<float> cost_;
    std::vector<float> cheapest_;  ///< of a level at or above this one
    std::vector<std::int16_t> from_;
    std::vector<std::int16_t> cheapest_level_;
    std::vector<Level> levels_;
    std::vector<Nose> noses_;
};

}  // namespace surefoot::stairs
