// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/footprints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/core/rng.hpp"
#include "surefoot/gate/findings.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

/// A pose in doubles, as the reference.
struct PlainPose {
    double x = 0.0, y = 0.0, yaw = 0.0;

    [[nodiscard]] std::pair<double, double> point(double u, double v) const {
        return {x + std::cos(yaw) * u - std::sin(yaw) * v,
                y + std::sin(yaw) * u + std::cos(yaw) * v};
    }
};

/// Distance of a point outside the polygon; <= 0 inside.
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
                // On the rim: at most the rounding error inside or outside.
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
            expect_inside(machine.body.parts[0].box, sweep.body[0].way);
        }
    }
}

/// The smallest and largest coordinates of a polygon.
Extent box_around(const grid::FixedConvex& polygon) {
    Extent extent{polygon.vertices[0], polygon.vertices[0]};
    for (const grid::FixedPoint& p : polygon.points()) {
        extent.low = {std::min(extent.low.x, p.x), std::min(extent.low.y, p.y)};
        extent.high = {std::max(extent.high.x, p.x), std::max(extent.high.y, p.y)};
    }
    return extent;
}
void expect_box(const char* what, const Extent& box, grid::FixedPoint low, grid::FixedPoint high) {
    EXPECT_EQ(box.low.x, low.x) << what;
    EXPECT_EQ(box.low.y, low.y) << what;
    EXPECT_EQ(box.high.x, high.x) << what;
    EXPECT_EQ(box.high.y, high.y) << what;
}

TEST(Footprints, every_region_has_its_margin_to_the_tenth_of_a_millimetre) {
    // Foot 366.0 x 190.0 mm, 57 mm ahead and 180 mm to a side; margins 20 and 100 mm, sway 50 mm,
    // and 25 mm position error of objects in the map. A step of 400 mm.
    const Machine machine = rex();
    for (const std::int64_t extra : {0, 70}) {
        const Sweep sweep = sweep_of(machine, FixedPose{}, machine.movements[kForward], extra);
        EXPECT_EQ(sweep.target.position, (grid::FixedPoint{4000, 0}));
        EXPECT_EQ(sweep.target.cos_yaw, FixedPose::kOne);
        EXPECT_EQ(sweep.target.sin_yaw, 0);
        const FootSweep& left = sweep.feet[0];
        EXPECT_EQ(left.foot, Foot::left);
        EXPECT_EQ(left.landing_center, (grid::FixedPoint{4570, 1800}));
        expect_box("stance", box_around(left.stance), {-1260, 850}, {2400, 2750});
        expect_box("landing", box_around(left.landing), {2740, 850}, {6400, 2750});
        expect_box("corridor",
                   box_around(left.corridor),
                   {-1260 - 450 - extra, 850 - 450 - extra},
                   {6400 + 450 + extra, 2750 + 450 + extra});
        expect_box("band",
                   box_around(left.band),
                   {2740 - 1250 - extra, 850 - 1250 - extra},
                   {6400 + 1250 + extra, 2750 + 1250 + extra});
        expect_box("edges",
                   box_around(left.edges),
                   {2740 - 2000 - extra, 850 - 2000 - extra},
                   {6400 + 2000 + extra, 2750 + 2000 + extra});
        const FootSweep& right = sweep.feet[1];
        EXPECT_EQ(right.foot, Foot::right);
        EXPECT_EQ(right.landing_center, (grid::FixedPoint{4570, -1800}));
        expect_box("right", box_around(right.landing), {2740, -2750}, {6400, -850});
        expect_box("body",
                   box_around(sweep.body[0].way),
                   {-3300 - 750 - extra, -3225 - 750 - extra},
                   {7300 + 750 + extra, 3225 + 750 + extra});
        expect_box("here",
                   box_around(sweep.body[0].here),
                   {-3300 - 750 - extra, -3225 - 750 - extra},
                   {3300 + 750 + extra, 3225 + 750 + extra});
        EXPECT_EQ(sweep.body[1].way.count, 0) << "there is one part";
        // Body and edges reach farthest; each side of the extent belongs to a region.
        expect_box(
            "all", extent_of(sweep), {-4050 - extra, -4750 - extra}, {8400 + extra, 4750 + extra});
    }
}

TEST(Footprints, a_box_of_odd_size_grows_and_never_shrinks) {
    Machine machine = rex();
    machine.left_foot = {0, 0, 3661, 1901};
    const Sweep sweep = sweep_of(machine, FixedPose{}, Movement{});
    expect_box("odd", box_around(sweep.feet[0].landing), {-1831, -951}, {1831, 951});
    machine.left_foot = {0, 0, 3662, 1902};
    const Sweep even = sweep_of(machine, FixedPose{}, Movement{});
    expect_box("even", box_around(even.feet[0].landing), {-1831, -951}, {1831, 951});
}

TEST(Footprints, all_of_a_sweep_lies_in_its_extent_and_touches_its_four_sides) {
    const Machine machine = rex();
    for (const std::uint8_t code : {kForward, kBackward, kLeft, kRight, kTurnLeft}) {
        const Sweep sweep =
            sweep_of(machine, fixed_pose(-70, 30, 0.6, -0.8), machine.movements[code]);
        const Extent all = extent_of(sweep);
        Extent found{sweep.target.position, sweep.target.position};
        const auto look = [&](const grid::FixedConvex& polygon) {
            const Extent box = box_around(polygon);
            found = {{std::min(found.low.x, box.low.x), std::min(found.low.y, box.low.y)},
                     {std::max(found.high.x, box.high.x), std::max(found.high.y, box.high.y)}};
        };
        for (const FootSweep& foot : sweep.feet) {
            look(foot.stance);
            look(foot.landing);
            look(foot.corridor);
            look(foot.band);
            look(foot.edges);
        }
        look(sweep.body[0].way);
        expect_box("all", all, found.low, found.high);
    }
}

/// If a foot reaches farther than the body, the extent follows the regions of the foot.
TEST(Footprints, the_extent_holds_feet_that_stand_far_out) {
    Machine machine = rex();
    machine.left_foot.center_y_tenth_mm = 20'000;
    machine.right_foot.center_y_tenth_mm = -20'000;
    const Sweep sweep = sweep_of(machine, FixedPose{}, machine.movements[kForward]);
    EXPECT_EQ(extent_of(sweep).high.y, 20'000 + 950 + 2000) << "drops beyond the band";
    EXPECT_EQ(extent_of(sweep).low.y, -20'000 - 950 - 2000);
    machine.movements[kForward].forward_tenth_mm = -20'000;
    machine.limits.foot_margin_tenth_mm = 2'000;
    const Sweep back = sweep_of(machine, FixedPose{}, machine.movements[kForward]);
    EXPECT_EQ(extent_of(back).high.x, std::max(570 + 1830 + 2'000 + 250, 3300 + 750));
    EXPECT_EQ(extent_of(back).high.y, 20'000 + 950 + 2'250) << "the corridor";
}

TEST(Footprints, angles_and_places_are_rounded_to_the_nearest) {
    for (const double value : {0.3, -0.3, 0.7, -0.7, 1.0, -1.0, 0.0, 1e-7, -1e-7}) {
        const FixedPose pose = fixed_pose(1, 2, value, -value);
        EXPECT_EQ(pose.cos_yaw, std::llround(value * 1048576.0)) << value;
        EXPECT_EQ(pose.sin_yaw, std::llround(-value * 1048576.0)) << value;
        EXPECT_EQ(pose.position, (grid::FixedPoint{1, 2}));
    }
    // A quarter of a turn to the left, then places by hand: (x, y) becomes (-y, x).
    const FixedPose quarter = fixed_pose(100, 200, 0.0, 1.0);
    EXPECT_EQ(to_odom(quarter, 30, 4), (grid::FixedPoint{96, 230}));
    // Halves round upward for both signs: 0.5 * 1 and 0.5 * -1.
    FixedPose half;
    half.cos_yaw = FixedPose::kOne / 2;
    EXPECT_EQ(to_odom(half, 1, 0), (grid::FixedPoint{1, 0}));
    EXPECT_EQ(to_odom(half, -1, 0), (grid::FixedPoint{0, 0}));
    EXPECT_EQ(to_odom(half, 3, 1), (grid::FixedPoint{2, 1}));
    EXPECT_EQ(to_odom(half, -3, -1), (grid::FixedPoint{-1, 0}));
}

TEST(Footprints, a_turn_adds_to_the_heading) {
    Movement turn;
    turn.cos_turn = 0.8;
    turn.sin_turn = 0.6;
    turn.forward_tenth_mm = 1000;
    turn.left_tenth_mm = 500;
    const FixedPose target = moved(fixed_pose(10, 20, 0.6, 0.8), turn);
    EXPECT_EQ(target.position, (grid::FixedPoint{10 + 600 - 400, 20 + 800 + 300}));
    EXPECT_NEAR(static_cast<double>(target.cos_yaw), 0.0, 1.0);  // 0.48 - 0.48
    EXPECT_NEAR(static_cast<double>(target.sin_yaw), 1048576.0, 1.0);
    const FixedPose back = moved(fixed_pose(0, 0, 0.8, -0.6), turn);
    EXPECT_NEAR(static_cast<double>(back.cos_yaw), 1048576.0, 1.0);
    EXPECT_NEAR(static_cast<double>(back.sin_yaw), 0.0, 1.0);
}

TEST(Footprints, drift_beyond_a_centimetre_widens_by_3_4_times_as_much) {
    const GateLimits limits = rex().limits;
    EXPECT_EQ(drift_margin(limits, 0), 0);
    EXPECT_EQ(drift_margin(limits, 100), 0);
    EXPECT_EQ(drift_margin(limits, 101), 4);    // 3.4, rounded up
    EXPECT_EQ(drift_margin(limits, 200), 341);  // 340 and one for what rounding takes
    EXPECT_EQ(drift_margin(limits, 250), 511);
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
