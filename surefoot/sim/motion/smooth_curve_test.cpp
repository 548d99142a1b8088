// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/smooth_curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/rng.hpp"
#include "surefoot/sim/motion/motion_checks.hpp"

namespace surefoot::sim {
namespace {

/// Any motion that a function of time gives.
template <typename F>
class FunctionMotion final : public Motion {
  public:
    explicit FunctionMotion(F f) : f_(f) {}
    [[nodiscard]] MotionState at(double time_s) const override { return f_(time_s); }
    [[nodiscard]] double duration_s() const override { return 10.0; }

  private:
    F f_;
};

TEST(SmoothCurveTest, RestsOnItsFirstAndLastSample) {
    const SmoothCurve curve(2.0, 0.5, {3.0, -1.0, 4.0, 1.0, 5.0});
    const double end_s = 2.0 + 6 * 0.5;
    for (const double t_s : {-7.0, 2.0}) EXPECT_NEAR(curve.at(t_s).value, 3.0, 1e-15);
    for (const double t_s : {end_s, 99.0}) EXPECT_NEAR(curve.at(t_s).value, 5.0, 1e-15);
    for (const double t_s : {2.0, end_s}) {
        EXPECT_NEAR(curve.at(t_s).rate, 0.0, 1e-12);
        EXPECT_NEAR(curve.at(t_s).acceleration, 0.0, 1e-12);
    }
}

TEST(SmoothCurveTest, FollowsALineExactlyAndStaysWithinItsNeighbours) {
    std::vector<double> line;
    for (int i = 0; i < 12; ++i) line.push_back(0.3 * i - 1.0);
    const SmoothCurve straight(0.0, 0.1, line);
    const SmoothCurve spike(0.0, 1.0, {0.0, 0.0, 0.0, 6.0, 0.0, 0.0, 0.0});
    // Sample i stands at (i + 1) intervals; away from the ends a B-spline reproduces lines.
    for (double t_s = 0.3; t_s < 1.0; t_s += 0.017) {
        const Jet now = straight.at(t_s);
        EXPECT_NEAR(now.value, 0.3 * (t_s / 0.1 - 1.0) - 1.0, 1e-12) << "at " << t_s;
        EXPECT_NEAR(now.rate, 3.0, 1e-9) << "at " << t_s;
        EXPECT_NEAR(now.acceleration, 0.0, 1e-8) << "at " << t_s;
    }
    EXPECT_NEAR(spike.at(4.0).value, 4.0, 1e-12) << "weights 1 4 1 over 6";
    EXPECT_NEAR(spike.at(3.0).value, 1.0, 1e-12);
}

TEST(SmoothCurveTest, DerivativesMatchFiniteDifferences) {
    Rng rng(5);
    const auto curve = [&] {
        std::vector<double> samples;
        for (int i = 0; i < 40; ++i) samples.push_back(rng.uniform(-1.0, 1.0));
        return SmoothCurve(0.0, 0.25, samples);
    };
    const SmoothCurve x = curve();
    const SmoothCurve y = curve();
    const SmoothCurve roll = curve();
    const SmoothCurve pitch = curve();
    const SmoothCurve yaw = curve();
    const FunctionMotion motion([&](double t_s) {
        const Jet wave = oscillation(0.7, 3.0, 0.4, t_s);
        return motion_state({x.at(t_s), y.at(t_s) * wave, 2.0 * wave + x.at(t_s)},
                            {roll.at(t_s), pitch.at(t_s), yaw.at(t_s) + wave});
    });
    // Third derivatives stay below 8 / 0.25^3 = 512 per s^3, and a tenth of that for most of the
    // time: a kink of the second derivative costs half a step of it, 512 * 5e-5.
    const DerivativeErrors worst = derivative_errors(motion, 0.01, 10.0);
    EXPECT_LT(worst.velocity_m_s, 1e-5);
    EXPECT_LT(worst.acceleration_m_s2, 0.026);
    EXPECT_LT(worst.turn_rad_s, 1e-4);
    EXPECT_LT(worst.turn_acceleration_rad_s2, 0.1);
}

TEST(SmoothCurveTest, EasedRisesFromRestToRest) {
    EXPECT_EQ(eased(-1.0), 0.0);
    EXPECT_EQ(eased(2.0), 1.0);
    EXPECT_EQ(eased(0.5), 0.5);
    EXPECT_LT(eased(1e-3), 1.1e-8) << "starts like 10 u^3";
    for (double u = 0.0; u < 1.0; u += 0.01) EXPECT_LT(eased(u), eased(u + 0.01));
}

}  // namespace
}  // namespace surefoot::sim
