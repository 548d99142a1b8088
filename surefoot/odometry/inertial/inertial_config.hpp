// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/config.hpp"
#include "surefoot/odometry/inertial/imu_preintegration.hpp"

namespace surefoot::odometry {

/// Use of the rig's IMU. The noise densities exceed those of data sheets, because they include
/// errors of scale, alignment and time stamps and the vibration of a walking machine.
struct InertialConfig {
    bool enabled = true;
    ImuNoise noise;
    ImuLimits limits;
    double gravity_m_s2 = 9.80665;
    double gyro_bias_sigma_rad_s = 5e-3;
    double accel_bias_sigma_m_s2 = 0.2;
    double start_s = 1.0;
    double dead_reckoning_s = 0.5;
    void describe(ConfigVisitor& visitor);
};

}  // namespace surefoot::odometry
