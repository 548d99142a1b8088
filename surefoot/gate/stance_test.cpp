// SPDX-License-Identifier: Apache-2.0
// The plane of the ground under the present feet, and steps on ramps.
#include "surefoot/gate/stance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/verdict_testing.hpp"

namespace surefoot::gate::testing {
namespace {

constexpr double kRamp = 1.0 / 12.0;
/// Heights are rounded to 0.1 mm, and pairs of cells are 0.1 m apart or more.
constexpr double kRounded = 1e-3;

/// Sets the height of every cell.
template <typename Height>
Terrain shaped(Height&& height_m) {
    Terrain terrain;
    for (int v = 0; v < 240; ++v) {
        for (int u = 0; u < 240; ++u) {
            const Eigen::Vector2d at_m = terrain.geometry.center_m({u, v});
            terrain.height.at(u, v) = static_cast<float>(height_m(at_m.x(), at_m.y()));
        }
    }
    return terrain;
}

/// A ramp along the path of a machine with this yaw, which begins `start_m` ahead of base_link.
Terrain ramp(double start_m, double rise = kRamp, double yaw = 0.0) {
    return shaped([=](double x, double y) {
        return rise * std::max(0.0, std::cos(yaw) * x + std::sin(yaw) * y - start_m);
    });
}

Stance stance_on(Terrain& terrain, double yaw = 0.0, bool level = false) {
    const auto map = terrain.snapshot();
    const Machine machine = rex();
    const Query query = make_query(kForward, 0.0, 0.0, std::cos(yaw), std::sin(yaw));
    const Sweep sweep = sweep_of(
        machine, fixed_pose(0, 0, query.cos_yaw, query.sin_yaw), machine.movements[kForward]);
    return find_stance(Ground(*map, query, machine.limits), query, sweep, level);
}

std::vector<StancePlane> planes_of(const Stance& stance) {
    std::vector<StancePlane> planes(stance.parts.begin(), stance.parts.end());
    planes.push_back(stance.plane);
    return planes;
}

TEST(Stance, continues_the_slope_under_the_feet_at_every_yaw) {
    for (const double yaw : {0.0, 0.4, 0.785, 1.2, 1.571, -2.0, 3.0}) {
        Terrain terrain = ramp(-9.0, kRamp, yaw);
        const Stance stance = stance_on(terrain, yaw);
        ASSERT_TRUE(stance.known);
        for (const StancePlane& plane : planes_of(stance)) {
            const auto slope = plane.tangents(250);
            EXPECT_NEAR(std::cos(yaw) * slope.x + std::sin(yaw) * slope.y, kRamp, kRounded) << yaw;
            EXPECT_NEAR(std::cos(yaw) * slope.y - std::sin(yaw) * slope.x, 0.0, kRounded) << yaw;
            for (const auto& [ix, iy] : {std::pair{120, 120}, {140, 110}, {90, 150}}) {
                const Eigen::Vector2d at_m = terrain.geometry.center_m({ix, iy});
                const double z_m =
                    kRamp * (std::cos(yaw) * at_m.x() + std::sin(yaw) * at_m.y() + 9.0);
                EXPECT_NEAR(1e-4 * static_cast<double>(plane.at(ix, iy)), z_m, kRounded) << yaw;
            }
        }
        for (const auto& foot : stance.feet_tenth_mm)
            EXPECT_NEAR(static_cast<double>(*foot), 0, 10);
    }
}

TEST(Stance, a_sill_under_the_toes_or_one_foot_higher_tilts_nothing) {
    Terrain sill;
    sill.box(0.17, 0.30, -1.0, 1.0, 0.02);
    Terrain half;
    half.box(-1.0, 1.0, 0.0, 1.0, 0.015);
    for (Terrain* terrain : {&sill, &half}) {
        const Stance stance = stance_on(*terrain);
        EXPECT_EQ(stance.plane.slope_x, 0);
        EXPECT_EQ(stance.plane.slope_y, 0);
    }
    const Stance stance = stance_on(half);
    EXPECT_EQ(*stance.feet_tenth_mm[0] - *stance.feet_tenth_mm[1], 150);
}

TEST(Stance, noise_on_level_ground_slopes_only_planes_of_parts) {
    int sloped = 0;
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        std::mt19937_64 random(seed);
        std::normal_distribution<double> noise_m(0.0, 0.004);
        Terrain terrain = shaped([&](double, double) { return noise_m(random); });
        const Stance stance = stance_on(terrain);
        EXPECT_EQ(stance.plane.slope_x, 0) << seed;
        EXPECT_EQ(stance.plane.slope_y, 0) << seed;
        sloped += stance.parts[0].slope_x != 0 ? 1 : 0;
    }
    EXPECT_GT(sloped, 40);
}

TEST(Stance, attested_ground_beside_measured_ground_of_another_height_tilts_nothing) {
    Terrain floor = shaped([](double x, double) { return x > 0.05 ? 0.006 : std::nan(""); });
    const auto map = floor.snapshot();
    const Machine machine = rex();
    Query query = make_query(kForward, 0.0, 0.0, 1.0, 0.0);
    query.attested = {true, 0, 0, 6'000, 0};
    const Sweep sweep = sweep_of(machine, FixedPose{}, machine.movements[kForward]);
    const Stance stance = find_stance(Ground(*map, query, machine.limits), query, sweep, false);
    EXPECT_EQ(stance.plane.slope_x, 0);
    for (const StancePlane& part : stance.parts) EXPECT_EQ(part.slope_x, 0);
}

TEST(Stance, an_edge_ahead_or_beside_the_feet_tilts_nothing) {
    // The feet reach from -0.126 to 0.240 m ahead and to 0.275 m aside.
    const auto on_a_ramp_with = [](double from_x_m, double from_y_m, double height_m) {
        return shaped([=](double x, double y) {
            return kRamp * x + (x > from_x_m || y > from_y_m ? height_m : 0.0);
        });
    };
    for (const double height_m : {-0.2, -0.06, 0.06, 0.7}) {
        for (Terrain& terrain :
             std::array{on_a_ramp_with(0.25, 9.0, height_m), on_a_ramp_with(9.0, 0.28, height_m)}) {
            const Stance stance = stance_on(terrain);
            for (const StancePlane& plane : planes_of(stance)) {
                EXPECT_NEAR(plane.tangents(250).x, kRamp, kRounded) << height_m;
                EXPECT_NEAR(plane.tangents(250).y, 0.0, kRounded) << height_m;
            }
        }
    }
}

TEST(Stance, correlated_noise_on_level_ground_slopes_parts_by_little) {
    // Means of 5 x 5 cells with a standard deviation of 4 mm, as the map of a floor has.
    double worst = 0.0;
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        std::mt19937_64 random(seed);
        std::normal_distribution<double> noise_m(0.0, 0.020);
        Image<double> white(244, 244);
        std::generate_n(white.data(), white.size(), [&] { return noise_m(random); });
        Terrain terrain;
        for (int v = 0; v < 240; ++v) {
            for (int u = 0; u < 240; ++u) {
                double sum_m = 0.0;
                for (int k = 0; k < 25; ++k) sum_m += white.at(u + k % 5, v + k / 5);
                terrain.height.at(u, v) = static_cast<float>(sum_m / 25.0);
            }
        }
        for (const StancePlane& part : stance_on(terrain).parts)
            worst = std::max(worst, std::abs(part.tangents(250).x));
    }
    EXPECT_GT(worst, 0.001);
    // The toes land 0.64 m ahead, so that the limit of a step (20 mm) is kept.
    EXPECT_LT(worst, 0.020 / 0.64);
}

TEST(Stance, treads_are_level_and_unknown_ground_gives_no_stance) {
    Terrain terrain = ramp(-9.0);
    const Stance level = stance_on(terrain, 0.0, true);
    EXPECT_EQ(level.plane.slope_x, 0);
    for (const StancePlane& part : level.parts) EXPECT_EQ(part.slope_x, 0);
    Terrain unknown = shaped([](double, double) { return std::nan(""); });
    EXPECT_FALSE(stance_on(unknown).known);
}

TEST(Ramp, of_1_in_12_is_walked_up_and_down_in_full_steps) {
    for (const double rise : {kRamp, -kRamp}) {
        Terrain terrain = ramp(-9.0, rise);
        expect_ok(ask(terrain, kForward));  // the toes land 53 mm higher than base_link stands
        expect_ok(ask(terrain, kBackward));
        expect_ok(ask(terrain, kLeft));
    }
}

TEST(Ramp, is_entered_and_left_only_in_steps_that_keep_the_limit_of_a_step) {
    // The toes reach 0.64 m ahead: on a ramp that begins 0.42 m ahead they land 18 mm higher.
    Terrain late = ramp(0.42);
    expect_ok(ask(late, kForward));
    Terrain early = ramp(0.35);  // 24 mm
    expect_refused(ask(early, kForward), Reason::step_too_high);
    // From the ramp back to the floor: the floor lies above the continued ramp.
    Terrain behind = ramp(-0.13);
    expect_refused(ask(behind, kBackward), Reason::step_too_high);
    // From the floor down a ramp.
    Terrain down = ramp(0.35, -kRamp);
    expect_refused(ask(down, kForward), Reason::step_too_low);
}

TEST(Ramp, that_begins_under_the_feet_is_not_left_backward_in_a_full_step) {
    // The toes may stand firm on the ramp. Then the floor behind lies 20 to 33 mm above its plane.
    for (const double start_m : {-0.1, -0.05, 0.0, 0.04}) {
        for (const double yaw : {0.0, 0.5, 1.571, -2.4}) {
            Terrain terrain = ramp(start_m, kRamp, yaw);
            const Query query = make_query(kBackward, 0.0, 0.0, std::cos(yaw), std::sin(yaw));
            const Verdict verdict = decide(rex(), query, *terrain.snapshot(), kReady, kNowNs);
            EXPECT_TRUE(verdict.reasons.contains(Reason::step_too_high)) << start_m << " " << yaw;
        }
    }
}

TEST(Ramp, a_step_on_it_counts_from_the_ramp) {
    const auto with_step = [](double height_m) {
        return shaped([=](double x, double) { return kRamp * x + (x > 0.26 ? height_m : 0.0); });
    };
    Terrain low = with_step(0.015);
    expect_ok(ask(low, kForward));
    Terrain high = with_step(0.026);
    expect_refused(ask(high, kForward), Reason::step_too_high);
    Terrain hole = with_step(-0.026);
    expect_refused(ask(hole, kForward), Reason::step_too_low);
    Terrain obstacle = with_step(0.05);
    EXPECT_TRUE(ask(obstacle, kForward).reasons.contains(Reason::corridor_blocked));
}

TEST(Ramp, that_only_most_of_the_ground_shows_must_allow_the_step_as_level_ground_must) {
    // Every third row of cells under the feet is level. So the sure slope is zero, and the floor
    // behind lies 19 mm lower; but it lies more than 20 mm higher than the ramp that most rows
    // show.
    constexpr double kSteep = 0.1;
    Terrain terrain = ramp(-0.13, kSteep);
    for (int v = 0; v < 240; v += 3) {
        for (int u = 0; u < 240; ++u) {
            const double x_m = terrain.geometry.center_m({u, v}).x();
            if (x_m > -0.13 && x_m < 0.25) terrain.height.at(u, v) = 0.019F;
        }
    }
    const Stance stance = stance_on(terrain);
    EXPECT_EQ(stance.plane.slope_x, 0);
    EXPECT_GT(stance.parts[1].tangents(250).x, 0.8 * kSteep);
    expect_refused(ask(terrain, kBackward), Reason::step_too_high);
}

TEST(Ramp, whose_slope_breaks_the_tilt_limit_is_refused) {
    Terrain terrain = ramp(-9.0, 0.125);  // 7.1 deg
    expect_refused(ask(terrain, kForward), Reason::slope);
}

}  // namespace
}  // namespace surefoot::gate::testing
