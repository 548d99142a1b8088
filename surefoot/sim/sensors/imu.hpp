// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/sim/motion/motion.hpp"

namespace surefoot::sim {

inline constexpr double kGravity_m_s2 = 9.81;

/// Errors of an inertial sensor: white noise by density, bias, saturation at the range limits, and
/// quantisation. The bias is drawn once per seed and then follows a random walk. The defaults have
/// the order of a consumer MEMS part with a steady bias.
struct ImuNoiseConfig {
    double gyro_density_rad_s_sqrt_hz = 1.5e-4;
    double accel_density_m_s2_sqrt_hz = 2.0e-3;
    double gyro_bias_sigma_rad_s = 1.0e-3;
    double accel_bias_sigma_m_s2 = 2.0e-2;
    double gyro_walk_rad_s2_sqrt_hz = 0.0;  ///< the bias gains walk * sqrt(t) in t seconds
    double accel_walk_m_s3_sqrt_hz = 0.0;
    double gyro_range_rad_s = 0.0;  ///< range limit; 0 = unlimited
    double accel_range_m_s2 = 0.0;  ///< range limit; 0 = unlimited
    double gyro_step_rad_s = 0.0;   ///< size of one count of the converter; 0 = no quantisation
    double accel_step_m_s2 = 0.0;

    void describe(ConfigVisitor& visitor);
};

/// Model of the inertial sensor.
enum class ImuKind : std::uint8_t {
    none,
    consumer,   ///< the defaults of ImuNoiseConfig
    adis16448,  ///< the IMU of the EuRoC recordings (their calibration)
    mpu6050,    ///< also the inertial part of the MPU-9150; same class as the IMU of the DUO
    bmi055,     ///< IMU of the phone class, with a 12-bit accelerometer
};
inline constexpr const char* kImuNames[] = {"none", "consumer", "adis16448", "mpu6050", "bmi055"};

/// Returns the errors of an IMU; `none` and `consumer` give the defaults.
[[nodiscard]] ImuNoiseConfig imu_noise_of(ImuKind kind);

/// A random walk with steps of unit variance. Any index is computed without the steps before it
/// (Levy's construction of Brownian motion: independent increments between powers of two, bridges
/// between them). W(0) = 0; negative indices walk the other way. The result depends on (seed,
/// index) alone.
[[nodiscard]] double random_walk(std::uint64_t seed, std::int64_t index);

/// IMU samples on a moving body. Sample k is at k / rate from time zero for every query, and its
/// errors depend on (seed, k) alone. At the start the bias has its drawn value.
class ImuModel {
  public:
    /// `start_ns` is the stamp of the start of the trajectory.
    ImuModel(std::shared_ptr<const Motion> motion,
             const camera::ImuMount& mount,
             const ImuNoiseConfig& noise,
             std::int64_t start_ns,
             std::uint64_t seed);
    /// Returns the samples with after_ns < stamp <= until_ns.
    [[nodiscard]] std::vector<ImuSample> samples(std::int64_t after_ns,
                                                 std::int64_t until_ns) const;
    /// Returns the sample without errors at `time_ns`.
    [[nodiscard]] ImuSample ideal(std::int64_t time_ns) const;

  private:
    [[nodiscard]] std::int64_t stamp_ns(std::int64_t k) const;
    [[nodiscard]] Eigen::Vector3d walked(std::uint64_t stream, double sigma, std::int64_t k) const;

    std::shared_ptr<const Motion> motion_;
    camera::ImuMount mount_;
    ImuNoiseConfig noise_;
    std::int64_t start_ns_ = 0;
    std::int64_t start_k_ = 0;  ///< last sample at or before the start: the walk begins there
    std::uint64_t seed_ = 0;
    Eigen::Vector3d gyro_bias_rad_s_ = Eigen::Vector3d::Zero();
    Eigen::Vector3d accel_bias_m_s2_ = Eigen::Vector3d::Zero();
};

}  // namespace surefoot::sim
