// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/place_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "surefoot/odometry/synthetic_testing.hpp"

namespace surefoot::place_recognition {
namespace {

using odometry::testing::render_camera;

constexpr double kNoise_grey = 1.0;
constexpr double kStep_m = 0.26;

/// A lens without distortion, so that its images are already rectified.
camera::Camera camera() {
    camera::PinholeRadTan lens;
    lens.fx_px = lens.fy_px = 220.0;
    lens.cx_px = 176.0;
    lens.cy_px = 112.0;
    return {lens, 352, 224};
}

camera::RectifiedRig rectified() {
    camera::RectifiedRig rig;
    rig.width = 352;
    rig.height = 224;
    rig.fx_px = rig.fy_px = 220.0;
    rig.cx_px = 176.0;
    rig.cy_px = 112.0;
    rig.baseline_m = 0.12;
    rig.T_body_camera = T_body_optical();
    return rig;
}

/// Shows a tracker the view from poses of the body in the map. `T_odom_of(i, T_map_body)` is the
/// odometry's pose.
class Walker {
  public:
    explicit Walker(Place saved = {}) : tracker_({}, std::move(saved)) {}

    /// `negative`: a place of the same shape with the appearance of its photographic negative.
    std::optional<Sighting> step(const Pose& T_map_body,
                                 const Pose& T_odom_body,
                                 bool negative = false) {
        const Pose T_world_camera = T_body_optical().inverse() * T_map_body * T_body_optical();
        Rng rng(mix_seed(7, static_cast<std::uint64_t>(frames_)));
        Image<float> depth_m;
        GreyImage left = render_camera(camera(), T_world_camera, kNoise_grey, rng, &depth_m);
        DepthImage depth;
        depth.resize(left.width(), left.height());
        for (std::size_t i = 0; i < left.size(); ++i) {
            if (negative) left.data()[i] = static_cast<std::uint8_t>(255 - left.data()[i]);
            depth.disparity_px.data()[i] = 220.0F * 0.12F / depth_m.data()[i];
            depth.sigma_px.data()[i] = 0.2F;
            depth.outlier_probability.data()[i] = 0.0F;
        }
        MotionEstimate motion;
        motion.time_ns = 1'000'000'000LL * ++frames_;
        motion.T_odom_body = T_odom_body;
        motion.T_previous_body = T_odom_previous_.inverse() * T_odom_body;
        motion.relative_covariance = 4e-4 * Matrix6::Identity();  // 2 cm, 1.1 deg
        motion.health = health_;
        T_odom_previous_ = T_odom_body;
        tracker_.follow(motion);
        return tracker_.see(rectified(), left.view(), depth);
    }
    void set_health(Health health) { health_ = health; }
    [[nodiscard]] const PlaceTracker& tracker() const { return tracker_; }

  private:
    PlaceTracker tracker_;
    int frames_ = 0;
    Health health_ = Health::ok;
    Pose T_odom_previous_;
};

/// `steps` poses to the left of the origin.
Pose sideways(double steps) {
    return {Eigen::Quaterniond::Identity(), {0.0, kStep_m * steps, 0.0}};
}

Place first_run() {
    Walker walker;
    for (int i = 0; i < 6; ++i) walker.step(sideways(i), sideways(i));
    return walker.tracker().place();
}

TEST(PlaceTracker, TheFirstRunsMapIsItsOdom) {
    Walker walker;
    EXPECT_EQ(walker.tracker().T_map_odom()->matrix(), Pose{}.matrix());
    const auto first = walker.step(sideways(0), sideways(0));
    ASSERT_TRUE(first);
    EXPECT_EQ(first->refusal, Refusal::no_candidate);
    EXPECT_FALSE(walker.step(sideways(0.5), sideways(0.5))) << "too near for a keyframe";
    for (int i = 1; i < 6; ++i) {
        walker.step(sideways(i), sideways(i));
        EXPECT_EQ(walker.tracker().T_map_odom()->matrix(), Pose{}.matrix());
    }
    EXPECT_EQ(walker.tracker().place().keyframes.size(), 6U);
    EXPECT_FALSE(walker.tracker().place().problem());
}

TEST(PlaceTracker, FindsASavedPlaceAfterTwoKeyframesThatAgree) {
    Walker walker(first_run());
    const Pose T_map_odom{exp_so3({0.0, 0.0, 1.1}), {3.0, -2.0, 0.05}};
    EXPECT_FALSE(walker.tracker().T_map_odom());
    for (int i = 0; i < 5; ++i) {
        const Pose T_map_body =
            sideways(0.4 + i) * Pose{exp_so3({0.0, 0.0, 0.05}), {0.1, 0.0, 0.02}};
        const auto seen = walker.step(T_map_body, T_map_odom.inverse() * T_map_body);
        ASSERT_TRUE(seen);
        EXPECT_EQ(seen->refusal, i < 1 ? Refusal::unconfirmed : Refusal::none) << i;
        EXPECT_EQ(seen->T_map_odom.has_value(), i >= 1) << i;
        EXPECT_EQ(walker.tracker().T_map_odom().has_value(), i >= 1) << i;
    }
    const Vector6 e = difference(T_map_odom, *walker.tracker().T_map_odom());
    EXPECT_LT(e.head<3>().norm(), 0.08) << "3.6 m from the origin of odom";
    EXPECT_LT(e.tail<3>().norm(), 0.015);
}

TEST(PlaceTracker, DoesNotTakeAnotherPlaceForTheSavedOne) {
    const Place saved = first_run();
    Walker walker(saved);
    for (int i = 0; i < 6; ++i) {
        const auto seen = walker.step(sideways(i), sideways(i), true);
        ASSERT_TRUE(seen);
        EXPECT_NE(seen->refusal, Refusal::none);
        EXPECT_NE(seen->refusal, Refusal::unconfirmed);
    }
    EXPECT_FALSE(walker.tracker().T_map_odom());
    EXPECT_EQ(walker.tracker().place().keyframes.size(), saved.keyframes.size())
        << "keyframes with unknown pose in the map are not added";
}

TEST(PlaceTracker, AnswersThatDisagreeAreNotBelieved) {
    Walker walker(first_run());
    for (int i = 0; i < 6; ++i) {
        // Odometry reports a step to the right, but the machine stepped to the left.
        const auto seen = walker.step(sideways(0.4 + i), sideways(-2.0 * i));
        ASSERT_TRUE(seen);
        EXPECT_EQ(seen->refusal, Refusal::unconfirmed) << i;
    }
    EXPECT_FALSE(walker.tracker().T_map_odom());
}

TEST(PlaceTracker, WhatIsSeenAnewIsAddedToThePlaceWhereItBelongs) {
    const Place saved = first_run();
    Walker walker(saved);
    const Pose T_map_odom{exp_so3({0.0, 0.0, -0.7}), {1.0, 0.5, 0.0}};
    for (int i = 0; i < 12; ++i)
        walker.step(sideways(0.4 + i), T_map_odom.inverse() * sideways(0.4 + i));
    const Place grown = walker.tracker().place();
    EXPECT_GT(grown.keyframes.size(), saved.keyframes.size() + 3);
    EXPECT_LT(grown.keyframes.size(), saved.keyframes.size() + 12)
        << "known views are not added again";
    const Pose& T_map_last = grown.keyframes.back().T_map_body;
    EXPECT_LT(difference(sideways(11.4), T_map_last).head<3>().norm(), 0.1);
}

TEST(PlaceTracker, ARunThatComesBackCorrectsItsDriftAndLeavesOdomAlone) {
    Walker walker;
    std::optional<Sighting> seen;
    double bias_m = 0.0;
    const auto go = [&](double steps) {
        bias_m += 0.01;  // forward, with every keyframe
        const Pose T_odom_body =
            sideways(steps) * Pose{Eigen::Quaterniond::Identity(), {bias_m, 0.0, 0.0}};
        seen = walker.step(sideways(steps), T_odom_body);
        return *walker.tracker().T_map_odom() * T_odom_body;
    };
    for (int i = 0; i < 10; ++i) go(i);
    Pose T_map_body;
    for (int i = 9; i >= 1; --i) T_map_body = go(i - 0.4);
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->refusal, Refusal::none);
    EXPECT_FALSE(seen->saved);
    // The bias of the first keyframe is that of the map.
    EXPECT_LT(std::abs(T_map_body.translation_m.x() - 0.01), 0.04);
    EXPECT_GT(bias_m, 0.18) << "and odom has this error";
}

TEST(PlaceTracker, WhileOdometryIsLostNothingIsRemembered) {
    Walker walker;
    walker.set_health(Health::lost);
    EXPECT_FALSE(walker.step(sideways(0), sideways(0)));
    EXPECT_EQ(walker.tracker().keyframes(), 0);
    walker.set_health(Health::ok);
    EXPECT_TRUE(walker.step(sideways(1), sideways(1)));
}

TEST(PlaceTracker, TheSameRunGivesTheSameBytes) {
    const Place a = first_run();
    const Place b = first_run();
    ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
    for (std::size_t i = 0; i < a.keyframes.size(); ++i) {
        const auto& fa = a.keyframes[i].view.features;
        const auto& fb = b.keyframes[i].view.features;
        ASSERT_EQ(fa.size(), fb.size());
        for (std::size_t k = 0; k < fa.size(); ++k) {
            EXPECT_EQ(fa[k].pixel_px, fb[k].pixel_px);
            EXPECT_EQ(fa[k].descriptor, fb[k].descriptor);
        }
    }
}

}  // namespace
}  // namespace surefoot::place_recognition
