// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/point_front_end.hpp"

#include <gtest/gtest.h>

#include "surefoot/core/unknown.hpp"
#include "surefoot/odometry/odometry.hpp"
#include "surefoot/odometry/synthetic_testing.hpp"

namespace surefoot::odometry {
namespace {

constexpr double kNoise_px = 0.3;

camera::Rectifier small_rectifier() {
    return std::move(camera::Rectifier::make(testing::small_rig())).value();
}

/// Curve at 0.3 m/s and up to 0.4 rad/s, 20 Hz.
Pose truth_at(int index) {
    const double t = 0.05 * index;
    return {exp_so3({0.10 * std::sin(2.0 * t), 0.15 * std::sin(1.3 * t), 0.12 * std::sin(1.7 * t)}),
            {0.2 * std::sin(1.1 * t), 0.08 * std::sin(1.9 * t), 0.15 * t}};
}

/// Sixty points 2 to 4 m ahead, observed by the left camera at `truth_at(index)` and by the right
/// one.
PointFrame seen_at(const camera::Rectifier& rectifier, int index, double noise_px) {
    const Pose T_left_rectified =
        testing::small_rig().body_from_left().inverse() * rectifier.rig().T_body_camera;
    const Pose T_world_camera = truth_at(index) * T_left_rectified;
    Rng scene(5);
    Rng noise(mix_seed(6, static_cast<std::uint64_t>(index)));
    const auto pixel = [&](camera::Side side, const Eigen::Vector3d& p) -> Eigen::Vector2d {
        const double u = noise_px * noise.normal();
        return rectifier.raw_from_point(side, p).value() +
               Eigen::Vector2d(u, noise_px * noise.normal());
    };
    PointFrame frame;
    frame.time_ns = 1'000'000'000LL + index * 50'000'000LL;
    for (std::int64_t id = 100; id < 160; ++id) {
        const double x = 2.0 * scene.uniform() - 1.0;
        const double y = 1.0 * scene.uniform() - 0.5;
        const Eigen::Vector3d p =
            T_world_camera.inverse() * Eigen::Vector3d(x, y, 2.0 + 2.0 * scene.uniform());
        frame.points.push_back({id, pixel(camera::Side::left, p), pixel(camera::Side::right, p)});
    }
    return frame;
}

OdometryConfig point_config() {
    OdometryConfig config;
    config.sigma_px = kNoise_px;
    return config;
}

TEST(PointFrontEnd, APointIsTheLandmarkOfItsId) {
    const auto rectifier = small_rectifier();
    const PointFrame frame = seen_at(rectifier, 0, 0.0);
    LandmarkMap map({}, rectifier);
    PointFrontEnd front(rectifier);
    Serial serial;
    front.load(frame.points);
    front.follow(map, Pose{}, serial);
    EXPECT_TRUE(front.tracks().empty());
    map.add_keyframe(Pose{});
    EXPECT_EQ(front.seed(map, serial), 60);
    EXPECT_EQ(front.seed(map, serial), 0);  // each point only once

    std::vector<SeenPoint> points{frame.points[7], frame.points[3], frame.points[7]};
    points[1].raw_right_px.reset();
    points.push_back({999, frame.points[5].raw_left_px, std::nullopt});  // an unknown point
    front.load(points);
    front.follow(map, Pose{}, serial);
    ASSERT_EQ(front.tracks().size(), 2U);  // the second observation of one id does not count
    EXPECT_EQ(front.tracks()[0].slot, 7);
    EXPECT_EQ(front.tracks()[1].slot, 3);
    EXPECT_FALSE(front.tracks()[0].pixel_px.hasNaN());
    EXPECT_TRUE(std::isnan(front.tracks()[1].pixel_px.z()));
    EXPECT_EQ(front.seed(map, serial), 0);  // no depth, no landmark

    map.remove(7);  // removed: created again under the same id
    front.load(frame.points);
    EXPECT_EQ(front.seed(map, serial), 1);
}

/// The lenses of such a rig do not change any pixel.
camera::StereoRig rig_of_rectified_images() {
    camera::PinholeRadTan lens;
    lens.fx_px = lens.fy_px = 220.0;
    lens.cx_px = 175.0;
    lens.cy_px = 110.0;
    camera::StereoRig rig;
    rig.left = {lens, 352, 224};
    rig.right = rig.left;
    rig.T_left_right.translation_m = {0.12, 0.0, 0.0};
    rig.rectified = true;
    return rig;
}

TEST(PointFrontEnd, WhatCannotBeMeasuredIsLeftOut) {
    for (const auto& rig : {testing::small_rig(), rig_of_rectified_images()}) {
        const auto rectifier = std::move(camera::Rectifier::make(rig)).value();
        std::vector<SeenPoint> points;
        for (std::int64_t id = 0; id < 4; ++id) {
            const Eigen::Vector3d p(0.1 * static_cast<double>(id), 0.1, 2.0);
            points.push_back({id,
                              rectifier.raw_from_point(camera::Side::left, p).value(),
                              rectifier.raw_from_point(camera::Side::right, p)});
        }
        points[0].raw_left_px.x() = kNan;
        points[1].raw_right_px->y() = kNan;
        *points[2].raw_right_px += Eigen::Vector2d(0.0, 5.0);  // rows that differ
        LandmarkMap map({}, rectifier);
        map.add_keyframe(Pose{});
        PointFrontEnd front(rectifier);
        Serial serial;
        front.load(points);
        EXPECT_EQ(front.seed(map, serial), 1);
        EXPECT_TRUE(map.at(0).p_odom_m.isApprox(Eigen::Vector3d(0.3, 0.1, 2.0), 0.05));
        points[3].raw_left_px.x() = kNan;
        front.load(points);
        front.follow(map, Pose{}, serial);
        EXPECT_TRUE(front.tracks().empty());
    }
}

TEST(PointFrontEnd, RowsOfARollingShutterAreBroughtToTheStamp) {
    camera::StereoRig rig = rig_of_rectified_images();
    rig.readout_s = 0.03;
    const auto rectifier = std::move(camera::Rectifier::make(rig)).value();
    Vector6 velocity;
    velocity << 0.2, -0.1, 0.4, 0.3, -0.5, 0.2;
    const Eigen::Vector3d p(0.4, 0.5, 2.0);
    SeenPoint seen;  // pixel at the exposure time of its row
    for (int round = 0; round < 8; ++round) {
        const double offset_s = rectifier.row_offset_s(seen.raw_left_px.y());
        const Eigen::Vector3d p_then = perturbed(Pose{}, velocity * offset_s).inverse() * p;
        seen.raw_left_px = rectifier.raw_from_point(camera::Side::left, p_then).value();
        seen.raw_right_px = rectifier.raw_from_point(camera::Side::right, p_then);
    }
    Serial serial;
    const StereoPixel at_stamp = project_stereo(rectifier.rig(), p);
    for (const bool known : {true, false}) {
        LandmarkMap map({}, rectifier);
        map.add_keyframe(Pose{});
        PointFrontEnd front(rectifier);
        if (known) front.move(velocity);
        front.load({&seen, 1});
        ASSERT_EQ(front.seed(map, serial), 1);
        const double seeded_px = (front.tracks()[0].pixel_px - at_stamp).norm();
        front.follow(map, Pose{}, serial);
        const double followed_px = (front.tracks()[0].pixel_px - at_stamp).norm();
        EXPECT_EQ(seeded_px < 0.02, known) << seeded_px;
        EXPECT_EQ(followed_px < 0.02, known) << followed_px;
        EXPECT_GT(seeded_px, 1e-6);
    }
}

TEST(LandmarkMap, PointsWithoutALookOutliveTheKeyframeThatSawThemFirst) {
    const auto rectifier = small_rectifier();
    LandmarkMapConfig config;
    config.most_keyframes = 3;
    LandmarkMap map(config, rectifier);
    map.add_keyframe(Pose{});
    const StereoPixel pixel = project_stereo(rectifier.rig(), {0.1, 0.0, 2.0});
    const int slot = map.add_point(pixel);
    const int unseen = map.add_point(pixel);
    EXPECT_LT((map.at(slot).p_odom_m - Eigen::Vector3d(0.1, 0.0, 2.0)).norm(), 1e-9);
    EXPECT_FALSE(map.predict_view(map.at(slot), camera::Side::left, Pose{}));
    for (int i = 0; i < 3; ++i) {
        map.add_keyframe(Pose{});
        map.add_sighting(slot, pixel, 1.0);
    }
    EXPECT_GE(map.at(slot).id, 0);
    EXPECT_LT(map.at(unseen).id, 0);
}

TEST(PointOdometry, FollowsAHandHeldCurve) {
    const auto rectifier = small_rectifier();
    const camera::StereoRig rig = testing::small_rig();
    Odometry odometry(point_config(), rectifier);
    odometry.start_at(rig.body_from_left().inverse());
    double worst_m = 0.0;
    for (int i = 0; i < 60; ++i) {
        PointFrame frame = seen_at(rectifier, i, kNoise_px);
        // One point in five has a wrong id in this frame.
        for (std::size_t k = static_cast<std::size_t>(i % 5); i > 0 && k + 5 < 60; k += 5)
            std::swap(frame.points[k].id, frame.points[k + 5].id);
        const MotionEstimate m = odometry.update(frame);
        const Pose T = m.T_odom_body * rig.body_from_left();
        worst_m = std::max(worst_m, (T.translation_m - truth_at(i).translation_m).norm());
        if (i > 0) {
            EXPECT_EQ(m.health, Health::ok) << "frame " << i << " " << to_string(m.reason);
        }
    }
    std::printf("worst position error %.2f mm\n", 1e3 * worst_m);
    EXPECT_LT(worst_m, 0.010);
}

/// Gates for half the noise would exclude a third of the points.
TEST(PointOdometry, TwiceTheExpectedNoiseCostsNoPoints) {
    const auto rectifier = small_rectifier();
    const auto mean_inliers = [&](double expected_px) {
        OdometryConfig config;
        config.sigma_px = expected_px;
        Odometry odometry(config, rectifier);
        odometry.start_at(testing::small_rig().body_from_left().inverse());
        double sum = 0.0;
        for (int i = 0; i < 80; ++i) {
            const MotionEstimate m = odometry.update(seen_at(rectifier, i, kNoise_px));
            if (i >= 40) sum += m.inliers / 40.0;
        }
        return sum;
    };
    const double half = mean_inliers(0.5 * kNoise_px);
    const double all = mean_inliers(kNoise_px);
    std::printf("of 60 points agree: %.1f, half of the noise expected %.1f\n", all, half);
    EXPECT_GT(half, 0.95 * all);
}

TEST(PointOdometry, FramesWithoutPointsAreLostForWantOfTracks) {
    const auto rectifier = small_rectifier();
    Odometry odometry(point_config(), rectifier);
    for (int i = 0; i < 20; ++i) {
        PointFrame frame = seen_at(rectifier, std::max(i - 2, 0), kNoise_px);
        const bool empty = i < 2 || (i >= 10 && i < 13);
        frame.time_ns += i < 2 ? i - 2 : 0;
        if (empty) frame.points.clear();
        const MotionEstimate m = odometry.update(frame);
        EXPECT_TRUE(m.T_odom_body.all_finite());
        // The first frame with points finds no landmark yet. The frame after a LOST one says so.
        const bool recovered = i == 3 || i == 13;
        EXPECT_EQ(m.health,
                  empty || i == 2 ? Health::lost
                  : recovered     ? Health::degraded
                                  : Health::ok)
            << i;
        if (empty) {
            EXPECT_EQ(m.reason, HealthReason::few_tracks) << i;
        }
    }
}

TEST(PointOdometry, AChangeToImagesAndBackCostsOneFrame) {
    const auto rectifier = small_rectifier();
    Odometry odometry(point_config(), rectifier);
    Serial serial;
    Pose T_before;
    for (int i = 0; i < 15; ++i) {
        const bool images = i >= 5 && i < 10;
        const MotionEstimate m =
            images ? odometry.update(
                         testing::render_frame(testing::small_rig(), truth_at(i), i, 2.0), serial)
                   : odometry.update(seen_at(rectifier, i, kNoise_px));
        const bool first_after = i == 6 || i == 11;
        const Health wanted = i == 0 || first_after ? Health::degraded
                              : i == 5 || i == 10   ? Health::lost
                                                    : Health::ok;
        EXPECT_EQ(m.health, wanted) << i << " " << to_string(m.reason);
        if (i > 0) {
            EXPECT_LT(difference(T_before * m.T_previous_body, m.T_odom_body).norm(), 1e-9);
        }
        T_before = m.T_odom_body;
    }
}

}  // namespace
}  // namespace surefoot::odometry
