// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

inline constexpr double kRayBin_px = 0.5;

/// The ground that rays of similar steepness meet, along a whole edge.
struct RayBin {
    double steepness = 0.0;  ///< steepness of the rays: fall over run, across the edge
    double depth_m = 0.0;    ///< median depth below the upper ground; NaN = no data
    double sigma_m = 0.0;
};

/// The depths that the camera sees behind an edge down, from steep to flat rays, in the plane
/// across the edge. In this plane each nosing is a point. A tread is a run of constant depth and a
/// nosing is a change of depth, for any camera roll and edge direction. This is the v-disparity
/// image (Labayrade et al. 2002), turned to the edge. It shows strips of five pixels, which the map
/// omits because it drops pixels beside depth jumps.
class RayProfile {
  public:
    /// Computes the bins, half a pixel each; bins with too few pixels have no data. Empty without
    /// `Terrain::view` or `Terrain::disparity_px`, or if the camera is not above the upper ground
    /// and before the edge. Valid until the next call.
    [[nodiscard]] std::span<const RayBin> observation(const Terrain& terrain, const Edge& edge);
    /// Angle between the rays of neighbouring bins, at the edge.
    [[nodiscard]] double bin_rad() const noexcept { return bin_rad_; }

  private:
    struct Sample {
        std::int32_t bin = 0;
        float depth_m = 0.0F;
    };
    void gather(const Terrain& terrain, const Edge& edge, double height_m, double distance_m);
    void measure_bins();

    double bin_rad_ = 0.0;
    std::vector<RayBin> bins_;
    std::vector<Sample> samples_;
    std::vector<std::size_t> first_;  ///< index of each bin's first depth in `depths_m_`
    std::vector<std::size_t> next_;
    std::vector<float> depths_m_;
    std::vector<float> values_m_;
};

}  // namespace surefoot::stairs
