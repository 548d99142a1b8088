// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/feature_tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/stairs/terrain_testing.hpp"

namespace surefoot::stairs {
namespace {

using testing::TestMap;

constexpr double kSigma_m = 0.005;

/// An edge across x = `at_m`, the lower ground ahead.
Edge edge_ahead(double at_m, double upper_m = 0.0, double lower_m = -0.2, double half_m = 0.5) {
    Edge edge;
    edge.from_m = {at_m, -half_m};
    edge.to_m = {at_m, half_m};
    edge.upper_m = upper_m;
    edge.lower_m = lower_m;
    edge.lower_seen = true;
    edge.height_sigma_m = kSigma_m;
    edge.across_sigma_m = kSigma_m;
    edge.angle_sigma_rad = 0.01;
    return edge;
}

TerrainFeatures edges_found(const std::vector<Edge>& edges) {
    TerrainFeatures found;
    found.edges = edges;
    return found;
}

TerrainFeatures drop_found(const Edge& edge) {
    TerrainFeatures found = edges_found({edge});
    found.drops = {line_feature(edge, true)};
    return found;
}

/// A flight up with `steps` steps from `first_m` on; each edge is its own and has no id.
Flight flight_up(int steps, double first_m = 1.0, double riser_m = 0.18, double going_m = 0.3) {
    Flight flight;
    flight.steps = steps;
    flight.riser_m = riser_m;
    flight.riser_sigma_m = 0.001;
    flight.going_m = going_m;
    flight.going_sigma_m = 0.002;
    flight.width_m = 1.0;
    for (int k = 0; k < steps; ++k) {
        Edge edge = edge_ahead(first_m + k * going_m, (k + 1) * riser_m, k * riser_m);
        std::swap(edge.from_m, edge.to_m);  // the lower ground is before it
        flight.edges.push_back(edge);
    }
    flight.pose.p_m << first_m, 0.0, 0.0;
    return flight;
}

TerrainFeatures flight_found(const Flight& flight) {
    TerrainFeatures found = edges_found(flight.edges);
    found.flights = {flight};
    return found;
}

/// Observes a constant map every 0.1 s.
class Observations {
  public:
    explicit Observations(const testing::Ground& ground) : map_(ground, 0.0, {0.0, 0.0}) {}
    /// All cells are unknown.
    Observations() : Observations([](double, double) { return 0.0; }) { map_.height_m.fill(kNanF); }

    const TerrainFeatures& observation(const TerrainFeatures& found, const Drift& drift = {}) {
        time_ns_ += 100'000'000;
        tracker_.update(found, map_.terrain({0.0, 0.0}), {time_ns_, drift}, out_);
        return out_;
    }
    /// Makes the next observation not the first one.
    void observe_nothing() { observation({}); }

    [[nodiscard]] const TerrainFeatures& out() const { return out_; }
    [[nodiscard]] std::int64_t time_ns() const { return time_ns_; }
    FeatureTracker& tracker() { return tracker_; }

  private:
    TestMap map_;
    FeatureTracker tracker_{TrackingConfig{}};
    TerrainFeatures out_;
    std::int64_t time_ns_ = 0;
};

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

TEST(FeatureTracker, the_first_look_of_all_is_told_as_it_is) {
    Observations observations;
    const auto& told = observations.observation(flight_found(flight_up(3)));
    EXPECT_EQ(told.flights.size(), 1U);
    EXPECT_EQ(told.edges.size(), 3U);
    EXPECT_DOUBLE_EQ(told.flights.at(0).riser_m, 0.18);
    EXPECT_DOUBLE_EQ(told.flights.at(0).edges.at(1).from_m.x(), 1.3);
}

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
    // Seen again it has the sigma of the observation, and keeps its id although it has moved.
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

TEST(FeatureTracker, what_leaves_the_map_is_forgotten) {
    Observations observations;
    observations.observation(drop_found(edge_ahead(3.0)));  // the map ends at 2.5 m
    EXPECT_EQ(observations.out().drops.size(), 1U);
    EXPECT_TRUE(observations.observation({}).drops.empty());
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
}  // namespace surefoot::stairs
