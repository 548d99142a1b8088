// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/smooth_curve.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/checked_index.hpp"

namespace surefoot::sim {

Jet operator+(const Jet& a, const Jet& b) noexcept {
    return {a.value + b.value, a.rate + b.rate, a.acceleration + b.acceleration};
}

Jet operator*(double factor, const Jet& a) noexcept {
    return {factor * a.value, factor * a.rate, factor * a.acceleration};
}

Jet operator*(const Jet& a, const Jet& b) noexcept {
    return {a.value * b.value,
            a.rate * b.value + a.value * b.rate,
            a.acceleration * b.value + 2.0 * a.rate * b.rate + a.value * b.acceleration};
}

Jet oscillation(double amplitude, double omega_rad_s, double phase_rad, double t_s) {
    const double s = amplitude * std::sin(omega_rad_s * t_s + phase_rad);
    const double c = amplitude * std::cos(omega_rad_s * t_s + phase_rad);
    return {s, omega_rad_s * c, -omega_rad_s * omega_rad_s * s};
}

double eased(double u) noexcept {
    const double v = std::clamp(u, 0.0, 1.0);
    return v * v * v * (10.0 + v * (-15.0 + 6.0 * v));
}

SmoothCurve::SmoothCurve(double start_s, double interval_s, std::vector<double> samples)
    : start_s_(start_s), interval_s_(interval_s), samples_(std::move(samples)) {
    SUREFOOT_ASSERT(!samples_.empty() && interval_s > 0.0);
}

Jet SmoothCurve::at(double time_s) const {
    const auto count = static_cast<double>(samples_.size());
    // Sample i is at x = i. The curve is constant until one interval before the first sample, and
    // from one interval after the last sample.
    const double x = std::clamp((time_s - start_s_) / interval_s_, 0.0, count + 1.0) - 1.0;
    const double knot = std::floor(x);
    const double u = x - knot;
    const auto sample = [&](int offset) {
        const auto index = saturated_integer<std::size_t>(knot + offset);
        return samples_[std::min(index, samples_.size() - 1)];
    };
    const double a = sample(-1);
    const double b = sample(0);
    const double c = sample(1);
    const double d = sample(2);
    const double v = 1.0 - u;
    // Basis of the uniform cubic B-spline and its derivatives by u.
    const double value = (v * v * v * a + (4.0 - 6.0 * u * u + 3.0 * u * u * u) * b +
                          (4.0 - 6.0 * v * v + 3.0 * v * v * v) * c + u * u * u * d) /
                         6.0;
    const double by_u =
        0.5 * (-v * v * a + u * (3.0 * u - 4.0) * b - v * (3.0 * v - 4.0) * c + u * u * d);
    const double by_uu = v * a + (3.0 * u - 2.0) * b + (3.0 * v - 2.0) * c + u * d;
    return {value, by_u / interval_s_, by_uu / (interval_s_ * interval_s_)};
}

MotionState motion_state(const std::array<Jet, 3>& position_m,
                         const std::array<Jet, 3>& roll_pitch_yaw_rad) {
    MotionState state;
    for (int axis = 0; axis < 3; ++axis) {
        const Jet& jet = position_m[static_cast<std::size_t>(axis)];
        state.T_world_body.translation_m[axis] = jet.value;
        state.velocity_world_m_s[axis] = jet.rate;
        state.acceleration_world_m_s2[axis] = jet.acceleration;
    }
    const auto& [roll, pitch, yaw] = roll_pitch_yaw_rad;
    state.T_world_body.rotation = Eigen::AngleAxisd(yaw.value, Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(pitch.value, Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(roll.value, Eigen::Vector3d::UnitX());
    const double sr = std::sin(roll.value);
    const double cr = std::cos(roll.value);
    const double sp = std::sin(pitch.value);
    const double cp = std::cos(pitch.value);
    // omega = roll' + (pitch' turned by roll) + (yaw' turned by pitch and roll), in body axes.
    state.angular_velocity_body_rad_s = {roll.rate - yaw.rate * sp,
                                         pitch.rate * cr + yaw.rate * sr * cp,
                                         -pitch.rate * sr + yaw.rate * cr * cp};
    state.angular_acceleration_body_rad_s2 = {
        roll.acceleration - yaw.acceleration * sp - yaw.rate * cp * pitch.rate,
        pitch.acceleration * cr - pitch.rate * sr * roll.rate + yaw.acceleration * sr * cp +
            yaw.rate * (cr * roll.rate * cp - sr * sp * pitch.rate),
        -pitch.acceleration * sr - pitch.rate * cr * roll.rate + yaw.acceleration * cr * cp -
            yaw.rate * (sr * roll.rate * cp + cr * sp * pitch.rate)};
    return state;
}

}  // namespace surefoot::sim
