// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/front_end.hpp"

#include <gtest/gtest.h>

#include <map>

#include "surefoot/core/rng.hpp"
#include "surefoot/odometry/synthetic_testing.hpp"

namespace surefoot::odometry {
namespace {

using testing::render_frame;

camera::Rectifier small_rectifier() {
    return std::move(camera::Rectifier::make(testing::small_rig())).value();
}

TEST(CornerDetector, SpreadsCornersAndKeepsItsDistance) {
    const StereoFrame frame = render_frame(testing::small_rig(), Pose{}, 0, 0.0);
    CornerConfig config;
    config.most = 200;
    Serial serial;
    Backwards backwards;
    std::vector<Eigen::Vector2d> corners;
    std::vector<Eigen::Vector2d> again;
    const std::vector<Eigen::Vector2d> occupied{{100.0, 100.0}, {200.0, 50.0}};
    detect_corners(frame.left.view(), occupied, config, serial, corners);
    detect_corners(frame.left.view(), occupied, config, backwards, again);
    EXPECT_EQ(corners, again);
    EXPECT_GT(corners.size(), 100U);
    EXPECT_LE(corners.size(), 200U);
    for (const auto& corner : corners)
        for (const auto& p : occupied) EXPECT_GE((corner - p).norm(), config.min_distance_px - 1.5);
}

TEST(CornerDetector, FlatTinyAndEmptyImagesHaveNone) {
    Serial serial;
    std::vector<Eigen::Vector2d> corners{{1.0, 1.0}};
    detect_corners(GreyImage(352, 224, 90).view(), {}, {}, serial, corners);
    EXPECT_TRUE(corners.empty());
    detect_corners(GreyImage(9, 7, 90).view(), {}, {}, serial, corners);
    EXPECT_TRUE(corners.empty());
    detect_corners(GreyImage().view(), {}, {}, serial, corners);
    EXPECT_TRUE(corners.empty());
}

TEST(KltTracker, FollowsAKnownShiftForAnyExecutor) {
    const StereoFrame a = render_frame(testing::small_rig(), Pose{}, 0, 1.0);
    GreyImage moved(a.left.width(), a.left.height());
    for (int v = 0; v < moved.height(); ++v)
        for (int u = 0; u < moved.width(); ++u)
            moved.at(u, v) =
                a.left.at(std::min(u + 6, moved.width() - 1), std::min(v + 3, moved.height() - 1));
    ImagePyramid from;
    ImagePyramid to;
    from.build(a.left.view());
    to.build(std::as_const(moved).view());
    std::vector<KltRequest> requests;
    for (int i = 0; i < 150; ++i) {
        const Eigen::Vector2f at(40.0F + 1.7F * static_cast<float>(i),
                                 30.0F + static_cast<float>(i));
        requests.push_back({at, at});
    }
    Serial serial;
    Backwards backwards;
    std::vector<KltResult> results;
    std::vector<KltResult> again;
    track_points(from, to, requests, {}, serial, results);
    track_points(from, to, requests, {}, backwards, again);
    int found = 0;
    for (std::size_t i = 0; i < requests.size(); ++i) {
        EXPECT_EQ(results[i].px, again[i].px);
        if (!results[i].found) continue;
        found += 1;
        EXPECT_LT((results[i].px - requests[i].from_px - Eigen::Vector2f(-6.0F, -3.0F)).norm(),
                  0.1F)
            << i;
    }
    EXPECT_GT(found, 120);
}

TEST(KltTracker, SharpnessFallsWithDarkness) {
    StereoFrame frame = render_frame(testing::small_rig(), Pose{}, 0, 1.0);
    ImagePyramid pyramid;
    EXPECT_EQ(pyramid.sharpness(), 0.0);
    pyramid.build(std::as_const(frame).left.view());
    const double sharp = pyramid.sharpness();
    frame.left.fill(5);
    pyramid.build(std::as_const(frame).left.view());
    EXPECT_LT(pyramid.sharpness(), 0.01 * sharp);
}

/// Corners of the scene, compared with its exact depth.
TEST(StereoPoints, MatchedDepthIsTheDepthOfTheScene) {
    const auto rectifier = small_rectifier();
    const StereoFrame frame = render_frame(testing::small_rig(), Pose{}, 0, 1.0);
    const Pose T_left_rectified =
        testing::small_rig().body_from_left().inverse() * rectifier.rig().T_body_camera;
    Serial serial;
    std::vector<Eigen::Vector2d> corners;
    detect_corners(frame.left.view(), {}, {}, serial, corners);
    int matched = 0;
    int close = 0;
    for (const auto& corner : corners) {
        const auto pixel =
            match_corner(rectifier, frame.left.view(), frame.right.view(), corner, {});
        if (!pixel) continue;
        matched += 1;
        const Eigen::Vector3d p = T_left_rectified * triangulate(rectifier.rig(), *pixel);
        double grey = 0.0;
        const Eigen::Vector3d ray = p.normalized();
        const double truth_m = testing::cast_ray(Eigen::Vector3d::Zero(), ray, grey);
        const StereoPixel ideal = project_stereo(
            rectifier.rig(), T_left_rectified.inverse() * Eigen::Vector3d(truth_m * ray));
        close += std::abs(disparity_px(*pixel) - disparity_px(ideal)) < 0.5 ? 1 : 0;
    }
    EXPECT_GT(matched, 80);
    EXPECT_GE(close, matched * 95 / 100);  // the rest lies across the edge between two walls
}

TEST(StereoPoints, CornersTellWhichEyeSawThem) {
    const auto rectifier = small_rectifier();
    const StereoFrame frame = render_frame(testing::small_rig(), Pose{}, 0, 1.0);
    const auto left = frame.left.view();
    const auto right = frame.right.view();
    Serial serial;
    const auto count = [&](ImageView<const std::uint8_t> image,
                           ImageView<const std::uint8_t> other) {
        std::vector<Eigen::Vector2d> corners;
        detect_corners(image, {}, {}, serial, corners);
        std::map<std::optional<camera::Side>, int> cameras;
        for (const auto& corner : corners)
            cameras[camera_of_corner(rectifier, image, other, corner, {})] += 1;
        return cameras;
    };
    auto proper = count(left, right);
    EXPECT_GT(proper[camera::Side::left], 100);
    EXPECT_LT(proper[camera::Side::right], proper[camera::Side::left] / 10);
    auto swapped = count(right, left);
    EXPECT_GT(swapped[camera::Side::right], 100);
    EXPECT_LT(swapped[camera::Side::left], swapped[camera::Side::right] / 10);
    EXPECT_FALSE(camera_of_corner(rectifier, left, right, {1.0, 1.0}, {})) << "no window around it";
    GreyImage noise(frame.right.width(), frame.right.height());
    Rng rng(1);
    for (int v = 0; v < noise.height(); ++v)
        for (int u = 0; u < noise.width(); ++u)
            noise.at(u, v) = static_cast<std::uint8_t>(256.0 * rng.uniform());
    EXPECT_EQ(count(left, std::as_const(noise).view()).size(), 1U) << "no corner shows its camera";
}

TEST(FrontEnd, MakesNothingOfExchangedEyes) {
    const auto rectifier = small_rectifier();
    Serial serial;
    for (const bool swapped : {false, true}) {
        StereoFrame frame = render_frame(testing::small_rig(), Pose{}, 0, 1.0);
        if (swapped) std::swap(frame.left, frame.right);
        LandmarkMap map({}, rectifier);
        map.add_keyframe(Pose{});
        FrontEnd front({}, rectifier);
        ASSERT_TRUE(front.load(frame, serial));
        const int added = front.seed(map, serial);
        EXPECT_EQ(front.cameras_swapped(), swapped);
        EXPECT_EQ(front.tracks().size(), static_cast<std::size_t>(added));
        if (swapped) {
            EXPECT_EQ(added, 0);
        } else {
            EXPECT_GT(added, 80);
        }
    }
}

TEST(StereoPoints, RowsThatDifferAreNoMatch) {
    const auto rectifier = small_rectifier();
    const Eigen::Vector3d p(0.2, 0.1, 2.0);
    const Eigen::Vector2d left = *rectifier.raw_from_point(camera::Side::left, p);
    const Eigen::Vector2d right = *rectifier.raw_from_point(camera::Side::right, p);
    const auto pixel = stereo_pixel(rectifier, left, right, {});
    ASSERT_TRUE(pixel);
    EXPECT_LT((triangulate(rectifier.rig(), *pixel) - p).norm(), 1e-6);
    EXPECT_FALSE(stereo_pixel(rectifier, left, right + Eigen::Vector2d(0.0, 2.0), {}));
    EXPECT_FALSE(stereo_pixel(rectifier, left, left + Eigen::Vector2d(9.0, 0.0), {}));  // negative
}

TEST(StereoPoints, RepeatingTextureIsRefused) {
    const auto rectifier = small_rectifier();
    GreyImage stripes(352, 224);
    for (int v = 0; v < 224; ++v)
        for (int u = 0; u < 352; ++u)
            stripes.at(u, v) = static_cast<std::uint8_t>(((u / 6) + (v / 6)) % 2 == 0 ? 40 : 200);
    int matched = 0;
    for (int u = 150; u < 250; u += 5)
        if (match_corner(rectifier,
                         std::as_const(stripes).view(),
                         std::as_const(stripes).view(),
                         Eigen::Vector2d(u, 110.0),
                         {}))
            matched += 1;
    EXPECT_EQ(matched, 0);
    for (int u = 150; u < 250; u += 5) {
        const auto view = std::as_const(stripes).view();
        EXPECT_FALSE(camera_of_corner(rectifier, view, view, Eigen::Vector2d(u, 110.0), {})) << u;
    }
}

TEST(StereoPoints, DepthEdgesAndHolesAreRefused) {
    const auto rectifier = std::move(camera::Rectifier::make(testing::small_depth_rig())).value();
    Image<float> depth(352, 224, 2.0F);
    for (int v = 0; v < 224; ++v)
        for (int u = 200; u < 352; ++u) depth.at(u, v) = 3.0F;
    depth.at(100, 100) = std::numeric_limits<float>::quiet_NaN();
    const auto pixel = depth_pixel(rectifier, depth, {150.0, 110.0}, {});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(triangulate(rectifier.rig(), *pixel).z(), 2.0, 1e-6);
    EXPECT_FALSE(depth_pixel(rectifier, depth, {199.6, 110.0}, {}));
    EXPECT_FALSE(depth_pixel(rectifier, depth, {100.0, 100.0}, {}));
    EXPECT_FALSE(depth_pixel(rectifier, depth, {0.0, 0.0}, {}));
    EXPECT_FALSE(depth_pixel(rectifier, Image<float>(), {50.0, 50.0}, {}));
}

TEST(StereoProjection, PixelMotionIsTheDerivativeByTime) {
    const camera::RectifiedRig rig = testing::rectified_rig();
    const Eigen::Vector3d p(0.4, -0.3, 1.7);
    Vector6 velocity;
    velocity << 0.3, -0.2, 0.5, 0.4, -0.6, 0.2;
    constexpr double kDt_s = 1e-5;
    const Pose after = perturbed(Pose{}, velocity * kDt_s);
    const StereoPixel moved = project_stereo(rig, after.inverse() * p) - project_stereo(rig, p);
    EXPECT_LT((pixel_motion(rig, p, velocity, kDt_s) - moved).norm(), 1e-3 * moved.norm());
    EXPECT_GT(moved.norm(), 1e-4);
}

TEST(LandmarkMap, PredictedViewIsTheDerivativeOfTheProjection) {
    const auto rectifier = small_rectifier();
    const StereoFrame frame = render_frame(testing::small_rig(), Pose{}, 0, 0.0);
    LandmarkMap map({}, rectifier);
    map.add_keyframe(Pose{});
    const Eigen::Vector3d p(0.2, 0.1, 2.0);
    const Eigen::Vector2d raw = *rectifier.raw_from_point(camera::Side::left, p);
    const auto slot = map.add_landmark(frame.left.view(), raw, project_stereo(rectifier.rig(), p));
    ASSERT_TRUE(slot);
    EXPECT_LT((map.at(*slot).p_odom_m - p).norm(), 1e-9);
    const Pose T{exp_so3({0.02, 0.05, 0.3}), {0.1, -0.05, 0.4}};
    for (const auto side : {camera::Side::left, camera::Side::right}) {
        const auto view = map.predict_view(map.at(*slot), side, T);
        ASSERT_TRUE(view);
        // A neighbour of the host pixel, on the host's plane z = 2 m, in this view.
        const Eigen::Vector2d step(1.0, -0.5);
        const Eigen::Vector2d px = *rectifier.rectified_from_raw(camera::Side::left, raw + step);
        const auto& rig = rectifier.rig();
        const Eigen::Vector3d q(
            2.0 * (px.x() - rig.cx_px) / rig.fx_px, 2.0 * (px.y() - rig.cy_px) / rig.fy_px, 2.0);
        const Eigen::Vector2d moved =
            *rectifier.raw_from_point(side, T.inverse() * q) - view->raw_px;
        EXPECT_LT((view->host_from_view * moved - step).norm(), 0.02);
    }
    EXPECT_FALSE(
        map.predict_view(map.at(*slot), camera::Side::left, Pose{exp_so3({0.0, 3.1, 0.0}), {}}));
}

TEST(LandmarkMap, ForgetsWhatItMustAndNeverWhatIsUsed) {
    const auto rectifier = small_rectifier();
    const StereoFrame frame = render_frame(testing::small_rig(), Pose{}, 0, 0.0);
    LandmarkMapConfig config;
    config.most_landmarks = 5;
    config.most_keyframes = 3;
    LandmarkMap map(config, rectifier);
    map.add_keyframe(Pose{});
    for (int i = 0; i < 10; ++i) {
        const Eigen::Vector3d p(0.05 * i - 0.2, 0.0, 2.0);
        ASSERT_TRUE(map.add_landmark(frame.left.view(),
                                     *rectifier.raw_from_point(camera::Side::left, p),
                                     project_stereo(rectifier.rig(), p)));
    }
    std::vector<std::uint8_t> in_use(10, 0);
    in_use[0] = in_use[9] = 1;
    map.limit(in_use);
    int alive = 0;
    for (int slot = 0; slot < map.slots(); ++slot) alive += map.at(slot).id >= 0 ? 1 : 0;
    EXPECT_EQ(alive, 5);
    EXPECT_GE(map.at(0).id, 0);
    EXPECT_GE(map.at(9).id, 0);
    for (int i = 0; i < 3; ++i) map.add_keyframe(Pose{});  // the first keyframe is removed
    EXPECT_EQ(map.keyframes(), 3);
    for (int slot = 0; slot < map.slots(); ++slot) EXPECT_LT(map.at(slot).id, 0);
}

}  // namespace
}  // namespace surefoot::odometry
