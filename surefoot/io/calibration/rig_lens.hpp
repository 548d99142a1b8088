// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "surefoot/camera/camera_model.hpp"
#include "surefoot/core/result.hpp"

/// Reads distortion coefficients of calibration files; private to the rig readers. All readers
/// build lenses here, so that they treat trailing zeros and thin-prism terms in the same way.
namespace surefoot::io {

/// Removes zeros at the end of a list that is longer than `count`. Many programs fill lists up with
/// zeros. A term that is not 0 stays, and the length check of the reader refuses it.
void drop_zero_tail(std::vector<double>& coefficients, std::size_t count);

/// Builds a lens from intrinsics (fx fy cx cy) and coefficients in OpenCV's order k1 k2 p1 p2 k3 k4
/// k5 k6 s1 s2 s3 s4 taux tauy. The last ones may be missing; the lens is rational if k4, k5 or k6
/// is not 0. Fails if a thin-prism term (s1 .. s4) or a tilt (taux, tauy) is not 0: no lens model
/// here has such terms.
[[nodiscard]] Result<camera::CameraModel> pinhole_lens(const std::vector<double>& intrinsics,
                                                       std::vector<double> coefficients);
/// Builds a Kannala-Brandt lens from exactly four coefficients; ignores zeros after the fourth.
[[nodiscard]] Result<camera::CameraModel> fisheye_lens(const std::vector<double>& intrinsics,
                                                       std::vector<double> coefficients);

}  // namespace surefoot::io
