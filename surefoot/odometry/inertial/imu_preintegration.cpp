// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/inertial/imu_preintegration.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/time.hpp"

namespace surefoot::odometry {
namespace {

/// A reading also counts as saturated if it stays exactly the same for this many samples, at a rate
/// or force that a machine in steady motion never has. This test works even if the range is
/// unknown.
constexpr int kStuckSamples = 4;
constexpr double kStuckRate_rad_s = 2.0;
constexpr double kStuckForce_m_s2 = 15.0;
/// Readings this close to the range count as saturated, because converters end a few counts early.
constexpr double kAtRange = 0.998;

bool finite(const ImuSample& sample) {
    return sample.angular_velocity_rad_s.allFinite() && sample.specific_force_m_s2.allFinite();
}

bool at_range(const ImuLimits& limits, const ImuSample& sample) {
    const auto beyond = [](const Eigen::Vector3d& value, double range) {
        return range > 0.0 && value.cwiseAbs().maxCoeff() >= kAtRange * range;
    };
    return beyond(sample.angular_velocity_rad_s, limits.gyro_range_rad_s) ||
           beyond(sample.specific_force_m_s2, limits.accel_range_m_s2);
}

/// True if the readings are high and constant on one axis. `get` returns the three axes of a
/// sample.
template <typename Get>
bool stuck(std::span<const ImuSample> samples, double least, const Get& get) {
    Eigen::Vector3i run = Eigen::Vector3i::Ones();
    for (std::size_t i = 1; i < samples.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            const double value = get(samples[i])[axis];
            const bool same = value == get(samples[i - 1])[axis] && std::abs(value) >= least;
            run[axis] = same ? run[axis] + 1 : 1;
            if (run[axis] >= kStuckSamples) return true;
        }
    }
    return false;
}

/// Returns the samples that the interval needs: from the last sample at or before its start to the
/// first sample at or after its end. Stamps must increase.
std::span<const ImuSample> around(std::span<const ImuSample> samples,
                                  std::int64_t start_ns,
                                  std::int64_t end_ns) {
    std::size_t first = 0;
    while (first + 1 < samples.size() && samples[first + 1].time_ns <= start_ns) ++first;
    std::size_t last = first;
    while (last < samples.size() && samples[last].time_ns < end_ns) ++last;
    return samples.subspan(first, std::min(last + 1, samples.size()) - first);
}

ImuProblem problem_of(const ImuLimits& limits,
                      std::span<const ImuSample> samples,
                      std::int64_t start_ns,
                      std::int64_t end_ns) {
    if (samples.empty()) return ImuProblem::no_samples;
    const std::int64_t longest_ns = ns_from_seconds(limits.max_gap_s);
    if (samples.back().time_ns + longest_ns < start_ns ||
        samples.front().time_ns - longest_ns > end_ns)
        return ImuProblem::no_samples;
    if (samples.front().time_ns - start_ns > longest_ns ||
        end_ns - samples.back().time_ns > longest_ns)
        return ImuProblem::gap;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (!finite(samples[i])) return ImuProblem::not_finite;
        if (at_range(limits, samples[i])) return ImuProblem::saturated;
        if (i > 0 && samples[i].time_ns - samples[i - 1].time_ns > longest_ns)
            return ImuProblem::gap;
    }
    const bool is_stuck =
        stuck(samples,
              kStuckRate_rad_s,
              [](const ImuSample& s) { return s.angular_velocity_rad_s; }) ||
        stuck(samples, kStuckForce_m_s2, [](const ImuSample& s) { return s.specific_force_m_s2; });
    return is_stuck ? ImuProblem::saturated : ImuProblem::none;
}

/// Returns the reading at a time. `next` is the index of the first sample that is not before it.
ImuSample reading_at(std::span<const ImuSample> samples, std::size_t next, std::int64_t time_ns) {
    if (next == 0 || next == samples.size()) {
        ImuSample held = next == 0 ? samples.front() : samples.back();
        held.time_ns = time_ns;
        return held;
    }
    const ImuSample& a = samples[next - 1];
    const ImuSample& b = samples[next];
    const double s =
        static_cast<double>(time_ns - a.time_ns) / static_cast<double>(b.time_ns - a.time_ns);
    return {time_ns,
            a.angular_velocity_rad_s + s * (b.angular_velocity_rad_s - a.angular_velocity_rad_s),
            a.specific_force_m_s2 + s * (b.specific_force_m_s2 - a.specific_force_m_s2)};
}

/// One step of the mid-point rule, including the covariance and the Jacobians of the biases.
void step(const ImuNoise& noise, const ImuSample& from, const ImuSample& to, ImuMotion& m) {
    const double dt_s = seconds_from_ns(to.time_ns - from.time_ns);
    const Eigen::Vector3d turn_rad =
        dt_s *
        (0.5 * (from.angular_velocity_rad_s + to.angular_velocity_rad_s) - m.bias.gyro_rad_s);
    const Eigen::Vector3d force =
        0.5 * (from.specific_force_m_s2 + to.specific_force_m_s2) - m.bias.accel_m_s2;
    const Eigen::Quaterniond half = m.rotation * exp_so3(0.5 * turn_rad);
    const Eigen::Matrix3d R_half = half.toRotationMatrix();
    const Eigen::Vector3d acceleration = R_half * force;

    // Errors of the rotation after the whole and after half a step:
    // phi' = T phi + G n_gyro,  phi_half = T_half phi + J_half n_gyro.
    const Eigen::Matrix3d T = exp_so3(turn_rad).conjugate().toRotationMatrix();
    const Eigen::Matrix3d T_half = exp_so3(0.5 * turn_rad).conjugate().toRotationMatrix();
    const Eigen::Matrix3d G = dt_s * right_jacobian_so3(turn_rad);
    const Eigen::Matrix3d J_half = 0.5 * dt_s * right_jacobian_so3(0.5 * turn_rad);
    const Eigen::Matrix3d tilt = -R_half * skew(force);  // d acceleration / d phi_half
    const Eigen::Matrix3d by_phi = tilt * T_half;
    const Eigen::Matrix3d by_gyro = tilt * J_half;

    Matrix9 A = Matrix9::Identity();
    A.block<3, 3>(0, 0) = T;
    A.block<3, 3>(3, 0) = dt_s * by_phi;
    A.block<3, 3>(6, 0) = 0.5 * dt_s * dt_s * by_phi;
    A.block<3, 3>(6, 3) = dt_s * Eigen::Matrix3d::Identity();
    Eigen::Matrix<double, 9, 6> B = Eigen::Matrix<double, 9, 6>::Zero();
    B.block<3, 3>(0, 0) = G;
    B.block<3, 3>(3, 0) = dt_s * by_gyro;
    B.block<3, 3>(6, 0) = 0.5 * dt_s * dt_s * by_gyro;
    B.block<3, 3>(3, 3) = dt_s * R_half;
    B.block<3, 3>(6, 3) = 0.5 * dt_s * dt_s * R_half;
    Vector6 variance;  // variance of the mean of white noise over the step
    variance.head<3>().setConstant(noise.gyro_density_rad_s_sqrt_hz *
                                   noise.gyro_density_rad_s_sqrt_hz / dt_s);
    variance.tail<3>().setConstant(noise.accel_density_m_s2_sqrt_hz *
                                   noise.accel_density_m_s2_sqrt_hz / dt_s);
    m.covariance = (A * m.covariance * A.transpose()).eval();
    m.covariance.noalias() += B * variance.asDiagonal() * B.transpose();

    // A bias acts like a constant noise n of opposite sign.
    const Eigen::Matrix3d turned = by_phi * m.d_rotation_d_gyro - by_gyro;
    m.d_position_d_gyro += dt_s * m.d_velocity_d_gyro + 0.5 * dt_s * dt_s * turned;
    m.d_velocity_d_gyro += dt_s * turned;
    m.d_rotation_d_gyro = (T * m.d_rotation_d_gyro - G).eval();
    m.d_position_d_accel += dt_s * m.d_velocity_d_accel - 0.5 * dt_s * dt_s * R_half;
    m.d_velocity_d_accel -= dt_s * R_half;

    m.position_m += dt_s * m.velocity_m_s + 0.5 * dt_s * dt_s * acceleration;
    m.velocity_m_s += dt_s * acceleration;
    m.rotation = (m.rotation * exp_so3(turn_rad)).normalized();
}

}  // namespace

const char* to_string(ImuProblem problem) noexcept {
    switch (problem) {
        case ImuProblem::none: return "none";
        case ImuProblem::no_samples: return "no_samples";
        case ImuProblem::gap: return "gap";
        case ImuProblem::stamps: return "stamps";
        case ImuProblem::not_finite: return "not_finite";
        case ImuProblem::saturated: return "saturated";
    }
    return "?";
}

Eigen::Quaterniond ImuMotion::rotation_at(const ImuBias& other) const {
    return rotation * exp_so3(d_rotation_d_gyro * (other.gyro_rad_s - bias.gyro_rad_s));
}

Eigen::Vector3d ImuMotion::velocity_at(const ImuBias& other) const {
    return velocity_m_s + d_velocity_d_gyro * (other.gyro_rad_s - bias.gyro_rad_s) +
           d_velocity_d_accel * (other.accel_m_s2 - bias.accel_m_s2);
}

Eigen::Vector3d ImuMotion::position_at(const ImuBias& other) const {
    return position_m + d_position_d_gyro * (other.gyro_rad_s - bias.gyro_rad_s) +
           d_position_d_accel * (other.accel_m_s2 - bias.accel_m_s2);
}

Preintegration preintegrate(const ImuLimits& limits,
                            const ImuNoise& noise,
                            std::span<const ImuSample> samples,
                            std::int64_t start_ns,
                            std::int64_t end_ns,
                            const ImuBias& bias) {
    Preintegration result;
    result.motion.bias = bias;
    const bool grow = std::ranges::adjacent_find(samples, [](const auto& a, const auto& b) {
                          return b.time_ns <= a.time_ns;
                      }) == samples.end();
    result.problem = grow && start_ns < end_ns ? ImuProblem::none : ImuProblem::stamps;
    if (result.problem != ImuProblem::none) return result;
    samples = around(samples, start_ns, end_ns);
    result.problem = problem_of(limits, samples, start_ns, end_ns);
    if (result.problem != ImuProblem::none) return result;

    result.motion.dt_s = seconds_from_ns(end_ns - start_ns);
    std::size_t next = 0;
    while (next < samples.size() && samples[next].time_ns < start_ns) ++next;
    ImuSample from = reading_at(samples, next, start_ns);
    while (from.time_ns < end_ns) {
        while (next < samples.size() && samples[next].time_ns <= from.time_ns) ++next;
        const bool last = next == samples.size() || samples[next].time_ns >= end_ns;
        const ImuSample to = last ? reading_at(samples, next, end_ns) : samples[next];
        step(noise, from, to, result.motion);
        from = to;
    }
    return result;
}

Eigen::Matrix3d right_jacobian_so3(const Eigen::Vector3d& theta_rad) {
    const double angle2 = theta_rad.squaredNorm();
    const Eigen::Matrix3d S = skew(theta_rad);
    // Below 1e-4 rad the next terms of the series are negligible.
    if (angle2 < 1e-8) return Eigen::Matrix3d::Identity() - 0.5 * S + (1.0 / 6.0) * S * S;
    const double angle = std::sqrt(angle2);
    return Eigen::Matrix3d::Identity() - (1.0 - std::cos(angle)) / angle2 * S +
           (angle - std::sin(angle)) / (angle2 * angle) * S * S;
}

Eigen::Matrix3d inverse_right_jacobian_so3(const Eigen::Vector3d& theta_rad) {
    const double angle2 = theta_rad.squaredNorm();
    const Eigen::Matrix3d S = skew(theta_rad);
    if (angle2 < 1e-8) return Eigen::Matrix3d::Identity() + 0.5 * S + (1.0 / 12.0) * S * S;
    const double half = 0.5 * std::sqrt(angle2);
    return Eigen::Matrix3d::Identity() + 0.5 * S +
           (1.0 - half * std::cos(half) / std::sin(half)) / angle2 * S * S;
}

}  // namespace surefoot::odometry
