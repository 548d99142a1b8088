// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/config.hpp"
#include "surefoot/odometry/inertial/imu_preintegration.hpp"

namespace surefoot::odometry {

/// How an IMU is used where the rig has one. The densities are above those of data sheets: what
/// scale, alignment, time stamps and vibration do to a sensor on a walking machine is in them.
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
