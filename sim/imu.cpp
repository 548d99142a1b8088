// SPDX-License-Identifier: Apache-2.0
#include "sim/imu.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

Vector3d normal3(Rng& rng, double sigma) {
    Vector3d value;
    for (int axis = 0; axis < 3; ++axis) value[axis] = sigma * rng.normal();
    return value;
}

constexpr std::uint64_t kBiasStream = ~std::uint64_t{0};

}  // namespace

void ImuNoiseConfig::describe(ConfigVisitor& visitor) {
    visitor.number("gyro_density_rad_s_sqrt_hz",
                   gyro_density_rad_s_sqrt_hz,
                   0.0,
                   1.0,
                   "white noise of the gyroscope");
    visitor.number("accel_density_m_s2_sqrt_hz",
                   accel_density_m_s2_sqrt_hz,
                   0.0,
                   10.0,
                   "white noise of the accelerometer");
    visitor.number(
        "gyro_bias_sigma_rad_s", gyro_bias_sigma_rad_s, 0.0, 1.0, "constant bias, drawn per seed");
    visitor.number(
        "accel_bias_sigma_m_s2", accel_bias_sigma_m_s2, 0.0, 10.0, "constant bias, drawn per seed");
}

ImuModel::ImuModel(std::shared_ptr<const Motion> motion,
                   const camera::ImuMount& mount,
                   const ImuNoiseConfig& noise,
                   std::int64_t start_ns,
                   std::uint64_t seed)
    : motion_(std::move(motion)), mount_(mount), noise_(noise), start_ns_(start_ns), seed_(seed) {
    Rng rng(mix_seed(seed, kBiasStream));
    gyro_bias_rad_s_ = normal3(rng, noise.gyro_bias_sigma_rad_s);
    accel_bias_m_s2_ = normal3(rng, noise.accel_bias_sigma_m_s2);
}

std::int64_t ImuModel::stamp_ns(std::int64_t k) const {
    return ns_from_seconds(static_cast<double>(k) / mount_.rate_hz);
}

ImuSample ImuModel::ideal(std::int64_t time_ns) const {
    const MotionState state = motion_->at(seconds_from_ns(time_ns - start_ns_));
    const Vector3d& omega = state.angular_velocity_body_rad_s;
    const Vector3d& lever_m = mount_.T_body_imu.translation_m;
    const Vector3d up(0.0, 0.0, kGravity_m_s2);
    // Acceleration of a point fixed to a turning body: a + alpha x r + omega x (omega x r).
    const Vector3d force_body =
        state.T_world_body.rotation.conjugate() * (state.acceleration_world_m_s2 + up) +
        state.angular_acceleration_body_rad_s2.cross(lever_m) + omega.cross(omega.cross(lever_m));
    const Eigen::Quaterniond R_imu_body = mount_.T_body_imu.rotation.conjugate();
    return {time_ns, R_imu_body * omega, R_imu_body * force_body};
}

std::vector<ImuSample> ImuModel::samples(std::int64_t after_ns, std::int64_t until_ns) const {
    std::vector<ImuSample> result;
    auto k = static_cast<std::int64_t>(std::floor(seconds_from_ns(after_ns) * mount_.rate_hz)) - 1;
    const double root_rate = std::sqrt(mount_.rate_hz);
    for (; stamp_ns(k) <= until_ns; ++k) {
        if (stamp_ns(k) <= after_ns) continue;
        ImuSample sample = ideal(stamp_ns(k));
        Rng rng(mix_seed(seed_, static_cast<std::uint64_t>(k)));
        sample.angular_velocity_rad_s +=
            gyro_bias_rad_s_ + normal3(rng, noise_.gyro_density_rad_s_sqrt_hz * root_rate);
        sample.specific_force_m_s2 +=
            accel_bias_m_s2_ + normal3(rng, noise_.accel_density_m_s2_sqrt_hz * root_rate);
        result.push_back(sample);
    }
    return result;
}

}  // namespace surefoot::sim
