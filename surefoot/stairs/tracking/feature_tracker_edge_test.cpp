// SPDX-License-Identifier: Apache-2.0
// Edges keep their ids over many observations.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/stairs/tracking/feature_tracker_testing.hpp"

namespace surefoot::stairs::testing {
namespace {

TEST(FeatureTracker, an_edge_in_noise_keeps_its_id_and_is_steadier_but_no_surer_than_a_look) {
    Observations observations;
    Rng rng(1);
    std::set<std::uint32_t> ids;
    double observe_square = 0.0, told_square = 0.0;
    for (int k = 0; k < 200; ++k) {
        const double off_m = kSigma_m * rng.normal();
        const auto& told = observations.observation(edges_found({edge_ahead(1.0 + off_m)}));
        ASSERT_EQ(told.edges.size(), 1U) << k;
        ids.insert(told.edges[0].tracked.id);
        EXPECT_GE(told.edges[0].across_sigma_m, kSigma_m);
        EXPECT_GE(told.edges[0].height_sigma_m, kSigma_m);
        EXPECT_EQ(told.edges[0].tracked.observations, k + 1);
        if (k < 20) continue;
        observe_square += off_m * off_m;
        told_square += std::pow(told.edges[0].middle_m().x() - 1.0, 2);
    }
    EXPECT_EQ(ids.size(), 1U);
    EXPECT_LT(told_square, 0.25 * observe_square);
}

TEST(FeatureTracker, looks_that_miss_a_thing_leave_no_gap) {
    Observations observations;
    const TerrainFeatures found = edges_found({edge_ahead(1.0)});
    observations.observation(found);
    const std::uint32_t id = observations.out().edges.at(0).tracked.id;
    for (int k = 0; k < 30; ++k) {
        const bool seen = k % 3 == 0;
        const auto& told = observations.observation(seen ? found : TerrainFeatures{});
        ASSERT_EQ(told.edges.size(), 1U) << k;
        EXPECT_EQ(told.edges[0].tracked.id, id);
        EXPECT_EQ(told.edges[0].tracked.seen_now, seen);
        EXPECT_EQ(told.edges[0].tracked.last_seen_ns == observations.time_ns(), seen);
        EXPECT_EQ(told.time_ns, observations.time_ns());
    }
}

TEST(FeatureTracker, two_near_parallel_edges_do_not_swap_their_ids) {
    Observations observations;
    Rng rng(2);
    std::uint32_t lower_id = 0, upper_id = 0;
    for (int k = 0; k < 100; ++k) {
        const auto noise = [&] { return 0.02 * rng.normal(); };
        std::vector<Edge> edges = {edge_ahead(1.15 + noise(), 0.0, -0.09),
                                   edge_ahead(1.00 + noise(), 0.09, 0.0)};
        for (Edge& edge : edges) edge.across_sigma_m = 0.02;
        if (k % 2 == 0) std::swap(edges[0], edges[1]);
        if (k % 5 == 3) edges.pop_back();
        const auto& told = observations.observation(edges_found(edges));
        ASSERT_EQ(told.edges.size(), 2U) << k;
        const bool first_is_upper = told.edges[0].upper_m > told.edges[1].upper_m;
        const Edge& upper = told.edges[first_is_upper ? 0 : 1];
        const Edge& lower = told.edges[first_is_upper ? 1 : 0];
        if (k == 0) {
            upper_id = upper.tracked.id;
            lower_id = lower.tracked.id;
        }
        EXPECT_EQ(upper.tracked.id, upper_id) << k;
        EXPECT_EQ(lower.tracked.id, lower_id) << k;
        EXPECT_NEAR(upper.upper_m, 0.09, 0.02);
        EXPECT_NEAR(lower.upper_m, 0.0, 0.02);
    }
}

TEST(FeatureTracker, heights_tell_steps_apart_where_the_machine_has_drifted_by_a_step) {
    Observations observations;
    const auto steps_from = [](double at_m) {
        return edges_found({edge_ahead(at_m, 0.0, -0.09), edge_ahead(at_m - 0.15, 0.09, 0.0)});
    };
    const auto id_of_upper = [&] {
        for (const Edge& edge : observations.out().edges)
            if (edge.upper_m > 0.045) return edge.tracked.id;
        return 0U;
    };
    observations.observation(steps_from(1.0));
    const std::uint32_t id = id_of_upper();
    Drift drift;
    drift.horizontal_var_m2 = 0.01;
    observations.observation(steps_from(1.15), drift);
    ASSERT_EQ(observations.out().edges.size(), 2U);
    for (const Edge& edge : observations.out().edges) EXPECT_EQ(edge.tracked.observations, 2);
    EXPECT_EQ(id_of_upper(), id);
}

TEST(FeatureTracker, the_two_sides_of_a_gutter_stay_two_edges) {
    Observations observations;
    Edge far = edge_ahead(1.06);
    std::swap(far.from_m, far.to_m);  // falls back towards the stance
    for (int k = 0; k < 20; ++k)
        EXPECT_EQ(observations.observation(edges_found({edge_ahead(1.0), far})).edges.size(), 2U)
            << k;
    for (int k = 0; k < 20; ++k)
        EXPECT_EQ(observations.observation(edges_found({edge_ahead(1.0)})).edges.size(), 2U) << k;
}

TEST(FeatureTracker, an_edge_that_is_no_drop_and_is_found_once_is_not_told) {
    Observations observations([](double, double) { return 0.0; });
    observations.observe_nothing();
    EXPECT_TRUE(observations.observation(edges_found({edge_ahead(1.0)})).edges.empty());
    for (int k = 0; k < 20; ++k) EXPECT_TRUE(observations.observation({}).edges.empty());
    // The track of the edge is gone, so this is a first observation again.
    EXPECT_TRUE(observations.observation(edges_found({edge_ahead(1.0)})).edges.empty());
    EXPECT_EQ(observations.observation(edges_found({edge_ahead(1.0)})).edges.size(), 1U);
}

TEST(FeatureTracker, an_edge_in_two_pieces_is_one) {
    Observations observations;
    observations.observation(edges_found({edge_ahead(1.0, 0.0, -0.2, 0.8)}));
    const std::uint32_t id = observations.out().edges.at(0).tracked.id;
    Edge left = edge_ahead(1.0, 0.0, -0.2, 0.3);
    Edge right = left;
    left.from_m.y() += 0.5;
    left.to_m.y() += 0.5;
    right.from_m.y() -= 0.5;
    right.to_m.y() -= 0.5;
    for (int k = 0; k < 10; ++k) observations.observation(edges_found({left, right}));
    ASSERT_EQ(observations.out().edges.size(), 1U);
    EXPECT_EQ(observations.out().edges[0].tracked.id, id);
    EXPECT_NEAR(observations.out().edges[0].length_m(), 1.6, 0.02);
}

}  // namespace
}  // namespace surefoot::stairs::testing
