// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surefoot/sim/motion/motion.hpp"

namespace surefoot::sim {

/// For tests: largest differences between the derivatives that a motion reports and central
/// differences of its own values, over an interval of time.
struct DerivativeErrors {
    double velocity_m_s = 0.0;
    double acceleration_m_s2 = 0.0;
    double turn_rad_s = 0.0;
    double turn_acceleration_rad_s2 = 0.0;
};

inline DerivativeErrors derivative_errors(const Motion& motion, double from_s, double to_s) {
    constexpr double kStep_s = 1e-4;
    constexpr double kEvery_s = 0.00371;
    DerivativeErrors worst;
    for (double t_s = from_s; t_s < to_s; t_s += kEvery_s) {
        const MotionState a = motion.at(t_s - kStep_s);
        const MotionState now = motion.at(t_s);
        const MotionState b = motion.at(t_s + kStep_s);
        const auto raise = [](double& value, const Eigen::Vector3d& error) {
            value = std::max(value, error.norm());
        };
        const double by_step = 0.5 / kStep_s;
        raise(worst.velocity_m_s,
              by_step * (b.T_world_body.translation_m - a.T_world_body.translation_m) -
                  now.velocity_world_m_s);
        raise(
            worst.acceleration_m_s2,
            by_step * (b.velocity_world_m_s - a.velocity_world_m_s) - now.acceleration_world_m_s2);
        raise(worst.turn_rad_s,
              by_step * log_so3(a.T_world_body.rotation.conjugate() * b.T_world_body.rotation) -
                  now.angular_velocity_body_rad_s);
        raise(worst.turn_acceleration_rad_s2,
              by_step * (b.angular_velocity_body_rad_s - a.angular_velocity_body_rad_s) -
                  now.angular_acceleration_body_rad_s2);
    }
    return worst;
}

}  // namespace surefoot::sim
