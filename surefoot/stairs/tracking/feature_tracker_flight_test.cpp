// SPDX-License-Identifier: Apache-2.0
// Flights of stairs over many observations.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/stairs/tracking/feature_tracker.hpp"
#include "surefoot/stairs/tracking/feature_tracker_testing.hpp"
#include "surefoot/stairs/tracking/robust_mean.hpp"

namespace surefoot::stairs::testing {
namespace {

TEST(FeatureTracker, whether_a_riser_is_open_is_what_the_last_look_says) {
    Observations observations;
    Flight boards = flight_up(2);
    observations.observation(flight_found(boards));
    boards.open = true;
    for (Edge& edge : boards.edges) edge.open = true;
    for (int k = 0; k < 12; ++k) observations.observation(flight_found(boards));
    ASSERT_EQ(observations.out().flights.size(), 1U);
    EXPECT_TRUE(observations.out().flights[0].open);
    ASSERT_EQ(observations.out().edges.size(), 2U);
    for (const Edge& edge : observations.out().edges) EXPECT_TRUE(edge.open);
}

TEST(FeatureTracker, a_turning_spiral_keeps_the_ids_of_its_steps) {
    Observations observations;
    Rng rng(4);
    constexpr int kSteps = 6;
    std::vector<std::uint32_t> ids;
    for (int k = 0; k < 40; ++k) {
        Flight flight;
        flight.steps = kSteps;
        flight.riser_m = 0.18 + 0.001 * rng.normal();
        flight.riser_sigma_m = 0.001;
        flight.going_m = 0.28 + 0.003 * rng.normal();
        flight.going_sigma_m = 0.003;
        for (int step = 0; step < kSteps; ++step) {
            // Treads of 30 deg around a pole at (0.5, 1.2), from 0.3 to 1.2 m from it.
            const double angle_rad = (-90.0 + 30.0 * step) * kRadPerDeg + 0.02 * rng.normal();
            const Eigen::Vector2d out(std::cos(angle_rad), std::sin(angle_rad));
            Edge edge;
            edge.from_m = Eigen::Vector2d(0.5, 1.2) + 0.3 * out;
            edge.to_m = Eigen::Vector2d(0.5, 1.2) + 1.2 * out;
            edge.lower_m = 0.18 * step;
            edge.upper_m = 0.18 * (step + 1) + 0.003 * rng.normal();
            edge.lower_seen = true;
            edge.height_sigma_m = 0.004;
            edge.across_sigma_m = 0.01;
            edge.angle_sigma_rad = 0.03;
            flight.edges.push_back(edge);
        }
        const auto& told = observations.observation(flight_found(flight));
        ASSERT_EQ(told.edges.size(), 6U) << k;
        ASSERT_EQ(told.flights.size(), 1U) << k;
        std::vector<std::uint32_t> now = {told.flights[0].tracked.id};
        for (const Edge& edge : told.flights[0].edges) now.push_back(edge.tracked.id);
        if (k == 0) ids = now;
        EXPECT_EQ(now, ids) << k;
        EXPECT_NEAR(told.flights[0].turn_rad, 150.0 * kRadPerDeg, 0.1);
    }
}

TEST(FeatureTracker, the_number_of_steps_does_not_flicker_but_follows_what_stays) {
    Observations observations;
    observations.observation(flight_found(flight_up(5)));
    for (int k = 0; k < 60; ++k) {
        observations.observation(flight_found(flight_up(k % 2 == 0 ? 6 : 5)));
        ASSERT_EQ(observations.out().flights.size(), 1U) << k;
        EXPECT_EQ(observations.out().flights[0].steps, 5) << k;
        EXPECT_EQ(observations.out().flights[0].edges.size(), 5U);
    }
    int changes = 0;
    for (int k = 0, before = 5; k < 30; ++k) {
        observations.observation(flight_found(flight_up(6)));
        changes += observations.out().flights.at(0).steps != before ? 1 : 0;
        before = observations.out().flights.at(0).steps;
    }
    EXPECT_EQ(changes, 1);
    EXPECT_EQ(observations.out().flights.at(0).steps, 6);
    EXPECT_EQ(observations.out().flights.at(0).edges.size(), 6U);
}

/// Observations often break a flight where it is seen worst.
TEST(FeatureTracker, the_far_end_of_a_flight_is_no_flight_of_its_own) {
    const auto told = [](double beyond_m, double turn_m, int near_steps = 4) {
        const Flight near = flight_up(near_steps);
        Flight far = flight_up(2, 1.0 + 4 * 0.3 + beyond_m);
        far.pose.p_m.z() = 4 * 0.18;
        for (Edge& edge : far.edges) {
            edge.upper_m += 4 * 0.18;
            edge.lower_m += 4 * 0.18;
            edge.from_m.x() += turn_m;
            edge.to_m.x() -= turn_m;
        }
        TerrainFeatures found = flight_found(near);
        found.edges.insert(found.edges.end(), far.edges.begin(), far.edges.end());
        found.flights.push_back(far);
        Observations observations;
        observations.observe_nothing();
        for (int k = 0; k < 4; ++k) observations.observation(found);
        std::vector<int> steps;
        for (const Flight& flight : observations.out().flights) {
            EXPECT_EQ(flight.edges.size(), static_cast<std::size_t>(flight.steps));
            steps.push_back(flight.steps);
        }
        return steps;
    };
    EXPECT_EQ(told(0.0, 0.0), std::vector<int>({6}));
    EXPECT_EQ(told(0.1, 0.02), std::vector<int>({6}));
    EXPECT_EQ(told(0.0, 0.0, 5), std::vector<int>({6})) << "both have its fifth step";
    EXPECT_EQ(told(0.0, 0.0, 3), std::vector<int>({3, 2})) << "nobody has its fourth step";
    EXPECT_EQ(told(0.6, 0.0), std::vector<int>({4, 2})) << "a landing between them";
    EXPECT_EQ(told(0.0, 0.3), std::vector<int>({4, 2})) << "another way";
}

TEST(FeatureTracker, a_flight_is_as_its_best_looks_say) {
    Observations observations;
    Flight far = flight_up(4, 1.0, 0.195);
    far.riser_sigma_m = 0.01;
    far.going_m = 0.34;
    far.going_sigma_m = 0.02;
    for (int k = 0; k < 30; ++k) observations.observation(flight_found(far));
    Flight near = flight_up(4, 1.0, 0.180);
    for (int k = 0; k < 5; ++k) observations.observation(flight_found(near));
    observations.observation(flight_found(far));
    const Flight& told = observations.out().flights.at(0);
    EXPECT_NEAR(told.riser_m, 0.180, 0.002);
    EXPECT_NEAR(told.going_m, 0.300, 0.004);
    EXPECT_GE(told.riser_sigma_m, 0.001);
    EXPECT_GE(told.going_sigma_m, 0.002);
    EXPECT_EQ(told.tracked.observations, 36);
}

TEST(FeatureTracker, what_a_look_does_not_see_beside_a_flight_stays_as_it_was) {
    Observations observations;
    Flight flight = flight_up(4);
    flight.left = {SideKind::wall, 0.0};
    flight.right = {SideKind::open, 0.95};
    observations.observation(flight_found(flight));
    flight.left = {SideKind::unknown, 0.0};
    flight.right = {SideKind::level, 0.0};
    observations.observation(flight_found(flight));
    EXPECT_EQ(observations.out().flights.at(0).left.kind, SideKind::wall);
    EXPECT_EQ(observations.out().flights.at(0).right.kind, SideKind::level);
    EXPECT_EQ(observations.out().flights.at(0).right.rail_m, 0.0);
}

TEST(FeatureTracker, goings_that_scatter_are_a_mean_of_many_looks) {
    double square = 0.0;
    constexpr int kRuns = 40;
    for (int run = 0; run < kRuns; ++run) {
        Rng rng(static_cast<std::uint64_t>(100 + run));
        Observations observations;
        for (int k = 0; k < 40; ++k) {
            Flight flight = flight_up(4);
            flight.going_sigma_m = 0.008;
            flight.going_m = 0.3 + flight.going_sigma_m * rng.normal();
            observations.observation(flight_found(flight));
        }
        square += std::pow(observations.out().flights.at(0).going_m - 0.3, 2) / kRuns;
    }
    EXPECT_NEAR(std::sqrt(square), 0.008 / std::sqrt(RobustMean::kMostObservations), 0.0004);
}

TEST(FeatureTracker, a_flight_comes_with_its_second_look_and_stays_when_it_is_out_of_sight) {
    Observations observations;
    observations.observe_nothing();
    const TerrainFeatures found = flight_found(flight_up(3));
    EXPECT_TRUE(observations.observation(found).flights.empty());
    EXPECT_EQ(observations.observation(found).flights.size(), 1U);
    Drift drift;
    drift.horizontal_var_m2 = 1e-6;
    for (int k = 0; k < 100; ++k) observations.observation({}, drift);
    ASSERT_EQ(observations.out().flights.size(), 1U);
    EXPECT_FALSE(observations.out().flights[0].tracked.seen_now);
    EXPECT_EQ(observations.out().flights[0].tracked.last_seen_ns, 300'000'000);
    EXPECT_NEAR(observations.out().flights[0].edges[0].across_sigma_m,
                std::sqrt(kSigma_m * kSigma_m + 1e-4),
                1e-9);
}

TEST(FeatureTracker, a_flight_that_looks_at_its_place_do_not_find_goes) {
    Observations observations([](double, double) { return 0.0; });
    const TerrainFeatures found = flight_found(flight_up(3));
    observations.observation(found);
    observations.observation(found);
    int told = 0;
    for (int k = 0; k < 50; ++k)
        told += static_cast<int>(observations.observation({}).flights.size());
    EXPECT_GE(told, TrackingConfig{}.level_observations - 1);
    EXPECT_LE(told, TrackingConfig{}.missed_observations);
}

TEST(FeatureTracker, edges_that_looks_no_longer_call_a_flight_are_none_after_some_looks) {
    const Flight flight = flight_up(3);
    Observations unknown;
    Observations known([](double, double) { return 0.0; });
    for (Observations* observations : {&unknown, &known}) {
        for (int k = 0; k < 3; ++k) observations->observation(flight_found(flight));
        for (int k = 1; k < TrackingConfig{}.missed_observations; ++k)
            EXPECT_EQ(observations->observation(edges_found(flight.edges)).flights.size(), 1U) << k;
        observations->observation(edges_found(flight.edges));
    }
    EXPECT_EQ(unknown.out().flights.size(), 1U);
    EXPECT_TRUE(known.out().flights.empty());
    EXPECT_EQ(known.out().edges.size(), 3U);
}

}  // namespace
}  // namespace surefoot::stairs::testing
