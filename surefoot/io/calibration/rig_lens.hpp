// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "surefoot/camera/camera_model.hpp"
#include "surefoot/core/result.hpp"

/// Distortion coefficients of calibration files; private to the rig readers. Every reader makes its
/// lenses here, so that zeros at the end of a list and thin-prism terms are treated alike.
namespace surefoot::io {

/// Takes away the zeros beyond the first `count` coefficients. Programs fill lists up with zeros; a
/// term that is not 0 stays, and the reader's own count refuses it.
void drop_zero_tail(std::vector<double>& coefficients, std::size_t count);

/// Lens from intrinsics (fx fy cx cy) and coefficients in OpenCV's order
///   k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 taux tauy
/// of which the last ones may be missing: rational where k4, k5 or k6 is not 0. An error in words
/// where a thin-prism term (s1 .. s4) or a tilt (taux, tauy) is not 0: no lens model here has them.
[[nodiscard]] Result<camera::CameraModel> pinhole_lens(const std::vector<double>& intrinsics,
                                                       std::vector<double> coefficients);
/// Kannala-Brandt lens of exactly four coefficients (and zeros behind them).
[[nodiscard]] Result<camera::CameraModel> fisheye_lens(const std::vector<double>& intrinsics,
                                                       std::vector<double> coefficients);

}  // namespace surefoot::io
