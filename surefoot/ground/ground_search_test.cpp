// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/ground_search.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "surefoot/core/angles.hpp"
#include "surefoot/ground/ground_views_testing.hpp"

namespace surefoot::ground {
namespace {

using test::Block;
using test::Camera;
using test::Errors;

double tilt_error_deg(const GroundSighting& found, const Eigen::Vector3d& up) {
    const Eigen::Vector3d& n = found.observation.normal;
    return kDegPerRad * std::atan2(n.cross(up).norm(), n.dot(up));
}

GroundSighting find(const test::View& view) {
    return search_ground({}, view.seen, 1);
}

TEST(GroundSearch, FindsTheFloorAtAnyTiltAndHeight) {
    for (const double pitch_deg : {0.0, 15.0, 30.0, 45.0, 60.0}) {
        for (const double height_m : {0.3, 0.7, 1.2, 2.0}) {
            SCOPED_TRACE(testing::Message() << pitch_deg << " deg, " << height_m << " m");
            std::vector<Block> room;
            test::add_room(2.0 + 3.0 * height_m, 2.5, room);
            const Camera camera{
                .height_m = height_m, .pitch_deg = pitch_deg, .roll_deg = 0.1 * pitch_deg};
            const auto view = test::view_of(room, true, camera, {}, 7);
            const GroundSighting found = find(view);
            ASSERT_TRUE(found.observation.accepted) << to_string(found.reason);
            const double sigma_deg = kDegPerRad * found.uncertainty.tilt_sigma_rad();
            constexpr double kSigmas = 3.7;  // one of 1000 pairs of angles is farther off
            EXPECT_LT(tilt_error_deg(found, view.up), kSigmas * sigma_deg);
            EXPECT_LT(sigma_deg, 0.6);
            EXPECT_NEAR(found.observation.height_m, height_m, 0.03 * height_m);
        }
    }
}

/// A wall fills the rest of the view.
TEST(GroundSearch, FindsAStripOfFloorBeforeAWall) {
    int found = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const std::vector<Block> wall{{{2.5, 0.0, 1.5}, {1.0, 20.0, 3.0}}};
        const auto view = test::view_of(
            wall, true, {.height_m = 1.3, .pitch_deg = 12.0}, {.matched_share = 0.7}, seed);
        ASSERT_GT(view.floor_share, 0.1);
        ASSERT_LT(view.floor_share, 0.25);
        const GroundSighting sighting = find(view);
        if (!sighting.observation.accepted) continue;
        EXPECT_NEAR(sighting.observation.height_m, 1.3, 0.1) << seed;
        ++found;
    }
    EXPECT_GE(found, 8);
}

TEST(GroundSearch, FindsGroundAsRoughAsMulch) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const auto view = test::view_of(
            {}, true, {.height_m = 1.1, .pitch_deg = 23.0}, {.relief_m = 0.023}, seed);
        const GroundSighting found = find(view);
        ASSERT_TRUE(found.observation.accepted) << seed << to_string(found.reason);
        EXPECT_LT(tilt_error_deg(found, view.up), 2.0) << seed;
    }
}

/// The result must be the floor beside it, or nothing.
TEST(GroundSearch, ATableOrABedIsNotTheGround) {
    struct Decoy {
        double top_m;
        Block block;
    };
    const Decoy decoys[] = {
        {0.75, {{0.8, 0.0, 0.735}, {0.9, 1.4, 0.03}}},
        {0.55, {{1.2, 0.3, 0.275}, {2.0, 1.6, 0.55}}},
    };
    for (const Decoy& decoy : decoys) {
        for (std::uint64_t seed = 1; seed <= 10; ++seed) {
            std::vector<Block> room{decoy.block};
            test::add_room(3.0, 2.0, room);
            const auto view = test::view_of(
                room, true, {.height_m = decoy.top_m + 0.6, .pitch_deg = 40.0}, {}, seed);
            const GroundSighting found = find(view);
            if (!found.observation.accepted) continue;
            EXPECT_NEAR(found.observation.height_m, decoy.top_m + 0.6, 0.06) << seed;
        }
    }
}

/// Wrong matches lie below a small floor one by one. The floor under a table lies there in one
/// piece.
TEST(GroundSearch, WrongMatchesAreNotLowerGround) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const std::vector<Block> wall{{{0.72, 0.0, 1.5}, {1.0, 20.0, 3.0}}};
        const Camera camera{.baseline_m = 0.12, .height_m = 0.6, .pitch_deg = 50.0};
        const auto view = test::view_of(wall, true, camera, {.wrong_share = 0.03}, seed);
        ASSERT_GT(view.floor_share, 0.08);
        ASSERT_LT(view.floor_share, 0.25);
        const GroundSighting found = find(view);
        EXPECT_TRUE(found.observation.accepted) << seed << to_string(found.reason);
    }
}

TEST(GroundSearch, AWallIsNotTheGround) {
    for (const double pitch_deg : {-20.0, 0.0, 20.0}) {
        const std::vector<Block> wall{{{2.5, 0.0, 0.0}, {1.0, 20.0, 40.0}}};
        const auto view =
            test::view_of(wall, false, {.height_m = 1.2, .pitch_deg = pitch_deg}, {}, 3);
        const GroundSighting found = find(view);
        EXPECT_FALSE(found.observation.accepted) << pitch_deg;
        EXPECT_LT(found.image_share, 0.04) << "and does not look like floor";
    }
}

TEST(GroundSearch, OneLevelOfAKerb) {
    // The camera stands on the lower level.
    const std::vector<Block> kerb{{{2.2, 0.0, 0.05}, {1.4, 10.0, 0.1}}};
    const auto view = test::view_of(kerb, true, {.height_m = 1.0, .pitch_deg = 32.0}, {}, 4);
    const GroundSighting found = find(view);
    ASSERT_TRUE(found.observation.accepted);
    EXPECT_LT(tilt_error_deg(found, view.up), 1.0);
}

TEST(GroundSearch, StatesItsError) {
    double nees_tilt = 0.0;
    double nees_height = 0.0;
    constexpr int kViews = 60;
    Rng rng(11);
    for (int i = 0; i < kViews; ++i) {
        std::vector<Block> room;
        test::add_room(rng.uniform(1.5, 4.0), 1.5, room);
        const Camera camera{.height_m = rng.uniform(0.5, 1.8),
                            .pitch_deg = rng.uniform(10.0, 55.0)};
        const auto view = test::view_of(room, true, camera, {}, static_cast<std::uint64_t>(i));
        const GroundSighting found = find(view);
        ASSERT_TRUE(found.observation.accepted) << i;
        Eigen::Matrix<double, 3, 2> across;
        across.col(0) = view.up.unitOrthogonal();
        across.col(1) = view.up.cross(across.col(0));
        const Eigen::Vector2d error = across.transpose() * found.observation.normal;
        const Eigen::Matrix2d covariance =
            across.transpose() * found.uncertainty.normal_covariance * across;
        nees_tilt += error.dot(covariance.inverse() * error) / 2.0 / kViews;
        const double off_m = found.observation.height_m - camera.height_m;
        nees_height += off_m * off_m / found.uncertainty.height_var_m2 / kViews;
    }
    EXPECT_GT(nees_tilt, 0.5);
    EXPECT_LT(nees_tilt, 1.6);
    EXPECT_GT(nees_height, 0.4);
    EXPECT_LT(nees_height, 1.7);
}

TEST(GroundSearch, NothingIsFoundInNothing) {
    EXPECT_EQ(search_ground({}, {}, 1).reason, GroundReason::few_points);
    FramePoints broken = with_nominal_noise(
        std::vector<Eigen::Vector3d>(100, Eigen::Vector3d::Constant(std::nan(""))), {});
    EXPECT_EQ(search_ground({}, broken, 1).reason, GroundReason::few_points);
}

TEST(GroundSearch, SameSeedGivesTheSameBytes) {
    const auto view = test::view_of({}, true, {}, {}, 5);
    const GroundSighting first = find(view);
    const GroundSighting again = find(view);
    EXPECT_EQ(first.observation.normal, again.observation.normal);
    EXPECT_EQ(first.observation.height_m, again.observation.height_m);
    EXPECT_EQ(first.uncertainty.normal_covariance, again.uncertainty.normal_covariance);
}

}  // namespace
}  // namespace surefoot::ground
