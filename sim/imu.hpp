// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/motion.hpp"
#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/core/frame.hpp"

namespace surefoot::sim {

inline constexpr double kGravity_m_s2 = 9.81;

/// Errors of an inertial sensor: white noise by density, and a constant bias drawn once per seed.
/// The defaults are of the order of a consumer MEMS part.
struct ImuNoiseConfig {
    double gyro_density_rad_s_sqrt_hz = 1.5e-4;
    double accel_density_m_s2_sqrt_hz = 2.0e-3;
    double gyro_bias_sigma_rad_s = 1.0e-3;
    double accel_bias_sigma_m_s2 = 2.0e-2;

    void describe(ConfigVisitor& visitor);
};

/// Samples of an IMU on a moving body. Sample k is taken at k / rate from time zero, whatever is
/// asked for, and its noise depends on (seed, k) alone.
class ImuModel {
  public:
    /// `start_ns` is the stamp at which the trajectory starts.
    ImuModel(std::shared_ptr<const Motion> motion,
             const camera::ImuMount& mount,
             const ImuNoiseConfig& noise,
             std::int64_t start_ns,
             std::uint64_t seed);
    /// Samples with after_ns < stamp <= until_ns.
    [[nodiscard]] std::vector<ImuSample> samples(std::int64_t after_ns,
                                                 std::int64_t until_ns) const;
    /// Noiseless sample at any time.
    [[nodiscard]] ImuSample ideal(std::int64_t time_ns) const;

  private:
    [[nodiscard]] std::int64_t stamp_ns(std::int64_t k) const;

    std::shared_ptr<const Motion> motion_;
    camera::ImuMount mount_;
    ImuNoiseConfig noise_;
    std::int64_t start_ns_ = 0;
    std::uint64_t seed_ = 0;
    Eigen::Vector3d gyro_bias_rad_s_ = Eigen::Vector3d::Zero();
    Eigen::Vector3d accel_bias_m_s2_ = Eigen::Vector3d::Zero();
};

}  // namespace surefoot::sim
