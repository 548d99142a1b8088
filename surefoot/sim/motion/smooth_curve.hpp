// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "surefoot/sim/motion/motion.hpp"

namespace surefoot::sim {

/// A quantity with its first and second derivative by time.
struct Jet {
    double value = 0.0;
    double rate = 0.0;
    double acceleration = 0.0;
};
[[nodiscard]] Jet operator+(const Jet& a, const Jet& b) noexcept;
[[nodiscard]] Jet operator*(double factor, const Jet& a) noexcept;
[[nodiscard]] Jet operator*(const Jet& a, const Jet& b) noexcept;
/// Value and derivatives of A sin(omega t + phase).
[[nodiscard]] Jet oscillation(double amplitude, double omega_rad_s, double phase_rad, double t_s);

/// Quintic smoothstep 6u^5 - 15u^4 + 10u^3 with u clamped to [0, 1]. Rises from 0 to 1; its first
/// and second derivatives are 0 at both ends.
[[nodiscard]] double eased(double u) noexcept;

/// Uniform cubic B-spline over time; the control values are the samples of a curve. Its second
/// derivative is continuous. The curve smooths single outliers by [1 4 1] / 6. It stays in the
/// range of four neighbouring samples (de Boor, "A Practical Guide to Splines", 1978). The first
/// and the last sample are repeated, so that the curve rests on them at both ends.
class SmoothCurve {
  public:
    /// Requires at least one sample. Duration: (samples + 1) intervals.
    SmoothCurve(double start_s, double interval_s, std::vector<double> samples);
    [[nodiscard]] Jet at(double time_s) const;

  private:
    double start_s_ = 0.0;
    double interval_s_ = 1.0;
    std::vector<double> samples_;
};

/// Motion of a body from its world position and roll, pitch and yaw; the rotation is Rz(yaw)
/// Ry(pitch) Rx(roll). Positive pitch is downward (REP-103).
[[nodiscard]] MotionState motion_state(const std::array<Jet, 3>& position_m,
                                       const std::array<Jet, 3>& roll_pitch_yaw_rad);

}  // namespace surefoot::sim
