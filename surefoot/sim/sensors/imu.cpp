// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/imu.hpp"

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <utility>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/checked_index.hpp"
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
constexpr std::uint64_t kGyroWalkStream = kBiasStream - 1;
constexpr std::uint64_t kAccelWalkStream = kBiasStream - 2;

/// Returns a value after the range limit and the quantisation of the converter.
Vector3d converted(Vector3d value, double range, double step) {
    if (range > 0.0) value = value.cwiseMax(-range).cwiseMin(range);
    if (step > 0.0) value = step * (value / step).array().round().matrix();
    return value;
}

/// Densities and random walks from EuRoC's calibration (imu0/sensor.yaml). Ranges and counts from
/// the ADIS16448 data sheet: 1000 deg/s at 0.04 deg/s, 18 g at 0.833 mg. ASSUMPTION: the bias that
/// remains at the start after the sensor's own calibration.
ImuNoiseConfig adis16448() {
    return {.gyro_density_rad_s_sqrt_hz = 1.6968e-4,
            .accel_density_m_s2_sqrt_hz = 2.0e-3,
            .gyro_bias_sigma_rad_s = 0.05 * kRadPerDeg,
            .accel_bias_sigma_m_s2 = 3.0e-3 * kGravity_m_s2,
            .gyro_walk_rad_s2_sqrt_hz = 1.9393e-5,
            .accel_walk_m_s3_sqrt_hz = 3.0e-3,
            .gyro_range_rad_s = 1000.0 * kRadPerDeg,
            .accel_range_m_s2 = 18.0 * kGravity_m_s2,
            .gyro_step_rad_s = 0.04 * kRadPerDeg,
            .accel_step_m_s2 = 0.833e-3 * kGravity_m_s2};
}

/// InvenSense PS-MPU-6000A-00, revision 3.4, sections 6.1 and 6.2: 0.005 deg/s/sqrt(Hz), 400
/// ug/sqrt(Hz), zero offsets up to 20 deg/s and 50 mg (taken as 3 sigma), ranges 250 deg/s and 2 g
/// with 131 and 16384 counts per unit. ASSUMPTION: the data sheet gives no random walks. The walk
/// of the gyroscope is five times that of the ADIS16448; the walk of the accelerometer equals that
/// of the ADIS16448.
ImuNoiseConfig mpu6050() {
    return {.gyro_density_rad_s_sqrt_hz = 0.005 * kRadPerDeg,
            .accel_density_m_s2_sqrt_hz = 400e-6 * kGravity_m_s2,
            .gyro_bias_sigma_rad_s = 20.0 / 3.0 * kRadPerDeg,
            .accel_bias_sigma_m_s2 = 50e-3 / 3.0 * kGravity_m_s2,
            .gyro_walk_rad_s2_sqrt_hz = 1.0e-4,
            .accel_walk_m_s3_sqrt_hz = 3.0e-3,
            .gyro_range_rad_s = 250.0 * kRadPerDeg,
            .accel_range_m_s2 = 2.0 * kGravity_m_s2,
            .gyro_step_rad_s = kRadPerDeg / 131.0,
            .accel_step_m_s2 = kGravity_m_s2 / 16384.0};
}

/// Bosch BST-BMI055-DS000: 0.014 deg/s/sqrt(Hz), 150 ug/sqrt(Hz), zero offsets 1 deg/s and 70 mg
/// (taken as one and three sigma), ranges 125 deg/s and 2 g with 262.4 and 1024 counts per unit.
/// ASSUMPTION: random walks as for the MPU-6050.
ImuNoiseConfig bmi055() {
    return {.gyro_density_rad_s_sqrt_hz = 0.014 * kRadPerDeg,
            .accel_density_m_s2_sqrt_hz = 150e-6 * kGravity_m_s2,
            .gyro_bias_sigma_rad_s = 1.0 * kRadPerDeg,
            .accel_bias_sigma_m_s2 = 70e-3 / 3.0 * kGravity_m_s2,
            .gyro_walk_rad_s2_sqrt_hz = 1.0e-4,
            .accel_walk_m_s3_sqrt_hz = 3.0e-3,
            .gyro_range_rad_s = 125.0 * kRadPerDeg,
            .accel_range_m_s2 = 2.0 * kGravity_m_s2,
            .gyro_step_rad_s = kRadPerDeg / 262.4,
            .accel_step_m_s2 = kGravity_m_s2 / 1024.0};
}

}  // namespace

ImuNoiseConfig imu_noise_of(ImuKind kind) {
    switch (kind) {
        case ImuKind::none:
        case ImuKind::consumer: return {};
        case ImuKind::adis16448: return adis16448();
        case ImuKind::mpu6050: return mpu6050();
        case ImuKind::bmi055: return bmi055();
    }
    return {};
}

double random_walk(std::uint64_t seed, std::int64_t index) {
    if (index == 0) return 0.0;
    const std::uint64_t side = index > 0 ? 1U : 2U;
    const auto n = static_cast<std::uint64_t>(index > 0 ? index : -index);
    // Draws a number for each dyadic interval, which is given by its level and its position at that
    // level.
    const auto draw = [&](std::uint64_t level, std::uint64_t place) {
        Rng rng(mix_seed(mix_seed(mix_seed(seed, side), level), place));
        return rng.normal();
    };
    // Walks from one power of two to the next, up to n < 2^(top + 1).
    const auto top = static_cast<std::uint64_t>(std::bit_width(n)) - 1U;
    double low = draw(0, 0);  // W(1)
    for (std::uint64_t level = 0; level < top; ++level) {
        low += std::sqrt(std::ldexp(1.0, static_cast<int>(level))) * draw(level, 1);
    }
    std::uint64_t at = std::uint64_t{1} << top;
    if (at == n) return low;
    double high = low + std::sqrt(std::ldexp(1.0, static_cast<int>(top))) * draw(top, 1);
    for (std::uint64_t level = top; at != n; --level) {
        // The middle of a bridge over `width` has the mean of its ends and the variance width / 4.
        const std::uint64_t width = std::uint64_t{1} << level;
        const std::uint64_t middle = at + width / 2U;
        const double value =
            0.5 * (low + high) + 0.5 * std::sqrt(static_cast<double>(width)) * draw(level, middle);
        if (n >= middle) {
            at = middle;
            low = value;
        } else {
            high = value;
        }
    }
    return low;
}

void ImuNoiseConfig::describe(ConfigVisitor& visitor) {
    visitor.number("gyro_density_rad_s_sqrt_hz",
                   gyro_density_rad_s_sqrt_hz,
                   0.0,
                   1.0,
                   "density of the white noise of the gyroscope");
    visitor.number("accel_density_m_s2_sqrt_hz",
                   accel_density_m_s2_sqrt_hz,
                   0.0,
                   10.0,
                   "density of the white noise of the accelerometer");
    visitor.number("gyro_bias_sigma_rad_s",
                   gyro_bias_sigma_rad_s,
                   0.0,
                   1.0,
                   "one sigma of the gyroscope's bias at the start; the seed draws the bias");
    visitor.number("accel_bias_sigma_m_s2",
                   accel_bias_sigma_m_s2,
                   0.0,
                   10.0,
                   "one sigma of the accelerometer's bias at the start; the seed draws the bias");
    visitor.number("gyro_walk_rad_s2_sqrt_hz",
                   gyro_walk_rad_s2_sqrt_hz,
                   0.0,
                   1.0,
                   "density of the random walk of the gyroscope's bias");
    visitor.number("accel_walk_m_s3_sqrt_hz",
                   accel_walk_m_s3_sqrt_hz,
                   0.0,
                   10.0,
                   "density of the random walk of the accelerometer's bias");
    visitor.number("gyro_range_rad_s",
                   gyro_range_rad_s,
                   0.0,
                   1e3,
                   "turn rate at which the gyroscope saturates; 0 = no limit");
    visitor.number("accel_range_m_s2",
                   accel_range_m_s2,
                   0.0,
                   1e4,
                   "acceleration at which the accelerometer saturates; 0 = no limit");
    visitor.number("gyro_step_rad_s",
                   gyro_step_rad_s,
                   0.0,
                   1.0,
                   "turn rate of one count of the gyroscope; 0 = no quantisation");
    visitor.number("accel_step_m_s2",
                   accel_step_m_s2,
                   0.0,
                   10.0,
                   "acceleration of one count of the accelerometer; 0 = no quantisation");
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
    start_k_ =
        saturated_integer<std::int64_t>(std::floor(seconds_from_ns(start_ns) * mount.rate_hz));
}

Vector3d ImuModel::walked(std::uint64_t stream, double sigma, std::int64_t k) const {
    if (sigma == 0.0) return Vector3d::Zero();
    Vector3d value;
    for (int axis = 0; axis < 3; ++axis) {
        const std::uint64_t seed =
            mix_seed(mix_seed(seed_, stream), static_cast<std::uint64_t>(axis));
        value[axis] = sigma * random_walk(seed, k - start_k_);
    }
    return value;
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
    auto k = saturated_integer<std::int64_t>(
        std::floor(seconds_from_ns(after_ns) * mount_.rate_hz) - 1.0);
    const double root_rate = std::sqrt(mount_.rate_hz);
    for (; stamp_ns(k) <= until_ns; ++k) {
        if (stamp_ns(k) <= after_ns) continue;
        ImuSample sample = ideal(stamp_ns(k));
        Rng rng(mix_seed(seed_, static_cast<std::uint64_t>(k)));
        sample.angular_velocity_rad_s +=
            gyro_bias_rad_s_ + normal3(rng, noise_.gyro_density_rad_s_sqrt_hz * root_rate) +
            walked(kGyroWalkStream, noise_.gyro_walk_rad_s2_sqrt_hz / root_rate, k);
        sample.specific_force_m_s2 +=
            accel_bias_m_s2_ + normal3(rng, noise_.accel_density_m_s2_sqrt_hz * root_rate) +
            walked(kAccelWalkStream, noise_.accel_walk_m_s3_sqrt_hz / root_rate, k);
        sample.angular_velocity_rad_s = converted(
            sample.angular_velocity_rad_s, noise_.gyro_range_rad_s, noise_.gyro_step_rad_s);
        sample.specific_force_m_s2 =
            converted(sample.specific_force_m_s2, noise_.accel_range_m_s2, noise_.accel_step_m_s2);
        result.push_back(sample);
    }
    return result;
}

}  // namespace surefoot::sim
