// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/footprints.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "surefoot/core/rng.hpp"
#include "surefoot/gate/findings.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

/// Pose in doubles: the oracle.
struct PlainPose {
    double x = 0.0, y = 0.0, yaw = 0.0;

    [[nodiscard]] std::pair<double, double> point(double u, double v) const {
        return {x + std::cos(yaw) * u - std::sin(yaw) * v,
                y + std::sin(yaw) * u + std::cos(yaw) * v};
    }
};

/// How far outside of the polygon a point lies; <= 0 inside.
double outside_by(const grid::FixedConvex& polygon, std::pair<double, double> p) {
    double worst = -1e18;
    for (int i = 0; i < polygon.count; ++i) {
        const auto a = polygon.vertices[static_cast<std::size_t>(i)];
        const auto b = polygon.vertices[static_cast<std::size_t>((i + 1) % polygon.count)];
        const auto dx = static_cast<double>(b.x - a.x);
        const auto dy = static_cast<double>(b.y - a.y);
        const double side =
            dx * (p.second - static_cast<double>(a.y)) - dy * (p.first - static_cast<double>(a.x));
        worst = std::max(worst, -side / std::hypot(dx, dy));
    }
    return worst;
}

double turn_rad(const Movement& movement) {
    return std::atan2(movement.sin_turn, movement.cos_turn);
}

// The target and then each corner are rounded to 0.1 mm in x and y: twice half a diagonal, 1.42;
// angles to 2^-20, which is 0.01 mm at 0.6 m and happens three times.
constexpr double kRoundingTenthMm = 1.8;

TEST(Footprints, target_and_boxes_agree_with_plain_trigonometry) {
    Rng rng(12);
    const Machine machine = rex();
    for (int round = 0; round < 400; ++round) {
        const PlainPose start{std::round(rng.uniform(-3e4, 3e4)),
                              std::round(rng.uniform(-3e4, 3e4)),
                              rng.uniform(-3.2, 3.2)};
        const Movement& movement = machine.movements[1 + rng.below(26)];
        const Sweep sweep = sweep_of(machine,
                                     fixed_pose(static_cast<std::int64_t>(start.x),
                                                static_cast<std::int64_t>(start.y),
                                                std::cos(start.yaw),
                                                std::sin(start.yaw)),
                                     movement);
        const auto goal = start.point(movement.forward_tenth_mm, movement.left_tenth_mm);
        const PlainPose target{goal.first, goal.second, start.yaw + turn_rad(movement)};
        const GroundBox* boxes[] = {&machine.left_foot, &machine.right_foot};
        for (std::size_t foot = 0; foot < 2; ++foot) {
            const GroundBox& box = *boxes[foot];
            EXPECT_EQ(sweep.feet[foot].landing.count, 4);
            for (const int corner : {0, 1, 2, 3}) {
                const double u = box.center_x_tenth_mm + (corner % 2 - 0.5) * box.length_tenth_mm;
                const double v = box.center_y_tenth_mm + (corner / 2 - 0.5) * box.width_tenth_mm;
                // On the rim: neither outside nor inside by more than the rounding.
                EXPECT_NEAR(
                    outside_by(sweep.feet[foot].landing, target.point(u, v)), 0.0, kRoundingTenthMm)
                    << "round " << round;
                EXPECT_NEAR(
                    outside_by(sweep.feet[foot].stance, start.point(u, v)), 0.0, kRoundingTenthMm)
                    << "round " << round;
            }
        }
    }
}

/// The hull joins start and target by straight lines: the margins must cover what a turn adds.
TEST(Footprints, corridor_and_body_hull_hold_every_pose_on_the_way) {
    const Machine machine = rex();
    for (std::size_t code = 1; code < machine.movements.size(); ++code) {
        const Movement& movement = machine.movements[code];
        const Sweep sweep = sweep_of(machine, FixedPose{}, movement);
        for (double s = 0.0; s <= 1.0; s += 0.05) {
            const PlainPose pose{
                s * movement.forward_tenth_mm, s * movement.left_tenth_mm, s * turn_rad(movement)};
            const auto expect_inside = [&](const GroundBox& box, const grid::FixedConvex& hull) {
                for (const int corner : {0, 1, 2, 3}) {
                    const double u =
                        box.center_x_tenth_mm + (corner % 2 - 0.5) * box.length_tenth_mm;
                    const double v =
                        box.center_y_tenth_mm + (corner / 2 - 0.5) * box.width_tenth_mm;
                    EXPECT_LE(outside_by(hull, pose.point(u, v)), 0.0) << code << " at " << s;
                }
            };
            expect_inside(machine.left_foot, sweep.feet[0].corridor);
            expect_inside(machine.right_foot, sweep.feet[1].corridor);
            expect_inside(machine.body.parts[0].box, sweep.body[0]);
        }
    }
}

TEST(Findings, are_complete_only_with_every_proof) {
    constexpr int kProofs = static_cast<int>(Proof::count);
    for (int missing = 0; missing <= kProofs; ++missing) {
        Findings findings;
        EXPECT_FALSE(findings.complete());
        for (int i = 0; i < kProofs; ++i) {
            if (i != missing) findings.prove(static_cast<Proof>(i), [] {});
        }
        EXPECT_EQ(findings.complete(), missing == kProofs) << "without proof " << missing;
        Evidence evidence;
        evidence.unproven = findings.unproven();
        for (int i = 0; i < kProofs; ++i)
            EXPECT_EQ(evidence.lacks(static_cast<Proof>(i)), i == missing) << i;
    }
}

TEST(Findings, a_test_that_denies_proves_nothing_even_for_a_known_reason) {
    Findings findings;
    findings.deny(Reason::slope);
    for (int i = 0; i < static_cast<int>(Proof::count); ++i)
        findings.prove(static_cast<Proof>(i), [&] { findings.deny(Reason::slope); });
    EXPECT_FALSE(findings.complete());
    EXPECT_EQ(findings.reasons(), ReasonSet(Reason::slope));
}

TEST(Findings, keep_the_worst_place_of_each_reason_and_the_first_among_equals) {
    Findings findings;
    EXPECT_EQ(findings.worst(Reason::drop_off), nullptr);
    findings.deny(Reason::drop_off, {1, 1, 100, 50, 100, Foot::left});
    findings.deny(Reason::drop_off, {2, 2, 300, 50, 300, Foot::right});
    findings.deny(Reason::drop_off, {3, 3, 300, 50, 300, Foot::left});
    findings.deny(Reason::slope, {4, 4, 900, 0, 900, Foot::left});
    ASSERT_NE(findings.worst(Reason::drop_off), nullptr);
    EXPECT_EQ(findings.worst(Reason::drop_off)->cell_x, 2);
    EXPECT_EQ(findings.worst(Reason::none), nullptr);
    EXPECT_EQ(findings.reasons().primary(), Reason::drop_off);
}

}  // namespace
}  // namespace surefoot::gate::testing
