// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/stairs/feature_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace surefoot::eval {
namespace {

using stairs::TerrainFeatures;

stairs::LineFeature line_at(double x_m, double y_m, double yaw_rad, double height_m) {
    stairs::LineFeature line;
    line.pose = {{x_m, y_m, 0.0}, yaw_rad};
    line.height_m = height_m;
    return line;
}

stairs::Flight flight_at(double x_m, int steps, double riser_m, double going_m) {
    stairs::Flight flight;
    flight.pose = {{x_m, 0.0, 0.0}, 0.0};
    flight.steps = steps;
    flight.riser_m = riser_m;
    flight.going_m = going_m;
    flight.width_m = 1.2;
    return flight;
}

TEST(FeatureErrors, OfLinesAreAcrossTheTrueLine) {
    TerrainFeatures truth;
    truth.kerbs = {line_at(2.0, 1.0, 0.5 * std::numbers::pi, 0.10)};
    TerrainFeatures found;
    // The way over it is +y: 30 mm too far, 200 mm beside it.
    found.kerbs = {line_at(2.2, 1.03, 0.5 * std::numbers::pi + 0.1, 0.112)};
    const FeatureErrors errors = feature_errors(found, truth, {});
    EXPECT_EQ(errors.kerbs.matched, 1U);
    EXPECT_EQ(errors.kerbs.recall(), 1.0);
    EXPECT_EQ(errors.kerbs.precision(), 1.0);
    EXPECT_NEAR(errors.kerbs.across.mean_m, 0.03, 1e-12);
    EXPECT_NEAR(errors.kerbs.height.mean_m, 0.012, 1e-12);
    EXPECT_EQ(errors.kerbs.height.std_m, 0.0);
    EXPECT_TRUE(std::isnan(errors.drops.recall()));
    EXPECT_TRUE(std::isnan(errors.drops.height.mean_m));
}

TEST(FeatureErrors, LimitsOfAMatch) {
    TerrainFeatures truth;
    truth.drops = {line_at(1.0, 0.0, 0.0, -0.2)};
    const auto matches = [&](const stairs::LineFeature& line) {
        TerrainFeatures found;
        found.drops = {line};
        const FeatureErrors errors = feature_errors(found, truth, {});
        EXPECT_EQ(errors.drops.missed.size(), 1 - errors.drops.matched);
        EXPECT_EQ(errors.drops.extra.size(), 1 - errors.drops.matched);
        return errors.drops.matched == 1;
    };
    EXPECT_TRUE(matches(line_at(1.149, 0.0, 0.0, -0.2)));
    EXPECT_FALSE(matches(line_at(1.151, 0.0, 0.0, -0.2)));
    EXPECT_TRUE(matches(line_at(1.0, -0.499, 0.0, -0.2)));
    EXPECT_FALSE(matches(line_at(1.0, -0.501, 0.0, -0.2)));
    EXPECT_TRUE(matches(line_at(1.0, 0.0, -0.349, -0.2)));
    EXPECT_FALSE(matches(line_at(1.0, 0.0, 0.351, -0.2)));
    EXPECT_TRUE(matches(line_at(1.0, 0.0, 2.0 * std::numbers::pi, -0.2)));
    // An upward flight does not match a downward one, and the opposite direction over a line is a
    // different feature.
    EXPECT_FALSE(matches(line_at(1.0, 0.0, 0.0, 0.2)));
    EXPECT_FALSE(matches(line_at(1.0, 0.0, std::numbers::pi, -0.2)));
}

TEST(FeatureErrors, EachIsInOnePairTheNearestFirst) {
    TerrainFeatures truth;
    truth.kerbs = {line_at(1.0, 0.0, 0.0, 0.1), line_at(1.1, 0.0, 0.0, 0.2)};
    TerrainFeatures found;
    found.kerbs = {
        line_at(1.07, 0.0, 0.0, 0.2), line_at(1.09, 0.0, 0.0, 0.2), line_at(1.2, 0.3, 0.0, 0.3)};
    const FeatureErrors errors = feature_errors(found, truth, {});
    // 1.09 goes to 1.1; then 1.07 to 1.0, and what is left has nothing.
    EXPECT_EQ(errors.kerbs.matched, 2U);
    EXPECT_NEAR(errors.kerbs.across.max_abs_m, 0.07, 1e-12);
    ASSERT_EQ(errors.kerbs.extra.size(), 1U);
    EXPECT_EQ(errors.kerbs.extra.front().p_m.x(), 1.2);
    EXPECT_TRUE(errors.kerbs.missed.empty());
    EXPECT_NEAR(errors.kerbs.precision(), 2.0 / 3.0, 1e-12);
}

TEST(FeatureErrors, OfFlights) {
    TerrainFeatures truth;
    truth.flights = {flight_at(1.0, 5, 0.17, 0.29),
                     flight_at(4.0, 1, 0.15, std::nan("")),
                     flight_at(8.0, 3, 0.17, 0.28)};
    truth.flights[2].kind = stairs::FlightKind::down;
    TerrainFeatures found;
    found.flights = {flight_at(1.02, 5, 0.172, 0.285),
                     flight_at(4.01, 2, 0.149, 0.3),
                     flight_at(8.0, 3, 0.17, 0.28)};
    const FeatureErrors errors = feature_errors(found, truth, {});
    EXPECT_EQ(errors.flights.truth, 3U);
    EXPECT_EQ(errors.flights.matched, 2U);  // one leads down and was found to lead up
    EXPECT_EQ(errors.flights.steps_right, 1U);
    EXPECT_EQ(errors.flights.height.count, 2U);
    EXPECT_NEAR(errors.flights.height.mean_m, 0.0005, 1e-12);
    EXPECT_NEAR(errors.flights.height.std_m, 0.0015, 1e-12);
    EXPECT_EQ(errors.flights.going.count, 1U);  // one step has none
    EXPECT_NEAR(errors.flights.going.mean_m, -0.005, 1e-12);
    EXPECT_EQ(errors.flights.width.count, 2U);
}

TEST(FeatureErrors, DoorsLeadBothWays) {
    stairs::Door door;
    door.pose = {{3.0, 0.0, 0.0}, 0.1};
    door.width_m = 0.9;
    door.sill_m = 0.02;
    TerrainFeatures truth;
    truth.doors = {door};
    TerrainFeatures found = truth;
    found.doors[0].pose.yaw_rad += std::numbers::pi;
    found.doors[0].width_m = 0.92;
    const FeatureErrors errors = feature_errors(found, truth, {});
    EXPECT_EQ(errors.doors.matched, 1U);
    EXPECT_NEAR(errors.doors.width.mean_m, 0.02, 1e-12);
    EXPECT_EQ(errors.doors.height.mean_m, 0.0);
}

TEST(FeatureErrors, HeightsThatAreBoundsDoNotCount) {
    TerrainFeatures truth;
    truth.drops = {line_at(1.0, 0.0, 0.0, -0.2)};
    stairs::Edge edge;
    edge.from_m = {1.0, -1.0};
    edge.to_m = {1.0, 1.0};
    edge.upper_m = 0.2;
    edge.lower_seen = true;
    truth.edges = {edge};
    TerrainFeatures found = truth;
    found.drops[0].bottom_seen = false;
    found.drops[0].height_m = -0.1;
    std::swap(found.edges[0].from_m, found.edges[0].to_m);  // the lower ground on the other side
    FeatureErrors errors = feature_errors(found, truth, {});
    EXPECT_EQ(errors.drops.matched, 1U);
    EXPECT_EQ(errors.drops.height.count, 0U);
    EXPECT_EQ(errors.edges.matched, 0U);
    std::swap(found.edges[0].from_m, found.edges[0].to_m);
    found.edges[0].upper_m = 0.21;
    errors = feature_errors(found, truth, {});
    EXPECT_EQ(errors.edges.matched, 1U);
    EXPECT_NEAR(errors.edges.height.mean_m, 0.01, 1e-12);
    found.edges[0].lower_seen = false;
    EXPECT_EQ(feature_errors(found, truth, {}).edges.height.count, 0U);
}

}  // namespace
}  // namespace surefoot::eval
