// SPDX-License-Identifier: Apache-2.0
// Drops are reported at once, and removed only when the ground there is seen to be level.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/stairs/tracking/feature_tracker.hpp"
#include "surefoot/stairs/tracking/feature_tracker_testing.hpp"

namespace surefoot::stairs::testing {
namespace {

TEST(FeatureTracker,
     a_drop_seen_once_is_told_at_once_and_kept_while_nothing_is_known_of_its_place) {
    Observations observations;
    observations.observe_nothing();
    observations.observation(drop_found(edge_ahead(1.0)));
    for (int k = 0; k < 200; ++k) {
        ASSERT_EQ(observations.out().drops.size(), 1U) << k;
        EXPECT_EQ(observations.out().edges.size(), 1U);
        EXPECT_EQ(observations.out().drops[0].tracked.seen_now, k == 0);
        EXPECT_EQ(observations.out().drops[0].tracked.id, observations.out().edges[0].tracked.id);
        EXPECT_EQ(observations.out().drops[0].pose.p_m.x(), 1.0);
        EXPECT_EQ(observations.out().drops[0].height_m, -0.2);
        observations.observation({});
    }
}

TEST(FeatureTracker, a_drop_that_the_map_knows_stays_when_it_is_not_found) {
    Observations observations([](double x_m, double) { return x_m < 1.0 ? 0.0 : -0.2; });
    observations.observation(drop_found(edge_ahead(1.0)));
    for (int k = 0; k < 100; ++k) EXPECT_EQ(observations.observation({}).drops.size(), 1U) << k;
}

TEST(FeatureTracker, a_drop_stays_one_when_looks_find_its_edge_and_call_it_none) {
    Observations observations;
    observations.observation(drop_found(edge_ahead(1.0)));
    for (int k = 0; k < 50; ++k) {
        observations.observation(edges_found({edge_ahead(1.0)}));
        ASSERT_EQ(observations.out().drops.size(), 1U) << k;
        EXPECT_TRUE(observations.out().drops[0].tracked.seen_now);
    }
}

TEST(FeatureTracker, the_part_of_a_drop_that_later_looks_miss_is_kept_unless_it_is_level) {
    Edge part = edge_ahead(1.0, 0.0, -0.2, 0.4);
    Observations unknown;
    Observations level([](double, double) { return 0.0; });
    for (Observations* observations : {&unknown, &level}) {
        observations->observation(drop_found(edge_ahead(1.0, 0.0, -0.2, 0.8)));
        for (int k = 0; k < 50; ++k) observations->observation(drop_found(part));
        ASSERT_EQ(observations->out().drops.size(), 1U);
    }
    EXPECT_NEAR(unknown.out().drops[0].length_m, 1.6, 1e-9);
    EXPECT_NEAR(level.out().drops[0].length_m, 0.8, 0.01);
}

TEST(FeatureTracker, what_is_not_seen_grows_as_unsure_as_the_machine_drifts) {
    Observations observations;
    observations.observation(drop_found(edge_ahead(2.0)));
    Drift drift;
    drift.horizontal_var_m2 = 9e-6;
    drift.yaw_var_rad2 = 4e-6;
    constexpr int kFrames = 50;
    for (int k = 0; k < kFrames; ++k) observations.observation({}, drift);
    ASSERT_EQ(observations.out().drops.size(), 1U);
    const double var_m2 = kSigma_m * kSigma_m + kFrames * (9e-6 + 2.0 * 2.0 * 4e-6);
    EXPECT_NEAR(observations.out().drops[0].across_sigma_m, std::sqrt(var_m2), 1e-9);
    EXPECT_NEAR(
        observations.out().edges.at(0).angle_sigma_rad, std::sqrt(1e-4 + kFrames * 4e-6), 1e-9);
    // After a new observation the drop has the sigma of this observation. It keeps its id although
    // it has moved.
    const std::uint32_t id = observations.out().drops[0].tracked.id;
    observations.observation(drop_found(edge_ahead(2.09)), drift);
    ASSERT_EQ(observations.out().drops.size(), 1U);
    EXPECT_EQ(observations.out().drops[0].tracked.id, id);
    EXPECT_LT(observations.out().drops[0].pose.p_m.x(), 2.09 + kSigma_m);
    EXPECT_GT(observations.out().drops[0].pose.p_m.x(), 2.07);
}

TEST(FeatureTracker, level_ground_seen_several_times_in_a_row_takes_a_drop_away) {
    Observations observations([](double, double) { return 0.0; });
    const int enough = TrackingConfig{}.level_observations;
    observations.observe_nothing();
    observations.observation(drop_found(edge_ahead(1.0)));
    for (int k = 1; k < enough; ++k) EXPECT_EQ(observations.observation({}).drops.size(), 1U) << k;
    observations.observation(drop_found(edge_ahead(1.0)));  // found again: the count restarts
    for (int k = 1; k < enough; ++k) EXPECT_EQ(observations.observation({}).drops.size(), 1U) << k;
    EXPECT_TRUE(observations.observation({}).drops.empty());
    EXPECT_TRUE(observations.out().edges.empty());
}

TEST(FeatureTracker, a_slope_seen_several_times_in_a_row_takes_a_drop_away_and_a_real_one_stays) {
    Observations slope([](double x_m, double) { return -0.5 * x_m; });
    Observations step([](double x_m, double) { return x_m < 1.0 ? 0.0 : -0.2; });
    const int enough = TrackingConfig{}.level_observations;
    for (Observations* observations : {&slope, &step}) {
        const double upper_m = observations == &slope ? -0.45 : 0.0;
        observations->observation(drop_found(edge_ahead(1.0, upper_m, upper_m - 0.1)));
        for (int k = 1; k < enough; ++k)
            EXPECT_EQ(observations->observation({}).drops.size(), 1U) << k;
        for (int k = 0; k < 20; ++k) observations->observation({});
    }
    EXPECT_TRUE(slope.out().drops.empty());
    EXPECT_EQ(step.out().drops.size(), 1U);
}

TEST(FeatureTracker, a_drop_whose_place_drifted_goes_only_where_all_of_that_place_is_level) {
    // The drop lies 0.18 m farther than remembered, within two sigma of the drift.
    Observations observations([](double x_m, double) { return x_m < 1.18 ? 0.0 : -0.2; });
    Edge edge = edge_ahead(1.0);
    edge.across_sigma_m = 0.1;
    observations.observation(drop_found(edge));
    for (int k = 0; k < 50; ++k) EXPECT_EQ(observations.observation({}).drops.size(), 1U) << k;
}

/// True if the reported drop begins at most one sigma farther away than the found one.
bool warns(const TerrainFeatures& told, const Edge& found) {
    return std::any_of(told.edges.begin(), told.edges.end(), [&](const Edge& edge) {
        const bool is_drop =
            std::any_of(told.drops.begin(), told.drops.end(), [&](const LineFeature& drop) {
                return drop.tracked.id == edge.tracked.id;
            });
        const auto covered = [&](const Eigen::Vector2d& p_m) {
            const double t_m = (p_m - edge.from_m).dot(edge.along());
            return t_m >= -0.02 && t_m <= edge.length_m() + 0.02 &&
                   edge.below_m(p_m) >= -found.across_sigma_m - 1e-9 && edge.below_m(p_m) < 0.3;
        };
        return is_drop && covered(found.from_m) && covered(found.to_m);
    });
}

TEST(FeatureTracker, a_drop_that_this_look_finds_is_never_missing_nor_farther_away) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Observations observations([](double, double) { return 0.0; });  // the map never agrees
        Rng rng(seed);
        for (int k = 0; k < 150; ++k) {
            if (rng.uniform() < 0.3) {
                observations.observation({});
                continue;
            }
            Edge edge = edge_ahead(1.0 + 0.04 * rng.normal(), 0.02 * rng.normal());
            const Eigen::Vector2d middle_m = edge.middle_m();
            const Eigen::Rotation2Dd turn(5.0 * kRadPerDeg * rng.normal());
            edge.from_m = middle_m + turn * (edge.from_m - middle_m) * (0.4 + rng.uniform());
            edge.to_m = middle_m + turn * (edge.to_m - middle_m) * (0.4 + rng.uniform());
            edge.across_sigma_m = 0.002 + 0.02 * rng.uniform();
            Edge piece = edge;  // another piece of the same edge
            piece.from_m = edge.to_m + 0.1 * edge.along();
            piece.to_m = piece.from_m + 0.4 * edge.along();
            TerrainFeatures found = drop_found(edge);
            if (rng.uniform() < 0.5) {
                found.edges.push_back(piece);
                found.drops.push_back(line_feature(piece, true));
            }
            observations.observation(found);
            for (std::size_t i = 0; i < found.drops.size(); ++i)
                EXPECT_TRUE(warns(observations.out(), found.edges[i]))
                    << seed << " " << k << " " << i;
        }
        EXPECT_LT(observations.out().drops.size(), 12U) << seed;
    }
}

TEST(FeatureTracker, an_edge_found_just_beside_is_the_same_after_some_looks) {
    Observations observations;
    observations.observation(drop_found(edge_ahead(1.0)));
    const TerrainFeatures moved = drop_found(edge_ahead(1.12));  // beyond the gate
    observations.observation(moved);
    EXPECT_EQ(observations.out().drops.size(), 2U);
    for (int k = 0; k < TrackingConfig{}.level_observations; ++k) observations.observation(moved);
    ASSERT_EQ(observations.out().drops.size(), 1U);
    EXPECT_NEAR(observations.out().drops[0].pose.p_m.x(), 1.12, 1e-6);
}

}  // namespace
}  // namespace surefoot::stairs::testing
