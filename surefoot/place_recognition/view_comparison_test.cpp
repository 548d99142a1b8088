// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/view_comparison.hpp"

#include <gtest/gtest.h>

#include "surefoot/place_recognition/place_views_testing.hpp"

namespace surefoot::place_recognition {
namespace {

using testing::Corner;
using testing::random_corners;
using testing::view_of;

constexpr double kNoise_px = 0.3;
constexpr int kCorners = 500;
const Pose kElsewhere{exp_so3({0.0, 0.0, 0.15}), {0.2, -0.15, 0.02}};

Comparison compare_level(const View& candidate, const View& query) {
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    return compare({}, candidate, up, query, up);
}

TEST(ViewComparison, FindsWhereTheSamePlaceIsSeenFrom) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const auto corners = random_corners(kCorners, seed);
        const auto c = compare_level(view_of(corners, {}, kNoise_px, 10 + seed),
                                     view_of(corners, kElsewhere, kNoise_px, 20 + seed));
        ASSERT_EQ(c.refusal, Refusal::none) << seed;
        const Vector6 e = difference(kElsewhere, c.T_candidate_query);
        EXPECT_LT(e.head<3>().norm(), 0.01) << seed;
        EXPECT_LT(e.tail<3>().norm(), 0.003) << seed;
        EXPECT_LT(e.dot(c.covariance.inverse() * e), 40.0) << seed;
        EXPECT_GT(c.agreeing_share(), 0.8) << seed;
        EXPECT_EQ(c.parts_against, 0) << seed;
    }
}

TEST(ViewComparison, RefusesAnotherPlace) {
    const auto c = compare_level(view_of(random_corners(kCorners, 1), {}, kNoise_px, 1),
                                 view_of(random_corners(kCorners, 2), {}, kNoise_px, 2));
    EXPECT_EQ(c.refusal, Refusal::few_matches);
}

/// The same doors in another corridor: a share of the corners, all on one side, is the same.
TEST(ViewComparison, RefusesALookAlikeOfWhichAPartIsTheSame) {
    const auto here = random_corners(kCorners, 1);
    auto there = random_corners(kCorners, 2);
    int same = 0;
    for (std::size_t i = 0; i < here.size(); ++i) {
        if (here[i].p_map_m.y() < -0.2) continue;  // everything to the right differs
        there[i] = here[i];
        ++same;
    }
    ASSERT_GT(same, kCorners / 3);
    const auto c =
        compare_level(view_of(here, {}, kNoise_px, 1), view_of(there, kElsewhere, kNoise_px, 2));
    EXPECT_EQ(c.refusal, Refusal::contradicted);
    EXPECT_GT(c.inliers, 60) << "the part that is the same was found";
    EXPECT_LT(difference(kElsewhere, c.T_candidate_query).head<3>().norm(), 0.02);
    EXPECT_GT(c.parts_against, c.parts / 5);
}

/// Only the texture of the floor differs, all over the image.
TEST(ViewComparison, RefusesALookAlikeOfWhichOnlyEveryThirdCornerIsTheSame) {
    const auto here = random_corners(kCorners, 1);
    auto there = random_corners(kCorners, 2);
    for (std::size_t i = 0; i < here.size(); i += 3) there[i] = here[i];
    const auto c =
        compare_level(view_of(here, {}, kNoise_px, 1), view_of(there, kElsewhere, kNoise_px, 2));
    EXPECT_EQ(c.refusal, Refusal::contradicted);
    EXPECT_LT(c.agreeing_share(), 0.4);
}

constexpr double kFloor_m = -0.95;  ///< height of the floor in the map
const Pose kLookingDown{exp_so3({0.0, 0.5, 0.0}), {0.0, 0.0, 0.0}};

/// A floor before the machine, and `things` corners of objects that stand on it.
std::vector<Corner> room(int things, std::uint64_t seed) {
    Rng rng(seed);
    std::vector<Corner> corners;
    const auto add = [&](double least_m, double most_m) {
        const double x_m = rng.uniform(1.2, 4.5);
        const double y_m = rng.uniform(-2.0, 2.0);
        corners.push_back(
            {{x_m, y_m, rng.uniform(least_m, most_m)}, testing::random_descriptor(rng)});
    };
    for (int i = 0; i < things; ++i) add(-0.5, 0.4);
    for (int i = 0; i < 400; ++i) add(kFloor_m, kFloor_m);
    return corners;
}

/// Returns the corners with all objects moved on the floor.
std::vector<Corner> moved(std::vector<Corner> corners, const Eigen::Vector3d& way_m) {
    for (Corner& corner : corners)
        if (corner.p_map_m.z() > kFloor_m) corner.p_map_m += way_m;
    return corners;
}

/// Both views with a pitched camera, the second one from another position.
Comparison compare_floors(const std::vector<Corner>& here, const std::vector<Corner>& there) {
    const Pose T_map_query = kElsewhere * kLookingDown;
    const auto up = [](const Pose& T_map_body) -> Eigen::Vector3d {
        return T_map_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    };
    return compare({},
                   view_of(here, kLookingDown, kNoise_px, 1),
                   up(kLookingDown),
                   view_of(there, T_map_query, kNoise_px, 2),
                   up(T_map_query));
}

TEST(ViewComparison, AFloorAndWhatStandsOnItAreRecognised) {
    const auto c = compare_floors(room(120, 1), room(120, 1));
    EXPECT_EQ(c.refusal, Refusal::none);
    EXPECT_GT(c.asked_off_floor, 50);
    EXPECT_LT(c.asked_off_floor, c.asked / 2) << "the floor was counted";
    EXPECT_GT(c.agreeing_off_floor, c.asked_off_floor / 2);
}

/// All floors of one house have the same print, but it lies elsewhere under the doors.
TEST(ViewComparison, RefusesAFloorUnderOtherThings) {
    const auto here = room(60, 1);
    const auto c = compare_floors(here, moved(here, {0.1, 0.3, 0.0}));
    EXPECT_EQ(c.refusal, Refusal::floor_only);
    const Pose T_here_there = kLookingDown.inverse() * kElsewhere * kLookingDown;
    EXPECT_LT(difference(T_here_there, c.T_candidate_query).head<3>().norm(), 0.02)
        << "the floor was found";
    EXPECT_GT(c.agreeing_share(), 0.5);
    EXPECT_GT(c.asked_off_floor, 30);
    EXPECT_LT(c.agreeing_off_floor, c.asked_off_floor / 10);
}

/// Without other visible objects the comparison cannot decide.
TEST(ViewComparison, RefusesAFloorThatStandsAlone) {
    const auto c = compare_floors(room(0, 1), room(0, 1));
    EXPECT_EQ(c.refusal, Refusal::floor_only);
    EXPECT_GT(c.agreeing_share(), 0.8);
    EXPECT_LT(c.asked_off_floor, 15);
}

TEST(ViewComparison, RefusesWhatAgreesInOneSpotOnly) {
    auto corners = random_corners(300, 1);
    const Eigen::Vector3d middle_m(3.5, 0.0, 0.0);
    for (Corner& corner : corners) corner.p_map_m = middle_m + 0.1 * (corner.p_map_m - middle_m);
    const auto c =
        compare_level(view_of(corners, {}, kNoise_px, 1), view_of(corners, {}, kNoise_px, 2));
    EXPECT_EQ(c.refusal, Refusal::poor_spread);
}

TEST(ViewComparison, RefusesAPoseAgainstGravity) {
    const auto corners = random_corners(kCorners, 1);
    const auto view = view_of(corners, {}, kNoise_px, 1);
    const auto again = view_of(corners, kElsewhere, kNoise_px, 2);
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d leaning = exp_so3({0.07, 0.0, 0.0}) * up;  // 4 deg
    const auto c = compare({}, view, up, again, leaning);
    EXPECT_EQ(c.refusal, Refusal::tilted);
    EXPECT_NEAR(c.tilt_deg, 4.0, 0.3);
    // If the odom of the first run is tilted in the same way, the comparison is correct.
    EXPECT_EQ(compare({}, view, leaning, again, kElsewhere.rotation.conjugate() * leaning).refusal,
              Refusal::none);
}

TEST(ViewComparison, TheSameViewsGiveTheSameBytes) {
    const auto corners = random_corners(kCorners, 1);
    const auto a = view_of(corners, {}, kNoise_px, 1);
    const auto b = view_of(corners, kElsewhere, kNoise_px, 2);
    const auto first = compare_level(a, b);
    const auto second = compare_level(a, b);
    EXPECT_EQ(first.T_candidate_query.matrix(), second.T_candidate_query.matrix());
    EXPECT_EQ(first.covariance, second.covariance);
}

TEST(ViewComparison, SurvivesEmptyViews) {
    const View empty{0, testing::test_rig(), {}};
    const auto full = view_of(random_corners(kCorners, 1), {}, kNoise_px, 1);
    EXPECT_EQ(compare_level(empty, full).refusal, Refusal::few_matches);
    EXPECT_EQ(compare_level(full, empty).refusal, Refusal::few_matches);
}

}  // namespace
}  // namespace surefoot::place_recognition
