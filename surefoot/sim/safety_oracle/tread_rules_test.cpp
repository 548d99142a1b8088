// SPDX-License-Identifier: Apache-2.0
// Steps of class stair on small flights, judged by the safety oracle.
#include "surefoot/sim/safety_oracle/tread_rules.hpp"

#include <gtest/gtest.h>

#include "surefoot/sim/safety_oracle/safety_testing.hpp"

namespace surefoot::sim::testing {
namespace {

constexpr int kUp = 9;
constexpr int kDown = 17;

/// The feet and the body of the REX, and one step of class stair each way.
Machine climber(double going_m = 0.31) {
    Machine machine = rex();
    machine.ankle_from_heel_tenth_mm = 1'260;
    machine.body.parts[0] = {{700, 0, 3'000, 7'400}, 1'100, 10'200};   // legs
    machine.body.parts[1] = {{-100, 0, 7'200, 9'400}, 6'200, 20'700};  // frame and user
    machine.body.count = 2;
    machine.body.sway_tenth_mm = 200;
    machine.limits.step[1] = {true, 1'850, 1'850};
    machine.limits.tread_share_permille = 700;
    machine.limits.tread_overhang_tenth_mm = 900;
    for (const int code : {kUp, kDown}) {
        Movement& movement = machine.movements[static_cast<std::size_t>(code)];
        movement.movement_class = MovementClass::stair;
        movement.forward_tenth_mm = static_cast<std::int32_t>((code == kUp ? 1e4 : -1e4) * going_m);
    }
    return machine;
}

struct Flight {
    double rise_m = 0.18;
    double going_m = 0.31;
    int treads = 4;  ///< the last one is the landing
    double right_m = -0.8;
    double left_m = 0.8;
    int left_out = 0;  ///< this tread is missing

    /// Position of the riser below tread k (1 = first).
    [[nodiscard]] double riser_m(int k) const { return 0.4 + (k - 1) * going_m; }
    [[nodiscard]] World on(World world, double floor_m = 0.0) const {
        world.floor(floor_m);
        for (int k = 1; k <= treads; ++k) {
            const double to_m = k == treads ? 3.0 : riser_m(k + 1);
            if (k != left_out)
                world.box({riser_m(k), to_m}, {right_m, left_m}, {floor_m, k * rise_m});
        }
        return world;
    }
    [[nodiscard]] World world() const { return on(World()); }
    /// A machine on tread k (0 = floor) with its toes at a distance before the next riser.
    [[nodiscard]] Pose standing_on(int k, double before_riser_m) const {
        return standing(riser_m(k + 1) - before_riser_m - kToe_m, 0.0, 0.0, k * rise_m);
    }
};

struct Step {
    int from = 1;
    int command = kUp;
    double longer_m = 0.0;  ///< than the going of the flight
};

SafetyAnswer climb(const Flight& flight,
                   double before_riser_m,
                   const World& world,
                   const Step& step = {}) {
    return judge(world.scene,
                 climber(flight.going_m + step.longer_m),
                 flight.standing_on(step.from, before_riser_m),
                 step.command,
                 {0.002, 0.002, 0.01});
}
SafetyAnswer climb(const Flight& flight, double before_riser_m, const Step& step = {}) {
    return climb(flight, before_riser_m, flight.world(), step);
}

TEST(TreadRules, a_flight_of_310_mm_is_climbed_from_the_floor_to_the_landing_and_back) {
    const Flight flight;
    for (int from = 0; from + 1 < flight.treads; ++from) {
        const auto up = climb(flight, 0.03, {from, kUp});
        EXPECT_TRUE(up.safe && up.clear_cut) << from << ": " << up.sentence();
        const auto down = climb(flight, 0.03, {from + 1, kDown});
        EXPECT_TRUE(down.safe && down.clear_cut) << from + 1 << ": " << down.sentence();
    }
}

TEST(TreadRules, the_toes_need_room_before_the_riser_and_the_heel_room_on_the_tread) {
    const Flight flight;
    EXPECT_TRUE(climb(flight, 0.025).safe);
    EXPECT_TRUE(climb(flight, 0.025, {.longer_m = 0.015}).has(Danger::obstacle_in_way));
    // The heel reaches over by 0.366 - (0.31 - before the riser): 0.089 and 0.096 m.
    EXPECT_TRUE(climb(flight, 0.030, {.longer_m = -0.003}).safe);
    const auto behind = climb(flight, 0.030, {.longer_m = -0.010});
    EXPECT_TRUE(behind.has(Danger::tread_overhang)) << behind.sentence();
    EXPECT_FALSE(behind.has(Danger::tread_support)) << behind.sentence();
}

TEST(TreadRules, a_tread_carries_the_ankle_and_a_share_of_the_foot) {
    const Flight flight;
    const auto with_share = [&](std::int32_t permille) {
        Machine machine = climber();
        machine.limits.tread_share_permille = permille;
        return judge(flight.world().scene, machine, flight.standing_on(0, 0.03), kUp);
    };
    EXPECT_TRUE(with_share(760).safe);
    const auto answer = with_share(780);
    EXPECT_EQ(answer.dangers.front().danger, Danger::tread_support) << answer.sentence();
    EXPECT_NEAR(answer.dangers.front().value, 0.28, 0.006);
    EXPECT_NEAR(answer.dangers.front().limit, 0.78 * 0.366, 1e-9);
    // The ankle is 0.126 m from the heel, and its area reaches 0.025 m behind it.
    const auto off = climb(flight, 0.030, {.longer_m = -0.025});
    EXPECT_TRUE(off.has(Danger::tread_support)) << off.sentence();
}

TEST(TreadRules, a_riser_above_the_limit_is_named_up_and_down) {
    EXPECT_TRUE(climb({.rise_m = 0.184}, 0.03).safe);
    const Flight high{.rise_m = 0.19};
    const auto up = climb(high, 0.03);
    EXPECT_EQ(up.dangers.front().danger, Danger::step_up) << up.sentence();
    EXPECT_NEAR(up.dangers.front().value, 0.19, 1e-9);
    EXPECT_TRUE(climb(high, 0.03, {2, kDown}).has(Danger::step_down));
}

TEST(TreadRules, a_missing_tread_is_a_danger_up_and_down) {
    Flight flight;
    flight.left_out = 2;
    EXPECT_FALSE(climb(flight, 0.03).safe);
    EXPECT_FALSE(climb(flight, 0.03, {3, kDown}).safe);
}

TEST(TreadRules, an_object_on_the_tread_stops_the_step) {
    const Flight flight;
    World low = flight.world();
    const double tread_m = flight.riser_m(2);
    low.box({tread_m + 0.1, tread_m + 0.15}, {0.15, 0.2}, {0.36, 0.40});
    EXPECT_TRUE(climb(flight, 0.03, low).has(Danger::roughness));
    World tall = flight.world();
    tall.box({tread_m + 0.1, tread_m + 0.15}, {0.15, 0.2}, {0.36, 0.45});
    EXPECT_TRUE(climb(flight, 0.03, tall).has(Danger::obstacle_in_way));
    World beside = flight.world();
    beside.box({tread_m + 0.1, tread_m + 0.15}, {0.31, 0.36}, {0.36, 0.40});
    EXPECT_TRUE(climb(flight, 0.03, beside).safe);
}

TEST(TreadRules, a_worn_nosing_carries_nothing) {
    const Flight whole;
    Flight flight;
    flight.left_out = 2;
    World worn = flight.world();
    const double tread_m = whole.riser_m(2);
    worn.box({tread_m, tread_m + 0.03}, {-0.8, 0.8}, {0.0, 0.30});
    worn.box({tread_m + 0.03, whole.riser_m(3)}, {-0.8, 0.8}, {0.0, 0.36});
    const auto answer = climb(whole, 0.03, worn);
    EXPECT_TRUE(answer.has(Danger::tread_overhang)) << answer.sentence();
}

TEST(TreadRules, the_open_side_of_a_flight_must_be_far_enough) {
    EXPECT_TRUE(climb({.left_m = kFootSide_m + 0.11}, 0.03).safe);
    for (const Flight& narrow :
         {Flight{.left_m = kFootSide_m + 0.05}, Flight{.right_m = -kFootSide_m - 0.05}}) {
        const auto answer = climb(narrow, 0.03);
        EXPECT_TRUE(answer.has(Danger::edge_too_near)) << answer.sentence();
    }
}

TEST(TreadRules, beside_the_carried_part_even_one_riser_is_too_deep) {
    const Flight narrow{.left_m = kFootSide_m + 0.05};
    World world = narrow.world();
    world.box({narrow.riser_m(1), 3.0}, {narrow.left_m, 0.8}, {0.0, narrow.rise_m});
    const auto answer = climb(narrow, 0.03, world);
    EXPECT_TRUE(answer.has(Danger::edge_too_near)) << answer.sentence();
}

TEST(TreadRules, behind_the_heel_only_the_next_tread_may_lie) {
    const Flight flight;
    EXPECT_TRUE(climb(flight, 0.03, {2, kDown}).safe);
    const auto answer = climb(flight, 0.03, flight.on(World(), -0.5), {2, kDown});
    EXPECT_TRUE(answer.has(Danger::edge_too_near)) << answer.sentence();
}

TEST(TreadRules, down_again_the_toes_and_the_sides_need_the_margin_of_the_foot) {
    const Flight flight;
    const auto close = climb(flight, 0.03, {2, kDown, -0.02});
    EXPECT_TRUE(close.has(Danger::obstacle_in_way)) << close.sentence();
    World world = flight.world();
    const double tread_m = flight.riser_m(1);
    world.box({tread_m + 0.1, tread_m + 0.15},
              {kFootSide_m + 0.01, kFootSide_m + 0.06},
              {flight.rise_m, flight.rise_m + 0.08});
    const auto beside = climb(flight, 0.03, world, {2, kDown});
    EXPECT_TRUE(beside.has(Danger::obstacle_in_way)) << beside.sentence();
}

TEST(TreadRules, a_foot_passes_over_what_the_gait_lifts_it_over) {
    const Flight flight{.going_m = 0.45};
    const auto over = [&](double height_m) {  // on the edge of the next tread
        World world = flight.world();
        const double edge_m = flight.riser_m(2);
        world.box({edge_m, edge_m + 0.02}, {-0.3, 0.3}, {0.36, 0.36 + height_m});
        return climb(flight, 0.03, world);
    };
    EXPECT_TRUE(over(0.03).safe) << over(0.03).sentence();
    const auto answer = over(0.06);
    EXPECT_TRUE(answer.has(Danger::obstacle_in_way)) << answer.sentence();
    EXPECT_FALSE(answer.has(Danger::roughness)) << answer.sentence();
}

TEST(TreadRules, a_body_that_sinks_meets_what_stands_between_the_feet) {
    const Flight flight;
    World world = flight.world();
    const double tread_m = flight.riser_m(1);
    world.box(
        {tread_m + 0.1, tread_m + 0.15}, {-0.05, 0.05}, {flight.rise_m, flight.rise_m + 0.15});
    const auto answer = climb(flight, 0.03, world, {2, kDown});
    EXPECT_EQ(answer.dangers.front().danger, Danger::body_hits) << answer.sentence();
}

TEST(TreadRules, both_feet_land_at_one_level_on_even_ground_that_is_joined) {
    const Flight flight{.rise_m = 0.15};
    const double tread_m = flight.riser_m(2);
    World half = flight.world();
    half.box({tread_m, flight.riser_m(3)}, {0.0, 0.8}, {0.30, 0.33});
    EXPECT_TRUE(climb(flight, 0.03, half).has(Danger::roughness));

    Flight without = flight;
    without.left_out = 2;
    World sloped = without.world();
    sloped.slab({tread_m, 3.0}, {-0.8, 0.8}, 0.0, {0.14, 0.0}, 0.28 - 0.14 * tread_m);
    EXPECT_TRUE(climb(flight, 0.03, sloped).has(Danger::tilt))
        << climb(flight, 0.03, sloped).sentence();

    without.treads = 3;
    World apart = without.on(World(), -1.0);
    apart.box({tread_m + 0.01, flight.riser_m(3) - 0.01}, {-0.8, 0.8}, {-1.0, 0.30});
    EXPECT_TRUE(climb(flight, 0.03, apart).has(Danger::disconnected));
}

TEST(TreadRules, a_handrail_needs_the_side_clearance_of_the_body) {
    const Flight flight;
    const auto with_rail = [&](double y_m) {
        World world = flight.world();
        world.box({0.0, 2.0}, {y_m, y_m + 0.05}, {1.1, 1.15});
        return climb(flight, 0.03, world);
    };
    EXPECT_TRUE(with_rail(0.50).safe) << with_rail(0.50).sentence();
    EXPECT_TRUE(with_rail(0.48).has(Danger::body_hits)) << with_rail(0.48).sentence();
}

TEST(TreadRules, the_head_needs_room_above_the_higher_tread) {
    const Flight flight;
    const auto below = [&](double height_m) {
        World world = flight.world();
        world.box({-0.5, 3.0}, {-0.8, 0.8}, {height_m, height_m + 0.2});
        return climb(flight, 0.03, world);
    };
    EXPECT_TRUE(below(0.36 + 2.08).safe) << below(0.36 + 2.08).sentence();
    EXPECT_TRUE(below(0.36 + 2.06).has(Danger::overhang_too_low));
}

TEST(TreadRules, feet_that_do_not_stand_on_one_tread_have_no_stance) {
    const Flight flight;
    World step = flight.world();  // the left foot on a block
    step.box({flight.riser_m(1), flight.riser_m(2)}, {0.0, 0.8}, {0.18, 0.21});
    const auto answer =
        judge(step.scene, climber(), flight.standing_on(1, 0.03), kUp, {0.002, 0.002, 0.01});
    EXPECT_TRUE(answer.has(Danger::no_stance)) << answer.sentence();
    // Too far over the nosing.
    EXPECT_TRUE(climb(flight, 0.12).has(Danger::no_stance));
}

TEST(TreadRules, hold_in_every_direction_and_mirrored) {
    const Flight flight{.left_m = 0.38};
    for (const double yaw_rad : {0.7, -2.0}) {
        for (const bool mirrored : {false, true}) {
            const PlanarPose T = PlanarPose::of(0.3, -0.2, yaw_rad);
            const World world = flight.on(World(T, mirrored));
            for (const double before_m : {0.01, 0.03, 0.055}) {
                Pose here = flight.standing_on(1, before_m);
                const Eigen::Vector2d p = T * Eigen::Vector2d(here.translation_m.head<2>());
                const Pose turned = standing(p.x(), p.y(), yaw_rad, flight.rise_m);
                const SafetyMargin margin{0.002, 0.002, 0.01};
                const auto answer = judge(world.scene, climber(), turned, kUp, margin);
                EXPECT_EQ(answer.safe, climb(flight, before_m).safe) << answer.sentence();
            }
        }
    }
}

}  // namespace
}  // namespace surefoot::sim::testing
