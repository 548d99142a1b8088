// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/feature_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "surefoot/stairs/tracking/feature_tracker_testing.hpp"

namespace surefoot::stairs::testing {
namespace {

TEST(FeatureTracker, the_first_look_of_all_is_told_as_it_is) {
    Observations observations;
    const auto& told = observations.observation(flight_found(flight_up(3)));
    EXPECT_EQ(told.flights.size(), 1U);
    EXPECT_EQ(told.edges.size(), 3U);
    EXPECT_DOUBLE_EQ(told.flights.at(0).riser_m, 0.18);
    EXPECT_DOUBLE_EQ(told.flights.at(0).edges.at(1).from_m.x(), 1.3);
}

TEST(FeatureTracker, what_leaves_the_map_is_forgotten) {
    Observations observations;
    observations.observation(drop_found(edge_ahead(3.0)));  // the map ends at 2.5 m
    EXPECT_EQ(observations.out().drops.size(), 1U);
    EXPECT_TRUE(observations.observation({}).drops.empty());
}

TEST(FeatureTracker, kerbs_and_doors_come_with_their_second_look_and_stay_out_of_sight) {
    Observations observations;
    observations.observe_nothing();
    const Edge edge = edge_ahead(1.0, 0.03, 0.0);
    TerrainFeatures found = edges_found({edge});
    found.kerbs = {line_feature(edge, true)};
    Door door;
    door.pose.p_m << 1.5, 0.3, 0.0;
    door.width_m = 0.8;
    door.width_sigma_m = 0.01;
    found.doors = {door};
    found.sills = {line_feature(edge_ahead(1.5, 0.02, 0.0), true)};
    observations.observation(found);
    EXPECT_TRUE(observations.out().kerbs.empty() && observations.out().doors.empty() &&
                observations.out().sills.empty());
    found.doors[0].pose.p_m.x() += 0.05;
    found.doors[0].width_m = 0.84;
    observations.observation(found);
    for (int k = 0; k < 50; ++k) {
        ASSERT_EQ(observations.out().kerbs.size(), 1U) << k;
        ASSERT_EQ(observations.out().doors.size(), 1U) << k;
        ASSERT_EQ(observations.out().sills.size(), 1U) << k;
        EXPECT_NEAR(observations.out().doors[0].width_m, 0.82, 1e-6);
        EXPECT_NEAR(observations.out().doors[0].pose.p_m.x(), 1.525, 1e-6);
        EXPECT_EQ(observations.out().doors[0].tracked.seen_now, k == 0);
        observations.observation({});
    }
}

TEST(FeatureTracker, nothing_is_followed_over_a_motion_that_nobody_knows) {
    Observations observations;
    observations.observation(drop_found(edge_ahead(1.0)));
    const std::uint32_t id = observations.out().drops.at(0).tracked.id;
    Drift lost;
    lost.horizontal_var_m2 = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(observations.observation({}, lost).drops.empty());
    observations.observation(drop_found(edge_ahead(1.0)));
    EXPECT_GT(observations.out().drops.at(0).tracked.id, id);
    observations.tracker().forget();
    EXPECT_TRUE(observations.observation({}).drops.empty());
}

TEST(FeatureTracker, of_too_many_edges_drops_and_near_ones_stay) {
    Observations observations;
    TerrainFeatures found;
    for (int k = 0; k < 300; ++k) {
        const double x_m = 0.3 + 2.0 * k / 300.0;
        found.edges.push_back(edge_ahead(x_m, 0.1 * (k % 40), 0.1 * (k % 40) - 0.2));
        if (k >= 290) found.drops.push_back(line_feature(found.edges.back(), true));
    }
    for (int observation = 0; observation < 3; ++observation) {
        observations.observation(found);
        EXPECT_EQ(observations.out().edges.size(), EdgeTracker::kMaxEdges);
        EXPECT_EQ(observations.out().drops.size(), 10U);
        EXPECT_NEAR(observations.out().edges[0].middle_m().x(), 0.3, 1e-9);
        for (std::size_t i = 1; i < observations.out().edges.size(); ++i)
            EXPECT_GE(observations.out().edges[i].middle_m().x(),
                      observations.out().edges[i - 1].middle_m().x());
    }
}

TEST(FeatureTracker, numbers_that_are_none_do_no_harm) {
    const double nan = std::nan("");
    TerrainFeatures broken = flight_found(flight_up(2));
    broken.flights[0].riser_m = broken.flights[0].going_sigma_m = nan;
    broken.edges[0].from_m.x() = broken.flights[0].edges[0].from_m.x() = nan;
    broken.drops = {line_feature(broken.edges[0], true)};
    broken.doors.emplace_back();
    broken.doors[0].pose.p_m.setConstant(nan);
    broken.flights.emplace_back();  // a flight without edges
    Edge point = edge_ahead(1.0);
    point.to_m = point.from_m;
    broken.edges.push_back(point);
    Observations observations;
    for (int k = 0; k < 5; ++k) observations.observation(broken);
    for (const Edge& edge : observations.out().edges) {
        EXPECT_TRUE(edge.from_m.allFinite());
        EXPECT_GT(edge.length_m(), 0.0);
    }
    FeatureTracker tracker{TrackingConfig{}};
    TerrainFeatures out;
    Terrain nowhere;
    nowhere.stance_m.setConstant(nan);
    tracker.update(flight_found(flight_up(2)), nowhere, {}, out);
    tracker.update({}, nowhere, {}, out);
    EXPECT_TRUE(out.edges.empty());
}

}  // namespace
}  // namespace surefoot::stairs::testing
