// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::camera {

/// Returns the rig of the same cameras with images of width x height px. Returns an error unless
/// both sides change by exactly the same ratio s. Focal lengths become s f. A pixel has its centre
/// at whole coordinates, so principal points become (c + 0.5) s - 0.5. The distortion on the plane
/// z = 1 and the rolling-shutter read-out time do not change.
///
/// Sizes alone cannot distinguish a resized image from a crop of the same shape (a ZED's 1080p is a
/// crop of its 2K). The caller must make sure that the image is resized.
[[nodiscard]] Result<StereoRig> scaled_to(const StereoRig& rig, int width, int height);

/// Returns the rig of images that `shrink` made smaller by `factor` >= 1. Columns and rows beyond
/// the last whole square of factor x factor pixels are cut off. `rig` must have no problem().
[[nodiscard]] StereoRig shrunk(const StereoRig& rig, int factor);

/// Means of factor x factor pixels, rounded. `factor` must be at least 1 and at most both sides.
void shrink(ImageView<const std::uint8_t> in, int factor, GreyImage& out);

/// True if one size is the same integer multiple of the other on both sides, as with binning.
[[nodiscard]] bool is_binning(const Camera& camera, int width, int height) noexcept;

}  // namespace surefoot::camera
