// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/calibration/bundle/board_bundle.hpp"

namespace surefoot::calibration {

/// Standard deviation of a coordinate that the views' disagreement about the cameras amounts to
/// [px].
///
/// Corner noise that is independent pulls the lenses and the pose of the right camera a little in
/// every view. A board that is not flat, images that were not taken at quite the same moment and a
/// lens that the model does not follow pull in each view as a whole: far more than the scatter of
/// single corners says, and no number of corners averages it. If every view had its own cameras,
/// the sum of squared residuals would be smaller by what this pulling amounts to; over the number
/// of parameters it is the variance given here. With independent noise alone it equals sigma_px
/// (first order; about 10 % scatter for ten views).
///
/// The bundle must be solved. NaN with fewer than two views.
[[nodiscard]] double between_views_sigma_px(const BoardBundle& bundle);

/// What a covariance is stated for [px]: the noise of single corners, or the disagreement of the
/// views where that is larger.
[[nodiscard]] double stated_sigma_px(const BoardBundle& bundle, double sigma_px);

}  // namespace surefoot::calibration
