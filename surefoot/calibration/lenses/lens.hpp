// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "surefoot/camera/camera_model.hpp"

namespace surefoot::calibration {

/// Lens model of a calibration, with its estimated parameters.
enum class LensKind : std::uint8_t {
    pinhole4,  ///< fx fy cx cy k1 k2 p1 p2
    pinhole5,  ///< as pinhole4, then k3
    rational,  ///< as pinhole5, then k4 k5 k6 (denominator of the radial part)
    fisheye,   ///< fx fy cx cy k1 k2 k3 k4 of Kannala and Brandt
};
inline constexpr const char* kLensKindNames[] = {"pinhole4", "pinhole5", "rational", "fisheye"};

struct ImageSize {
    int width = 0;
    int height = 0;
};

/// Returns the parameter names of a lens kind, in the order of its covariance.
[[nodiscard]] std::vector<std::string> parameter_names(LensKind kind);

/// Returns the camera model for parameters in the order of `parameter_names`.
[[nodiscard]] camera::CameraModel model_of(LensKind kind, const Eigen::VectorXd& parameters);

}  // namespace surefoot::calibration
