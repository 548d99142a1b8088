// SPDX-License-Identifier: Apache-2.0
// Slope and roughness under a landing foot.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/verdict_testing.hpp"
#include "surefoot/gate/verdict_text.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(Gate, slopes_up_to_the_limit_pass_and_beyond_are_refused) {
    const auto ramp = [](double deg) {
        Terrain terrain;
        for (int v = 0; v < 240; ++v) {
            for (int u = 0; u < 240; ++u) {
                const double y_m = terrain.geometry.center_m({u, v}).y();
                terrain.height.at(u, v) =
                    static_cast<float>(std::tan(deg * std::numbers::pi / 180.0) * y_m);
            }
        }
        return ask(terrain, kForward);
    };
    // Across the path: each foot stands 18 cm to the side, so only small angles keep the step
    // limits.
    expect_ok(ramp(4.0));
    const Verdict steep = ramp(8.0);
    EXPECT_EQ(steep.decision, Decision::not_traversable);
    EXPECT_TRUE(steep.reasons.contains(Reason::slope)) << words(steep);
}

TEST(Gate, slope_alone_is_a_reason_of_its_own) {
    // A wedge under the toes of the left foot: 7 deg, its middle at stance height.
    Terrain wedge;
    for (int v = 0; v < 240; ++v) {
        for (int u = 0; u < 240; ++u) {
            const Eigen::Vector2d c = wedge.geometry.center_m({u, v});
            if (c.x() > 0.26 && c.x() < 0.66 && c.y() > 0.05 && c.y() < 0.31)
                wedge.height.at(u, v) = static_cast<float>(std::tan(0.122) * (c.x() - 0.457));
        }
    }
    const Verdict verdict = ask(wedge, kForward);
    expect_refused(verdict, Reason::slope);
    // tan(0.122) = 0.1226, tan(6 deg) = 0.1051; 0.124 with the cells that only touch the foot.
    const std::string text = text_of(verdict, Query{}, rex());
    EXPECT_NE(text.find("ground sloping 12."), text.npos) << text;
    EXPECT_NE(text.find("(limit 10.5 %)"), text.npos) << text;
}

/// A ridge, 75 mm wide, across the middle of one landing foot: no drop, no step, no tilt.
Verdict ridge_under(double y0, double y1, double height_m, double sigma_m) {
    Terrain floor;
    floor.variance.fill(static_cast<float>(sigma_m * sigma_m));
    floor.box(0.425, 0.50, y0, y1, height_m);
    return ask(floor, kForward);
}

TEST(Gate, given_a_ridge_under_either_foot_then_roughness) {
    for (const bool left : {true, false}) {
        const Verdict verdict = ridge_under(left ? 0.05 : -0.30, left ? 0.30 : -0.05, 0.036, 0.001);
        expect_refused(verdict, Reason::roughness);
        EXPECT_EQ(verdict.reasons, ReasonSet(Reason::roughness)) << words(verdict);
        EXPECT_EQ(verdict.evidence.foot, left ? Foot::left : Foot::right);
        EXPECT_GT(verdict.evidence.value_tenth_mm, 250);
    }
}

TEST(Gate, the_noise_of_a_patch_counts_against_its_residual) {
    // Highest patch of a 20 mm ridge: about 16 mm over the plane; 3.4 sigma = 1.7 or 9.7 mm on top.
    expect_ok(ridge_under(0.05, 0.30, 0.020, 0.001));
    const Verdict noisy = ridge_under(0.05, 0.30, 0.020, 0.0057);
    EXPECT_EQ(noisy.reasons, ReasonSet(Reason::roughness)) << words(noisy);
    EXPECT_LE(noisy.evidence.value_tenth_mm, 250);
}

TEST(Gate, a_gentle_wedge_along_or_across_the_foot_is_a_plane_not_roughness) {
    constexpr double kGentle = 0.0875;  // tan 5 deg
    for (const double yaw : {0.0, std::numbers::pi / 2.0}) {
        for (const bool along : {true, false}) {
            Terrain wedge;
            // In the axes of the machine: under the left landing foot, its middle at stance height.
            for (int v = 0; v < 240; ++v) {
                for (int u = 0; u < 240; ++u) {
                    const Eigen::Vector2d c = wedge.geometry.center_m({u, v});
                    const double forward = std::cos(yaw) * c.x() + std::sin(yaw) * c.y();
                    const double left = std::cos(yaw) * c.y() - std::sin(yaw) * c.x();
                    if (forward < 0.26 || forward > 0.66 || left < 0.05 || left > 0.31) continue;
                    wedge.height.at(u, v) =
                        static_cast<float>(kGentle * (along ? forward - 0.457 : left - 0.18));
                }
            }
            const auto map = wedge.snapshot();
            const Query query = make_query(kForward, 0.0, 0.0, std::cos(yaw), std::sin(yaw));
            expect_ok(decide(rex(), query, *map, kReady, kNowNs));
            EXPECT_FALSE(HasFailure()) << "yaw " << yaw << (along ? " along" : " across");
        }
    }
}

}  // namespace
}  // namespace surefoot::gate::testing
