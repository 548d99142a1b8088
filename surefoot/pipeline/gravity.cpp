// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/gravity.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <vector>

#include "surefoot/core/angles.hpp"

namespace surefoot::pipeline {
namespace {

constexpr double kGravity_m_s2 = 9.81;

using Basis = Eigen::Matrix<double, 3, 2>;

/// Returns two unit vectors that are perpendicular to the direction and to each other.
Basis across(const Eigen::Vector3d& unit) {
    Basis basis;
    basis.col(0) = unit.unitOrthogonal();
    basis.col(1) = unit.cross(basis.col(0));
    return basis;
}

double square(double x) {
    return x * x;
}

/// Posterior for one kind of floor, in the plane across the accelerometer's up direction.
struct Update {
    double log_weight = 0.0;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

Update update_with(double share,
                   double slope_sigma_rad,
                   const Eigen::Vector2d& difference,
                   const Eigen::Matrix2d& up_covariance,
                   const Eigen::Matrix2d& normal_covariance) {
    const Eigen::Matrix2d total =
        up_covariance + normal_covariance + square(slope_sigma_rad) * Eigen::Matrix2d::Identity();
    const Eigen::Matrix2d inverse = total.inverse();
    const Eigen::Matrix2d gain = up_covariance * inverse;
    Update update;
    update.log_weight = std::log(share) - 0.5 * std::log(total.determinant()) -
                        0.5 * difference.dot(inverse * difference);
    update.mean = gain * difference;
    update.covariance = up_covariance - gain * up_covariance;
    return update;
}

struct Force {
    Eigen::Vector3d mean_m_s2 = Eigen::Vector3d::Zero();
    double mean_gyro_rad_s = 0.0;
    /// Half of the change of the mean between the first and the second half of the samples.
    double moved_m_s2 = 0.0;
};

std::optional<Force> force_of(std::span<const StereoFrame> frames) {
    std::vector<Eigen::Vector3d> forces_m_s2;
    Force force;
    for (const StereoFrame& frame : frames) {
        for (const ImuSample& sample : frame.imu) {
            forces_m_s2.push_back(sample.specific_force_m_s2);
            force.mean_gyro_rad_s += sample.angular_velocity_rad_s.norm();
        }
    }
    constexpr std::size_t kMinSamples = 10;
    if (forces_m_s2.size() < kMinSamples) return std::nullopt;
    std::array<Eigen::Vector3d, 2> sums{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    const std::size_t half = forces_m_s2.size() / 2;
    for (std::size_t i = 0; i < forces_m_s2.size(); ++i) sums[i < half ? 0 : 1] += forces_m_s2[i];
    const auto count = static_cast<double>(forces_m_s2.size());
    const auto first = static_cast<double>(half);
    force.mean_m_s2 = (sums[0] + sums[1]) / count;
    force.mean_gyro_rad_s /= count;
    force.moved_m_s2 = 0.5 * (sums[1] / (count - first) - sums[0] / first).norm();
    return force;
}

}  // namespace

double Direction::sigma_rad() const {
    return std::sqrt(0.5 * covariance.trace());
}

void GravityConfig::describe(ConfigVisitor& visitor) {
    visitor.number("accel_bias_m_s2",
                   accel_bias_m_s2,
                   1e-4,
                   5.0,
                   "one sigma of the accelerometer's constant error along each axis; 0.02 m/s2 for "
                   "calibrated accelerometers, 0.2 to 0.6 m/s2 for others");
    visitor.number("level_floor_deg",
                   level_floor_deg,
                   0.001,
                   5.0,
                   "one sigma of the slope of floors that are built level");
    visitor.number(
        "sloped_floor_deg",
        sloped_floor_deg,
        0.001,
        20.0,
        "one sigma of the slope of floors that are not built level, and of the vertical without an "
        "accelerometer");
    visitor.number("sloped_share",
                   sloped_share,
                   0.001,
                   0.999,
                   "prior probability that a start is on a floor that is not built level");
}

std::optional<Direction> up_from_imu(const GravityConfig& config,
                                     double still_gyro_rad_s,
                                     double still_force_m_s2,
                                     const Pose& T_body_imu,
                                     std::span<const StereoFrame> frames) {
    const auto force = force_of(frames);
    if (!force) return std::nullopt;
    const double excess_m_s2 = force->mean_m_s2.norm() - kGravity_m_s2;
    const bool still =
        force->mean_gyro_rad_s <= still_gyro_rad_s && std::abs(excess_m_s2) <= still_force_m_s2;
    if (!still) return std::nullopt;
    // The length of the force measures the bias along gravity. It counts as one sample of the bias
    // of all three axes. The setting counts as three more samples.
    constexpr double kPriorSamples = 3.0;
    const double bias_var = (kPriorSamples * square(config.accel_bias_m_s2) + square(excess_m_s2)) /
                            (kPriorSamples + 1.0);
    Direction up;
    up.unit_body = (T_body_imu.rotation * force->mean_m_s2).normalized();
    const double var_rad2 = (bias_var + square(force->moved_m_s2)) / square(kGravity_m_s2);
    up.covariance =
        var_rad2 * (Eigen::Matrix3d::Identity() - up.unit_body * up.unit_body.transpose());
    return up;
}

Direction up_from_plane(const GravityConfig& config, const Direction& normal) {
    Direction up = normal;
    up.covariance += square(config.sloped_floor_deg * kRadPerDeg) *
                     (Eigen::Matrix3d::Identity() - up.unit_body * up.unit_body.transpose());
    return up;
}

FusedUp fuse_up(const GravityConfig& config, const Direction& normal, const Direction& up_imu) {
    const Basis basis = across(up_imu.unit_body);
    const Eigen::Vector2d difference = basis.transpose() * normal.unit_body;
    const Eigen::Matrix2d up_covariance = basis.transpose() * up_imu.covariance * basis;
    const Eigen::Matrix2d normal_covariance = basis.transpose() * normal.covariance * basis;
    const auto with = [&](double share, double slope_deg) {
        return update_with(
            share, slope_deg * kRadPerDeg, difference, up_covariance, normal_covariance);
    };
    const Update level = with(1.0 - config.sloped_share, config.level_floor_deg);
    const Update sloped = with(config.sloped_share, config.sloped_floor_deg);
    FusedUp fused;
    const double odds = sloped.log_weight - level.log_weight;  // far below 0: the floor is level
    fused.level_probability = 1.0 / (1.0 + std::exp(odds));
    const double p = fused.level_probability;
    const Eigen::Vector2d mean = p * level.mean + (1.0 - p) * sloped.mean;
    const Eigen::Vector2d apart = level.mean - sloped.mean;
    const Eigen::Matrix2d covariance = p * level.covariance + (1.0 - p) * sloped.covariance +
                                       p * (1.0 - p) * apart * apart.transpose();
    fused.up.unit_body = (up_imu.unit_body + basis * mean).normalized();
    fused.up.covariance = basis * covariance * basis.transpose();
    return fused;
}

}  // namespace surefoot::pipeline
