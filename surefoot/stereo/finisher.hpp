// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/depth_image.hpp"
#include "surefoot/stereo/confidence.hpp"
#include "surefoot/stereo/consistency.hpp"
#include "surefoot/stereo/refine.hpp"

namespace surefoot::stereo {

/// Largest disparity difference [px] of neighbours on one surface. A larger difference is a jump
/// between two surfaces.
inline constexpr double kJump_px = 1.0;
/// Radius of the window in which unknown pixels are counted (MatchEvidence::unknown_share).
inline constexpr int kNeighbourhoodRadius_px = 4;

/// The last steps after every search: find disparity jumps, refine the disparities to sub-pixel,
/// and give every match its sigma and its outlier probability.
class Finisher {
  public:
    explicit Finisher(const RefineConfig& refinement = {}) : refiner_(refinement) {}

    /// Fills all of `depth` from the disparities `found_px` (NaN = unknown). Without a filter,
    /// `found_px` may be `depth.disparity_px`. Finds jumps and holes before it filters.
    void finish(ImageView<const std::uint8_t> left,
                ImageView<const std::uint8_t> right,
                const Image<float>& found_px,
                Filter filter,
                Executor& executor,
                DepthImage& depth);

  private:
    SubpixelRefiner refiner_;
    // These images stay between frames, so that a frame of the same size allocates no image.
    Image<std::uint8_t> jumps_;
    Image<std::uint8_t> jump_distance_px_;
    Image<float> smallest_px_;
    UnknownCounts unknown_;
    IsolatedMatches isolated_;
};

}  // namespace surefoot::stereo
