// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/calibration/bundle/board_bundle.hpp"

namespace surefoot::calibration {

/// Returns the standard deviation of the coordinate noise that explains the scatter of the cameras
/// between the views [px].
///
/// Independent corner noise shifts the lenses and the right camera's pose a little in every view.
/// A bent board, images at different moments and lens errors beyond the model shift each view as a
/// whole. These shifts exceed the noise of single corners by far, and more corners do not average
/// them out. Method: with separate cameras per view, the sum of squared residuals would fall by
/// the effect of these shifts. The result is the root of this decrease per parameter. With
/// independent noise alone the result equals sigma_px (first order; about 10 % scatter for ten
/// views).
///
/// The bundle must be solved. Returns NaN for fewer than two views.
[[nodiscard]] double between_views_sigma_px(const BoardBundle& bundle);

/// Returns the coordinate noise for a covariance [px]: `sigma_px` (the noise of single corners), or
/// the scatter between views if the scatter is larger.
[[nodiscard]] double stated_sigma_px(const BoardBundle& bundle, double sigma_px);

}  // namespace surefoot::calibration
