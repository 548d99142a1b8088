// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/modelled_odometry.hpp"

#include <cmath>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::sim {

void DriftConfig::describe(ConfigVisitor& visitor) {
    visitor.number("position_m_sqrt_m",
                   position_m_sqrt_m,
                   0.0,
                   1.0,
                   "one sigma of the position error along each axis after 1 m of motion");
    visitor.number("turn_deg_sqrt_m",
                   turn_deg_sqrt_m,
                   0.0,
                   30.0,
                   "one sigma of the rotation error about each axis after 1 m of motion");
}

ModelledOdometry::ModelledOdometry(const DriftConfig& config,
                                   const Pose& T_body_camera,
                                   std::uint64_t seed)
    : config_(config), T_body_camera_(T_body_camera), seed_(seed) {}

MotionEstimate ModelledOdometry::follow(std::int64_t time_ns, int frame, const Pose& T_world_body) {
    MotionEstimate motion;
    motion.time_ns = time_ns;
    motion.health = Health::ok;
    motion.reason = HealthReason::none;
    if (T_world_previous_) {
        const Pose T_previous_body = T_world_previous_->inverse() * T_world_body;
        const Pose T_previous_camera = T_body_camera_.inverse() * T_previous_body * T_body_camera_;
        const double root_of_way = std::sqrt(T_previous_camera.translation_m.norm());
        Vector6 sigma;
        sigma.head<3>().setConstant(config_.position_m_sqrt_m * root_of_way);
        sigma.tail<3>().setConstant(config_.turn_deg_sqrt_m * kRadPerDeg * root_of_way);
        Rng rng(mix_seed(seed_, static_cast<std::uint64_t>(frame)));
        Vector6 error;
        for (double& value : error) value = rng.normal();
        motion.T_previous_body = perturbed(T_previous_body, sigma.cwiseProduct(error));
        motion.relative_covariance = sigma.cwiseAbs2().asDiagonal();
    }
    motion.T_odom_body = T_odom_previous_ * motion.T_previous_body;
    T_world_previous_ = T_world_body;
    T_odom_previous_ = motion.T_odom_body;
    return motion;
}

}  // namespace surefoot::sim
