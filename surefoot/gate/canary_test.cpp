// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/canary.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <set>

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
    EXPECT_TRUE(canaries->judge_all().passed);
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

// A limit that a slip of the pen made too wide is noticed where the canary breaks it by little.
TEST(Canaries, they_follow_the_limits_of_the_machine) {
    Machine machine = rex();
    machine.limits.drop_tenth_mm = 900;
    machine.limits.swing_clearance_tenth_mm = 500;
    machine.limits.step[0].up_tenth_mm = 400;
    const auto canaries = canaries_of(machine);
    const Canaries::Outcome outcome = canaries->judge_all();
    EXPECT_TRUE(outcome.passed) << outcome.name << ", found " << to_string(outcome.found);
}

}  // namespace
}  // namespace surefoot::gate::testing
