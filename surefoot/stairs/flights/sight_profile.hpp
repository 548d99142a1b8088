// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

inline constexpr double kSightBin_px = 0.5;

/// Ground that lines of sight of about one steepness meet, along a whole edge.
struct SightBin {
    double steepness = 0.0;  ///< of the lines of sight: fall over run across the edge
    double depth_m = 0.0;    ///< median, below the ground above the edge; NaN = nothing is seen
    double sigma_m = 0.0;
};

/// What the camera sees behind an edge down, from steep lines of sight to flat ones: in the plane
/// across the edge, in which all of a flight's noses are points. Treads are depths that stay, noses
/// are where the depth changes, whatever the camera's roll and the edge's direction: the
/// v-disparity image (Labayrade et al. 2002) turned to the edge. Strips of five pixels stay visible
/// in it, which a map that leaves out pixels beside each jump does not hold.
class SightProfile {
  public:
    /// Half a pixel a bin. Nothing without `Terrain::view` and `Terrain::disparity_px`, for an edge
    /// that the camera is not above and before, or where little of it is in sight. Valid until the
    /// next call.
    [[nodiscard]] std::span<const SightBin> observation(const Terrain& terrain, const Edge& edge);
    /// Angle between the lines of sight of neighbouring bins, at the edge.
    [[nodiscard]] double bin_rad() const noexcept { return bin_rad_; }

  private:
    struct Sample {
        std::int32_t bin = 0;
        float depth_m = 0.0F;
    };
    void gather(const Terrain& terrain, const Edge& edge, double height_m, double distance_m);
    void measure_bins();

    double bin_rad_ = 0.0;
    std::vector<SightBin> bins_;
    std::vector<Sample> samples_;
    std::vector<std::size_t> first_;  ///< of each bin in `depths_m_`
    std::vector<std::size_t> next_;
    std::vector<float> depths_m_;
    std::vector<float> values_m_;
};

}  // namespace surefoot::stairs
