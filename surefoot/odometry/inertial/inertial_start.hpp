// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "surefoot/odometry/inertial/inertial_solver.hpp"

namespace surefoot::odometry {

/// A frame whose pose is known from vision, and the IMU's motion from the previous frame (empty for
/// the first frame).
struct SeenMotion {
    Pose T_odom_imu;
    ImuMotion motion;
};

/// Result for the last of several frames in a row, estimated from vision and the IMU together.
struct InertialStart {
    InertialState state;        ///< the accelerometer's bias stays zero
    double residual_m = 0.0;    ///< rms residual of the positions
    double residual_rad = 0.0;  ///< rms residual of the turns between frames
    double gravity_m_s2 = 0.0;  ///< estimated magnitude of gravity; `state` has its direction
};

/// Estimates the gyroscope bias by linear least squares over the rotations. Then estimates velocity
/// and gravity over the positions: p_k = p_0 + v_0 t_k + g t_k^2 / 2 + the integrated readings.
/// Works for standing and moving cameras; odom need not be level. Returns nothing with fewer than
/// four frames or if the gravity found is too small.
///
/// The linear initialisation of Martinelli 2014, with known poses.
[[nodiscard]] std::optional<InertialStart> start_inertial(std::span<const SeenMotion> frames);

}  // namespace surefoot::odometry
