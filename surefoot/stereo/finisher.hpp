// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/depth_image.hpp"
#include "surefoot/stereo/consistency.hpp"
#include "surefoot/stereo/refine.hpp"

namespace surefoot::stereo {

/// What every search is followed by: jumps are found, disparities are refined, and every match gets
/// its sigma and its outlier probability.
class Finisher {
  public:
    explicit Finisher(const RefineConfig& refinement = {}) : refiner_(refinement) {}

    /// Fills all of `depth` from what was found (NaN = nothing), which may lie in
    /// `depth.disparity_px` if there is no filter. Jumps and holes are those before the filter.
    void finish(ImageView<const std::uint8_t> left,
                ImageView<const std::uint8_t> right,
                const Image<float>& found_px,
                Filter filter,
                Executor& executor,
                DepthImage& depth);

  private:
    SubpixelRefiner refiner_;
    // Kept between frames, so that nothing is allocated anew.
    Image<std::uint8_t> jumps_;
    Image<std::uint8_t> jump_distance_px_;
    UnknownCounts unknown_;
};

}  // namespace surefoot::stereo
