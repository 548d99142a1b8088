// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "surefoot/odometry/inertial/inertial_solver.hpp"

namespace surefoot::odometry {

/// A frame whose pose vision knows, and the IMU's motion from the frame before (of the first one,
/// nothing).
struct SeenMotion {
    Pose T_odom_imu;
    ImuMotion motion;
};

/// What vision and the IMU together tell about the last of some frames in a row.
struct InertialStart {
    InertialState state;        ///< the accelerometer's bias stays zero
    double residual_m = 0.0;    ///< rms of the positions
    double residual_rad = 0.0;  ///< rms of the turns from frame to frame
    double gravity_m_s2 = 0.0;  ///< as found; its direction is in the state
};

/// The bias of the gyroscope by linear least squares over the turns, then velocity and gravity over
/// the positions: p_k = p_0 + v_0 t_k + g t_k^2 / 2 + what the IMU adds up. Holds for standing and
/// for moving frames alike; odom need not be level. Nothing with fewer than four frames, or when
/// there is no force to speak of.
///
/// The linear start of Martinelli 2014 with poses that are known.
[[nodiscard]] std::optional<InertialStart> start_inertial(std::span<const SeenMotion> frames);

}  // namespace surefoot::odometry
