// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/flights/flights.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/angles.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kRiser_m = 0.17;
constexpr double kGoing_m = 0.3;

/// Edge of step k of a flight along +x from x = 1. It reaches from `right_m` to `left_m` across the
/// flight and is turned about its middle.
Edge step(int k, double right_m = -0.6, double left_m = 0.6, double turn_deg = 0.0) {
    const Vector2d middle_m(1.0 + k * kGoing_m, 0.5 * (right_m + left_m));
    const double turn_rad = turn_deg * kRadPerDeg;
    const Vector2d half_m =
        0.5 * (left_m - right_m) * Vector2d(std::sin(turn_rad), -std::cos(turn_rad));
    Edge edge;  // the lower ground on the right hand: from +y to -y
    edge.from_m = middle_m - half_m;
    edge.to_m = middle_m + half_m;
    edge.lower_m = k * kRiser_m;
    edge.upper_m = (k + 1) * kRiser_m;
    edge.lower_seen = edge.lower_walkable = true;
    edge.log_step_ratio = 20.0;
    edge.height_sigma_m = 0.003;
    edge.across_sigma_m = 0.005;
    edge.upper_depth_m = edge.lower_depth_m = kGoing_m;
    return edge;
}

TEST(FlightFinder, LongerPiecesOfAStepMakeItLonger) {
    const FlightFinder finder{StairsConfig{}};
    std::vector<Edge> chain{step(0, 0.2, 0.55), step(1), step(2)};
    std::vector<Edge> edges{step(0, -0.6, 0.6, 3.0), step(3, -0.6, 0.6, 40.0), step(0)};
    edges[2].upper_m += 0.1;  // an object on the tread
    finder.lengthen(chain, edges);
    ASSERT_EQ(chain.size(), 3U);
    EXPECT_NEAR(chain[0].length_m(), 1.2, 0.02);
    EXPECT_NEAR(chain[0].middle_m().y(), 0.0, 0.02);
    ASSERT_EQ(edges.size(), 2U) << "what is turned is no step of it, nor what is higher";
    EXPECT_NEAR(edges[0].lower_m, 3 * kRiser_m, 1e-9);
}

TEST(FlightFinder, NextStepsAreTakenAtBothEnds) {
    const FlightFinder finder{StairsConfig{}};
    std::vector<Edge> chain{step(2), step(3)};
    std::vector<Edge> edges{step(5), step(0), step(4), step(1)};  // in no order
    finder.lengthen(chain, edges);
    EXPECT_TRUE(edges.empty());
    ASSERT_EQ(chain.size(), 6U);
    for (int k = 0; k < 6; ++k)
        EXPECT_NEAR(chain[static_cast<std::size_t>(k)].middle_m().x(), 1.0 + k * kGoing_m, 1e-9);
}

TEST(FlightFinder, WhatIsNoNextStepIsLeft) {
    const FlightFinder finder{StairsConfig{}};
    const auto is_left = [&](const Edge& edge) {
        std::vector<Edge> chain{step(0), step(1)};
        std::vector<Edge> edges{edge};
        finder.lengthen(chain, edges);
        return chain.size() == 2 && edges.size() == 1;
    };
    EXPECT_FALSE(is_left(step(2)));
    EXPECT_FALSE(is_left(step(2, -0.6, 0.6, 12.0)));
    EXPECT_TRUE(is_left(step(2, -0.6, 0.6, 20.0))) << "turned";
    EXPECT_TRUE(is_left(step(3))) << "one is missing between them";
    EXPECT_TRUE(is_left(step(2, 0.65, 1.6))) << "beside them";
    Edge edge = step(2);
    edge.from_m.x() += 0.3 * kGoing_m;
    edge.to_m.x() += 0.3 * kGoing_m;
    EXPECT_TRUE(is_left(edge)) << "another going";
    edge = step(2);
    edge.lower_m += 0.06;
    EXPECT_TRUE(is_left(edge)) << "from another level";
    edge = step(2);
    edge.upper_m += 0.2;
    EXPECT_TRUE(is_left(edge)) << "too high for a step";
    std::vector<Edge> one{step(0)};
    std::vector<Edge> edges{step(1)};
    finder.lengthen(one, edges);
    EXPECT_EQ(one.size(), 1U) << "one step says nothing of the goings";
}

/// Along the side of a ramp or platform the path does not cross the edge.
TEST(FlightFinder, ASingleStepLiesStraightAhead) {
    FlightFinder finder{StairsConfig{}};
    std::vector<bool> used;
    const auto flights = [&](const Edge& edge, double stance_y_m) {
        std::vector<Flight> found;
        finder.find({&edge, 1}, {0.0, stance_y_m}, found, used);
        return found.size();
    };
    EXPECT_EQ(flights(step(0), 0.0), 1U);
    EXPECT_EQ(flights(step(0), 0.8), 1U) << "nearly: 0.2 m beyond its end";
    EXPECT_EQ(flights(step(0), 0.9), 0U);
    EXPECT_EQ(flights(step(0), -0.9), 0U);
}

}  // namespace
}  // namespace surefoot::stairs
