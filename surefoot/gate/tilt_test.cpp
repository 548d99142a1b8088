// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/tilt.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "surefoot/core/angles.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

grid::MapSnapshot& map_with(std::uint32_t sigma_urad) {
    static const auto map = std::make_unique<grid::MapSnapshot>();
    map->tilt_sigma_urad = sigma_urad;
    return *map;
}

TEST(Tilt, TheBoundIsNeverBelowTheTangent) {
    GateLimits limits;
    limits.sigma_factor = 3.4;
    EXPECT_EQ(vertical_bound_tan(map_with(0), limits), 0.0);
    for (const std::uint32_t sigma_urad : {1U, 1000U, 24'435U, 147'000U}) {
        const double exact = std::tan(3.4e-6 * sigma_urad);
        EXPECT_GE(vertical_bound_tan(map_with(sigma_urad), limits), exact);
        EXPECT_LE(vertical_bound_tan(map_with(sigma_urad), limits), 1.04 * exact);
    }
    for (const std::uint32_t sigma_urad : {148'000U, grid::MapSnapshot::kUnknownTilt})
        EXPECT_TRUE(std::isinf(vertical_bound_tan(map_with(sigma_urad), limits)));
}

TEST(Tilt, AnglesAdd) {
    for (const double a_deg : {0.0, 2.0, 5.0}) {
        const double tan_sq = std::pow(std::tan(a_deg * kRadPerDeg), 2);
        EXPECT_EQ(steepest_tan_sq(tan_sq, 0.0), tan_sq) << "to the last bit";
        const double both = std::tan((a_deg + 4.0) * kRadPerDeg);
        EXPECT_NEAR(steepest_tan_sq(tan_sq, std::tan(4.0 * kRadPerDeg)), both * both, 1e-12);
    }
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(steepest_tan_sq(0.01, kInfinity), kInfinity);
    EXPECT_EQ(steepest_tan_sq(0.0, kInfinity), kInfinity);
    EXPECT_EQ(steepest_tan_sq(std::nan(""), 0.1), kInfinity);
}

/// Level ground, and a cross slope of 4 deg that a known vertical allows.
TEST(Tilt, AnUnsureVerticalCountsAgainstTheLimit) {
    const auto decision = [](double slope_deg, double sigma_deg) {
        Terrain terrain;
        for (int v = 0; v < 240; ++v)
            for (int u = 0; u < 240; ++u)
                terrain.height.at(u, v) = static_cast<float>(std::tan(slope_deg * kRadPerDeg) *
                                                             terrain.geometry.center_m({u, v}).y());
        terrain.input.tilt_sigma_rad = sigma_deg * kRadPerDeg;
        return ask(terrain, kForward);
    };
    EXPECT_EQ(decision(4.0, 0.1).decision, Decision::ok);
    EXPECT_EQ(decision(0.0, 1.4).decision, Decision::ok) << "4.76 deg of 6";
    const Verdict sloped = decision(4.0, 1.4);
    EXPECT_EQ(sloped.decision, Decision::not_traversable);
    EXPECT_TRUE(sloped.reasons.contains(Reason::slope)) << words(sloped);
    EXPECT_NEAR(std::atan(std::sqrt(sloped.evidence.max_tilt_tan_sq)) / kRadPerDeg, 8.8, 0.2);
    for (const double sigma_deg : {1.9, 30.0, std::nan("")}) {
        const Verdict unsure = decision(0.0, sigma_deg);
        EXPECT_EQ(unsure.decision, Decision::error) << sigma_deg;
        EXPECT_TRUE(unsure.reasons.contains(Reason::plane_invalid)) << words(unsure);
    }
}

}  // namespace
}  // namespace surefoot::gate::testing
