// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "surefoot/calibration/lenses/lens.hpp"

namespace surefoot::calibration {

/// What the covariance of a lens means in the image: how the picture of a fixed direction, that of
/// `pixel`, moves when the parameters are off [px^2]. The coefficients of a rational lens are
/// almost exchangeable, so that their own deviations say nothing, but what they do together is
/// known as well as for any lens. First order; nothing where no direction belongs to the pixel.
[[nodiscard]] std::optional<Eigen::Matrix2d> mapping_covariance_px2(
    LensKind kind,
    const Eigen::VectorXd& parameters,
    const Eigen::MatrixXd& covariance,
    const Eigen::Vector2d& pixel);

/// Standard deviation along the worst direction, on a grid of pixels that reaches the corners of
/// the image [px]. A corner that no view showed is extrapolated, and may be known very badly.
struct MappingSigmas {
    double median_px = 0.0;  ///< NaN where no pixel has one
    double largest_px = 0.0;
};
[[nodiscard]] MappingSigmas mapping_sigmas_px(LensKind kind,
                                              const Eigen::VectorXd& parameters,
                                              const Eigen::MatrixXd& covariance,
                                              ImageSize size);

}  // namespace surefoot::calibration
