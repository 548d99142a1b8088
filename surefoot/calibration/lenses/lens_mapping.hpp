// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "surefoot/calibration/lenses/lens.hpp"

namespace surefoot::calibration {

/// Returns the covariance [px^2] of the image position of a fixed direction (that of `pixel`),
/// caused by the covariance of the lens. Reason: the coefficients of a rational lens can almost
/// replace each other. Their single deviations say little, but their common effect is well known.
/// Valid to first order. Returns nullopt if the pixel has no direction.
[[nodiscard]] std::optional<Eigen::Matrix2d> mapping_covariance_px2(
    LensKind kind,
    const Eigen::VectorXd& parameters,
    const Eigen::MatrixXd& covariance,
    const Eigen::Vector2d& pixel);

/// Standard deviations in the worst direction, on a grid of pixels up to the image corners [px]. A
/// corner that no view showed is extrapolated and may have a very large value.
struct MappingSigmas {
    double median_px = 0.0;  ///< NaN if no pixel has a value
    double largest_px = 0.0;
};
[[nodiscard]] MappingSigmas mapping_sigmas_px(LensKind kind,
                                              const Eigen::VectorXd& parameters,
                                              const Eigen::MatrixXd& covariance,
                                              ImageSize size);

}  // namespace surefoot::calibration
