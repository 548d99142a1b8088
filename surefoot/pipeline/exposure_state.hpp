// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/frame.hpp"

namespace surefoot::pipeline {

/// States whether the exposure of a frame's images allows measurements.
enum class ExposureState : std::uint8_t {
    well_exposed,
    dark,         ///< most pixels are near black: covered lens or no light
    overexposed,  ///< too many pixels are saturated, as in the first seconds in the sun
};

/// From this value on, the true brightness of a pixel is unknown. 8-bit cameras clip a little below
/// 255 after lens shading correction.
inline constexpr int kSaturated_dn = 250;
/// Black level and read noise of 8-bit cameras lie below this value.
inline constexpr int kBlack_dn = 10;
/// ASSUMPTION: a quarter of an image may be saturated. Ground planes were right with half of the
/// image well exposed, the online rig self-calibration with two thirds (docs/lab/ground.md).
inline constexpr double kMaxSaturatedShare = 0.25;
inline constexpr double kMaxBlackShare = 0.75;

/// Samples every fourth pixel of every fourth row. Returns the first bad state, left camera first.
/// A frame without images (modelled depth) is well exposed.
[[nodiscard]] ExposureState exposure_state_of(const StereoFrame& frame) noexcept;

}  // namespace surefoot::pipeline
