// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/canary.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <utility>

#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

std::unique_ptr<Canaries> canaries_of(const Machine& machine) {
    return std::make_unique<Canaries>(machine);
}

TEST(Canaries, all_verdicts_of_the_rex_are_as_they_must_be) {
    const auto canaries = canaries_of(rex());
    std::set<std::uint8_t> movements;
    std::set<Reason> expected;
    for (int i = 0; i < canaries->count(); ++i) {
        const Canaries::Outcome outcome = canaries->judge(i);
        EXPECT_TRUE(outcome.passed) << i << ": movement " << int{outcome.command} << " expected "
                                    << outcome.name << ", found " << to_string(outcome.found);
        if (outcome.expected == Reason::none) movements.insert(outcome.command);
        expected.insert(outcome.expected);
    }
    EXPECT_EQ(movements.size(), 26U) << "every movement has been OK once";
    EXPECT_GE(expected.size(), 24U) << "so many different rules were broken";
    EXPECT_EQ(canaries->count(), 26 + 19 + 2 * 11 + 1);
    EXPECT_TRUE(canaries->judge_all().passed);
    EXPECT_EQ(canaries->judge_all().expected, canaries->judge(canaries->count() - 1).expected)
        << "the last one";
    EXPECT_TRUE(canaries->judge(canaries->count()).passed) << "begins anew";
}

TEST(Canaries, a_machine_that_is_not_valid_fails) {
    EXPECT_FALSE(canaries_of(Machine{})->judge_all().passed);
    Machine machine = rex();
    machine.limits.frame_age_ns = 0;
    EXPECT_FALSE(canaries_of(machine)->judge_all().passed);
    machine = rex();
    for (Movement& movement : machine.movements) movement.configured = false;
    EXPECT_FALSE(canaries_of(machine)->judge_all().passed);
}

TEST(Canaries, ask_each_usable_movement_once_and_break_rules_with_the_longest) {
    Machine machine = rex();
    for (Movement& movement : machine.movements) movement = Movement{};
    const auto set = [&machine](std::size_t code, int forward, int left) {
        machine.movements[code].configured = true;
        machine.movements[code].forward_tenth_mm = forward;
        machine.movements[code].left_tenth_mm = left;
    };
    set(3, 300, 0);
    set(5, -2500, 1500);  // the longest, though neither the farthest ahead nor to the left
    set(6, 2600, -300);
    set(9, 0, 2700);
    set(20, 4000, 0);
    machine.movements[20].movement_class = MovementClass::stair;  // this class is off
    const auto canaries = canaries_of(machine);
    const auto all = canaries_of(rex())->count() - 26;
    ASSERT_EQ(canaries->count(), all + 4);
    const std::uint8_t usable[] = {3, 5, 6, 9};
    for (int i = 0; i < canaries->count(); ++i) {
        const Canaries::Outcome outcome = canaries->judge(i);
        EXPECT_EQ(outcome.command, i < 4 ? usable[i] : 5) << i;
        EXPECT_EQ(outcome.expected == Reason::none, i < 4) << i;
        EXPECT_STREQ(outcome.name, to_string(outcome.expected));
        EXPECT_TRUE(outcome.passed) << i << " " << outcome.name << " " << to_string(outcome.found);
    }
    EXPECT_EQ(canaries->judge(canaries->count() + 2).command, 6) << "counted on from the start";
}

TEST(Canaries, find_new_ground_under_a_short_step_and_none_under_next_to_none) {
    const auto rex_with_steps_of = [](int percent) {
        Machine machine = rex();
        for (Movement& movement : machine.movements) {
            movement.forward_tenth_mm = movement.forward_tenth_mm * percent / 100;
            movement.left_tenth_mm = movement.left_tenth_mm * percent / 100;
        }
        return machine;
    };
    for (const int percent : {100, 45, 37, 25}) {  // 0.10 m at least; a foot is 0.366 m long
        const auto told = canaries_of(rex_with_steps_of(percent))->judge_all();
        EXPECT_TRUE(told.passed) << percent << " " << told.name << " " << to_string(told.found);
    }
    const auto told = canaries_of(rex_with_steps_of(5))->judge_all();
    EXPECT_FALSE(told.passed);
    EXPECT_EQ(told.expected, Reason::disconnected);
    EXPECT_EQ(told.command, 9);
}

TEST(Canaries, a_machine_whose_foot_lands_beyond_the_map_fails_and_stays_inside_it) {
    for (const auto& [x, y] : {std::pair{100'000, 0}, {-100'000, 0}, {0, 100'000}, {0, -100'000}}) {
        Machine machine = rex();
        machine.left_foot.center_x_tenth_mm = x;
        machine.left_foot.center_y_tenth_mm = y;
        ASSERT_EQ(machine.problem(), nullptr);
        const auto canaries = canaries_of(machine);
        const Canaries::Outcome first = canaries->judge(0);
        EXPECT_FALSE(first.passed);
        EXPECT_EQ(first.found, Reason::outside_map);
        EXPECT_EQ(canaries->judge_all().command, first.command) << "the first that failed";
        int first_of_ground = 26;  // faults: left foot, as many of the right foot, damages
        while (is_error(canaries->judge(first_of_ground).expected)) ++first_of_ground;
        const int of_a_foot = (canaries->count() - 1 - first_of_ground) / 2;
        EXPECT_EQ(of_a_foot, 11);
        for (int i = 0; i < canaries->count(); ++i) {
            const Canaries::Outcome outcome = canaries->judge(i);
            // No movement is OK, and that foot has no other ground reason. An error remains an
            // error.
            const bool of_that_foot = i >= first_of_ground && i < first_of_ground + of_a_foot;
            EXPECT_EQ(outcome.passed, i >= 26 && !of_that_foot) << i << " " << outcome.name;
        }
    }
}

TEST(Canaries, break_rules_with_the_first_of_equally_long_movements) {
    Machine machine = rex();
    machine.movements[12] = machine.movements[kForward];
    EXPECT_EQ(canaries_of(machine)->judge(26).command, kForward);
    for (std::size_t code = 1; code < kTurnLeft; ++code) machine.movements[code] = Movement{};
    const auto turning = canaries_of(machine);  // no movement has a length
    EXPECT_EQ(turning->judge(0).command, kTurnLeft);
    EXPECT_EQ(turning->judge(1).command, kTurnRight);
    EXPECT_EQ(turning->judge(2).command, kTurnLeft);
    EXPECT_EQ(turning->judge(2).expected, Reason::frame_stale);
}

TEST(Canaries, a_default_outcome_has_passed_nothing) {
    const Canaries::Outcome outcome;
    EXPECT_FALSE(outcome.passed);
    EXPECT_EQ(outcome.command, 0);
    EXPECT_EQ(outcome.found, Reason::internal);
}

// A limit that was set too wide by mistake fails the canary that breaks it by little.
TEST(Canaries, they_follow_the_limits_of_the_machine) {
    Machine machine = rex();
    machine.limits.drop_tenth_mm = 900;
    machine.limits.swing_clearance_tenth_mm = 500;
    machine.limits.step[0].up_tenth_mm = 400;
    const auto canaries = canaries_of(machine);
    const Canaries::Outcome outcome = canaries->judge_all();
    EXPECT_TRUE(outcome.passed) << outcome.name << ", found " << to_string(outcome.found);
    machine = rex();
    machine.limits.step[0].up_tenth_mm = 100;  // the limit of a step down is 200
    EXPECT_TRUE(canaries_of(machine)->judge_all().passed);
}

// The faults are faults of flat ground: on stairs a surface beside the present one may be a tread.
TEST(Canaries, a_movement_for_stairs_does_not_make_them_fail) {
    Machine machine = rex();
    machine.limits.step[1].enabled = true;
    for (const std::uint8_t command : {kForward, kBackward})
        machine.movements[command].movement_class = MovementClass::stair;
    const auto canaries = canaries_of(machine);
    const Canaries::Outcome outcome = canaries->judge_all();
    EXPECT_TRUE(outcome.passed) << outcome.name << ", found " << to_string(outcome.found);
    for (int i = 0; i < canaries->count(); ++i) {
        const Canaries::Outcome one = canaries->judge(i);
        if (one.expected == Reason::none) continue;
        EXPECT_EQ(machine.movements[one.command].movement_class, MovementClass::walk) << one.name;
    }
}

}  // namespace
}  // namespace surefoot::gate::testing
