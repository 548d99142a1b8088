// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/frame.hpp"

namespace surefoot::pipeline {

/// Whether the images of a frame show enough to measure by.
enum class ExposureState : std::uint8_t {
    well_exposed,
    dark,         ///< most pixels near black: a covered lens, no light
    overexposed,  ///< too many pixels saturated: the first seconds in the sun
};

/// A pixel from here on may have been anything brighter. 8-bit cameras clip a little below 255 once
/// lens shading is corrected.
inline constexpr int kSaturated_dn = 250;
/// Black level and read noise of 8-bit cameras lie below this.
inline constexpr int kBlack_dn = 10;
/// ASSUMPTION: three quarters of an image are enough. Planes were true from half an image on, the
/// right eye's trim finds its corners from two thirds on (docs/lab/ground.md).
inline constexpr double kMaxSaturatedShare = 0.25;
inline constexpr double kMaxBlackShare = 0.75;

/// Looks at every fourth pixel of every fourth row of both eyes; the worse eye decides. A frame
/// without images (modelled depth) is lit.
[[nodiscard]] ExposureState exposure_state_of(const StereoFrame& frame) noexcept;

}  // namespace surefoot::pipeline
