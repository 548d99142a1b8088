// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::camera {

/// The rig whose cameras deliver the same picture in width x height px. Exact: both sides must
/// change by the same ratio s, else it is an error in words. Focal lengths become s f; a pixel is
/// an area with its centre at whole coordinates, so principal points become (c + 0.5) s - 0.5. The
/// distortion lives on the plane z = 1 and stays; a rolling shutter takes as long as before.
///
/// The numbers cannot tell a picture that was resized from one that was cropped to the same shape
/// (a ZED's 1080p is cut out of its 2K): the caller answers for that.
[[nodiscard]] Result<StereoRig> scaled_to(const StereoRig& rig, int width, int height);

/// Whether one size is the other times a whole number, the same for both sides: what binning does.
[[nodiscard]] bool is_binning(const Camera& camera, int width, int height) noexcept;

}  // namespace surefoot::camera
