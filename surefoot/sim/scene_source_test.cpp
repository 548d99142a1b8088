// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scene_source.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <string>

#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/sensors/cameras_testing.hpp"
#include "surefoot/sim/sensors/sensor_scenes_testing.hpp"

namespace surefoot::sim {
namespace {

/// Small images, for speed.
SceneOptions small(const std::string& scene) {
    SceneOptions options;
    options.scene = scene;
    options.rig = test::small_rig();
    return options;
}

std::vector<StereoFrame> all_frames(const SceneOptions& options) {
    auto source = open_scene(options).value();
    std::vector<StereoFrame> frames;
    while (auto frame = source->next().value()) frames.push_back(std::move(*frame));
    return frames;
}

TEST(SceneSourceTest, FramesComeInOrderWithTheirTruth) {
    SceneOptions options = small("floor");
    options.rate_hz = 15.0;
    options.frames = 20;
    auto source = open_scene(options).value();
    EXPECT_EQ(source->info().kind, "sim");
    EXPECT_EQ(source->info().frames, 20);
    EXPECT_EQ(source->rig().rate_hz, 15.0);
    ASSERT_EQ(source->truth().trajectory.size(), 20U);
    std::int64_t previous_ns = 0;
    int index = 0;
    while (auto frame = source->next().value()) {
        EXPECT_EQ(frame->index, index);
        EXPECT_GT(frame->time_ns, previous_ns);
        EXPECT_EQ(frame->time_ns,
                  source->truth().trajectory[static_cast<std::size_t>(index)].time_ns);
        EXPECT_EQ(frame->left.width(), 168);
        EXPECT_EQ(frame->right.height(), 94);
        EXPECT_TRUE(frame->depth_m.empty());
        EXPECT_EQ(source->last_depth_m().width(), 168);
        previous_ns = frame->time_ns;
        ++index;
    }
    EXPECT_EQ(index, 20);
    EXPECT_FALSE(source->next().value());  // the end stays the end
}

TEST(SceneSourceTest, TheWholePathIsTheDefault) {
    SceneOptions options = small("floor");
    options.rate_hz = 5.0;
    const auto source = open_scene(options).value();
    const auto& poses = source->truth().trajectory;
    const double drive_m = drawn_number(make_scene("floor", options.seed).value(), "drive_m");
    EXPECT_NEAR(poses.back().T_world_body.translation_m.x(), drive_m, 0.011);
    EXPECT_EQ(*source->info().frames, static_cast<int>(poses.size()));
}

TEST(SceneSourceTest, KnowsTheJointsOfAWalkingMachineWhoeverKnocksItsCamera) {
    SceneOptions options = small("walk_floor");
    options.sensor = Sensor::analytic;
    const auto walk = open_scene(options).value();
    options.knock.at_s = 1.0;
    options.knock.roll_deg = 5.0;
    const auto knocked = open_scene(options).value();
    double most_rad = 0.0;
    for (const StampedPose& now : walk->truth().trajectory) {
        const auto joints = walk->rex_joints(now.time_ns);
        ASSERT_TRUE(joints.has_value());
        most_rad = std::max(most_rad, joints->left.knee_rad);
        EXPECT_EQ(joints->in_order(), knocked->rex_joints(now.time_ns)->in_order());
    }
    EXPECT_GT(most_rad, 0.3);
    const auto trolley = open_scene(small("floor")).value();
    EXPECT_FALSE(trolley->rex_joints(trolley->truth().start_ns).has_value());
}

TEST(SceneSourceTest, ImuCoversTheTimeBetweenFramesAndShowsGravity) {
    SceneOptions options = small("floor");
    options.frames = 12;
    const auto frames = all_frames(options);
    std::int64_t last_ns = frames.front().time_ns - 100'000'000;
    for (const StereoFrame& frame : frames) {
        ASSERT_EQ(frame.imu.size(), 20U) << "frame " << frame.index;
        for (const ImuSample& sample : frame.imu) {
            EXPECT_EQ(sample.time_ns, last_ns + 5'000'000);
            last_ns = sample.time_ns;
        }
        EXPECT_EQ(last_ns, frame.time_ns);
    }
    // The trolley stands for the first second. Default biases are 0.02 m/s^2 an axis: 5 sigma.
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const ImuSample& sample : frames[0].imu) mean += sample.specific_force_m_s2 / 20.0;
    EXPECT_NEAR(mean.z(), kGravity_m_s2, 0.1);
    EXPECT_LT(mean.head<2>().norm(), 0.1);
    options.imu = ImuKind::none;
    const auto source = open_scene(options).value();
    EXPECT_FALSE(source->info().has_imu);
    EXPECT_FALSE(source->rig().imu);
    EXPECT_TRUE(source->next().value()->imu.empty());
}

TEST(SceneSourceTest, SameSeedSameBytesOtherSeedOtherImages) {
    SceneOptions options = small("demo_stairs");
    options.frames = 2;
    const auto a = all_frames(options);
    const auto same = all_frames(options);
    options.seed = 2;
    const auto other = all_frames(options);
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].left, same[i].left);
        EXPECT_EQ(a[i].right, same[i].right);
        EXPECT_NE(a[i].left, other[i].left);
    }
    EXPECT_NE(a[0].left, a[1].left);  // noise is new in every frame
    EXPECT_NE(a[0].left, a[0].right);
}

/// Eight frames, half a second from each other: the trolley moves in the later ones.
SceneOptions moving_with(std::vector<InjectedFault> planned) {
    SceneOptions options = small("floor");
    options.rate_hz = 2.0;
    options.frames = 8;
    options.faults.planned = std::move(planned);
    return options;
}

TEST(SceneSourceTest, ADroppedFrameLeavesItsInertialSamplesToTheNext) {
    const auto whole = all_frames(moving_with({}));
    const SceneOptions options = moving_with({{3, ImageFault::dropped, 0}});
    const auto source = open_scene(options).value();
    EXPECT_EQ(source->info().frames, 7);
    EXPECT_EQ(source->faults(), options.faults.planned);
    const auto frames = all_frames(options);
    ASSERT_EQ(frames.size(), 7U);
    EXPECT_EQ(frames[2].left, whole[2].left);
    EXPECT_EQ(frames[3].left, whole[4].left);
    EXPECT_EQ(frames[3].index, 3);
    EXPECT_EQ(frames[3].time_ns, whole[4].time_ns);
    EXPECT_EQ(frames[3].imu.size(), whole[3].imu.size() + whole[4].imu.size());
    EXPECT_EQ(frames[3].imu.front().time_ns, whole[3].imu.front().time_ns);
    EXPECT_EQ(frames[4].imu.size(), whole[5].imu.size());
}

TEST(SceneSourceTest, RepeatedAndFrozenFramesShowTheLastOneDelivered) {
    const auto whole = all_frames(moving_with({}));
    const auto frames = all_frames(moving_with({{2, ImageFault::dropped, 0},
                                                {3, ImageFault::repeated, 0},
                                                {5, ImageFault::frozen, 0},
                                                {6, ImageFault::frozen, 0}}));
    ASSERT_EQ(frames.size(), 7U);
    EXPECT_EQ(frames[2].left, whole[1].left);
    EXPECT_EQ(frames[2].right, whole[1].right);
    EXPECT_EQ(frames[2].time_ns, whole[3].time_ns);
    EXPECT_EQ(frames[3].left, whole[4].left);
    EXPECT_EQ(frames[4].left, whole[4].left);
    EXPECT_EQ(frames[5].left, whole[4].left);
    EXPECT_EQ(frames[6].left, whole[7].left);
}

TEST(SceneSourceTest, ATornFrameContainsBothHalves) {
    constexpr int kRow = 40;
    const auto whole = all_frames(moving_with({}));
    const auto frames = all_frames(moving_with({{6, ImageFault::torn, kRow}}));
    ASSERT_EQ(frames.size(), 8U);
    for (const auto camera : {&StereoFrame::left, &StereoFrame::right}) {
        const GreyImage& torn = frames[6].*camera;
        EXPECT_NE((whole[5].*camera), (whole[6].*camera));
        for (int v = 0; v < torn.height(); ++v) {
            const GreyImage& origin = v < kRow ? whole[6].*camera : whole[5].*camera;
            EXPECT_TRUE(std::equal(torn.row(v), torn.row(v) + torn.width(), origin.row(v))) << v;
        }
    }
    EXPECT_EQ(frames[7].left, whole[7].left);
}

double mean_dn(const GreyImage& image) {
    double sum = 0.0;
    for (std::size_t i = 0; i < image.size(); ++i) sum += image.data()[i];
    return sum / static_cast<double>(image.size());
}

TEST(SceneSourceTest, TheExposureControlHoldsTheMeanAndTheRightEyeItsGain) {
    SceneOptions options = small("floor");
    options.frames = 4;
    options.camera.exposure.automatic = true;
    options.camera.exposure.target_dn = 90.0;
    options.camera.exposure.right_gain = 1.2;
    // Every fourth pixel is metered: the mean of the texture is known to about a grey value.
    for (const StereoFrame& frame : all_frames(options)) {
        EXPECT_NEAR(mean_dn(frame.left), 90.0, 1.5);
        EXPECT_NEAR(mean_dn(frame.right) / mean_dn(frame.left), 1.2, 0.03);
    }
    options.camera.exposure.sun_warm_up = true;
    options.rate_hz = 0.25;  // 0, 4, 8, ... 40 s
    options.frames = 11;
    const auto frames = all_frames(options);
    EXPECT_GT(mean_dn(frames.front().left), 245.0);
    EXPECT_NEAR(mean_dn(frames.back().left), 90.0, 2.0);
}

TEST(SceneSourceTest, ADepthCameraBringsItsImageAndItsDepth) {
    SceneOptions options = small("floor");
    options.rig->right.reset();  // an RGB-D rig brings its own lens
    options.sensor = Sensor::depth_camera;
    // Without the steps of structured light, which swallow all noise at this short focal length.
    options.depth_errors = depth_camera_preset(DepthCameraKind::kinect_v2).config;
    options.frames = 4;
    options.rate_hz = 0.5;  // the floor moves from frame to frame
    options.faults.planned = {{1, ImageFault::torn, 40}, {3, ImageFault::repeated, 0}};
    const auto damaged = all_frames(options);
    options.faults.planned.clear();
    auto source = open_scene(options).value();
    std::vector<StereoFrame> whole;
    while (auto frame = source->next().value()) {
        whole.push_back(std::move(*frame));
        const StereoFrame& now = whole.back();
        EXPECT_TRUE(now.right.empty());
        EXPECT_FALSE(now.known_depth);
        EXPECT_FALSE(now.known_motion);
        ASSERT_EQ(now.depth_m.width(), now.left.width());
        // Up to 1.5 m the model has a sigma of 4 mm; six of them.
        int known = 0;
        for (std::size_t i = 0; i < now.depth_m.size(); ++i) {
            if (!(now.depth_m.data()[i] < 1.5F)) continue;
            ++known;
            EXPECT_NEAR(now.depth_m.data()[i], source->last_depth_m().data()[i], 0.024);
        }
        EXPECT_GT(known, 3000);
    }
    ASSERT_EQ(damaged.size(), 4U);
    EXPECT_EQ(damaged[1].depth_m.at(80, 39), whole[1].depth_m.at(80, 39));
    EXPECT_EQ(damaged[1].depth_m.at(80, 80), whole[0].depth_m.at(80, 80));
    EXPECT_TRUE(test::same_bytes(damaged[3].depth_m, whole[2].depth_m));
    EXPECT_FALSE(test::same_bytes(whole[3].depth_m, whole[2].depth_m));
    SceneOptions kinect = options;
    kinect.rig.reset();
    kinect.depth_camera = DepthCameraKind::kinect_v2;
    EXPECT_EQ(open_scene(kinect).value()->rig().left.width, 512);
    EXPECT_FALSE(open_scene(kinect).value()->rig().right);
}

TEST(SceneSourceTest, TheAnalyticSensorBringsDepthAndMotionAndNoImage) {
    SceneOptions options = small("kerb_down_150");
    options.sensor = Sensor::analytic;
    options.analytic.stride = 2;
    options.frames = 30;
    options.faults.planned = {{20, ImageFault::dropped, 0}};
    Backwards backwards;
    auto source = open_scene(options).value();
    auto other = open_scene(options, &backwards).value();
    EXPECT_TRUE(source->info().modelled_depth);
    EXPECT_TRUE(source->info().modelled_motion);
    const camera::StereoRig& rig = source->rig();
    ASSERT_FALSE(rig.problem());
    EXPECT_EQ(rig.left.width, 84);
    int frames = 0;
    Pose T_odom_last;
    while (auto frame = source->next().value()) {
        const auto same = other->next().value();
        EXPECT_TRUE(frame->left.empty());
        ASSERT_TRUE(frame->known_depth);
        ASSERT_TRUE(frame->known_motion);
        const DepthImage& depth = *frame->known_depth;
        ASSERT_EQ(depth.disparity_px.width(), rig.left.width);
        EXPECT_TRUE(test::same_bytes(depth.disparity_px, same->known_depth->disparity_px));
        EXPECT_EQ(source->last_depth_m().height(), rig.left.height);
        EXPECT_FALSE(frame->imu.empty());
        T_odom_last = frame->known_motion->T_odom_body;
        ++frames;
    }
    EXPECT_EQ(frames, 29);
    const auto& poses = source->truth().trajectory;
    const Pose truth = poses.front().T_world_body.inverse() * poses.back().T_world_body;
    const double error = difference(truth, T_odom_last).norm();
    EXPECT_GT(error, 0.0);
    // Under a metre of way: ten sigma of 1 mm and 0.7 mrad, three axes each.
    EXPECT_LT(error, 0.021);
}

TEST(SceneSourceTest, TheMachineMaySayHowItMoves) {
    SceneOptions options = small("floor");
    options.frames = 4;
    options.rate_hz = 0.5;  // the camera moves between frames
    options.machine_motion = true;
    auto source = open_scene(options).value();
    const auto& poses = source->truth().trajectory;
    for (std::size_t i = 0; i < 4; ++i) {
        const auto frame = source->next().value();
        EXPECT_FALSE(frame->known_motion);
        ASSERT_TRUE(frame->machine_motion);
        if (i == 0) continue;
        const Pose truth = poses[i - 1].T_world_body.inverse() * poses[i].T_world_body;
        const Vector6 error = difference(truth, frame->machine_motion->T_previous_body);
        EXPECT_GT(error.norm(), 0.0);
        const Matrix6& covariance = frame->machine_motion->covariance;
        EXPECT_LT(error.dot(covariance.ldlt().solve(error)), 30.0);  // 6 degrees of freedom
    }
}

TEST(SceneSourceTest, ImagesMayComeWithTheirTrueMotion) {
    SceneOptions options = small("floor");
    options.frames = 3;
    options.rate_hz = 0.5;  // the camera moves between frames
    options.known_motion = true;
    options.drift = {0.0, 0.0};
    auto source = open_scene(options).value();
    EXPECT_TRUE(source->info().modelled_motion);
    EXPECT_FALSE(source->info().modelled_depth);
    const auto& poses = source->truth().trajectory;
    ASSERT_TRUE(source->info().T_odom_first_body);
    EXPECT_EQ(source->info().T_odom_first_body->translation_m, poses[0].T_world_body.translation_m);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto frame = source->next().value();
        EXPECT_FALSE(frame->left.empty());
        EXPECT_FALSE(frame->known_depth);
        const Pose truth = poses.front().T_world_body.inverse() * poses[i].T_world_body;
        EXPECT_LT(difference(truth, frame->known_motion->T_odom_body).norm(), 1e-12);
        EXPECT_TRUE(frame->known_motion->relative_covariance.isZero());
    }
    EXPECT_GT((poses[2].T_world_body.translation_m - poses[0].T_world_body.translation_m).norm(),
              0.01);
}

TEST(SceneSourceTest, NoiseIsAFactorOnModelledDepthsToo) {
    SceneOptions options = small("floor");
    options.sensor = Sensor::analytic;
    options.frames = 1;
    options.analytic.locking_px = 0.0;
    const auto sigma_px = [&] {
        const auto frame = open_scene(options).value()->next().value();
        return frame->known_depth->sigma_px.at(84, 80);
    };
    const float nominal_px = sigma_px();
    options.noise = 2.0;
    EXPECT_FLOAT_EQ(sigma_px(), 2.0F * nominal_px);
}

TEST(SceneSourceTest, APathOfMoreFramesThanASourceCountsIsRefused) {
    const std::string path = ::testing::TempDir() + "surefoot_slow_scene.yaml";
    std::ofstream(path)
        << "name: slow\n"
           "description: a trolley that takes half an hour for 20 m\n"
           "materials:\n"
           "  carpet: {pattern: carpet, albedo: 0.4, contrast: 0.7, texel_m: 0.002}\n"
           "solids:\n"
           "  - floor: {min_x_m: -3, min_y_m: -3, max_x_m: 29, max_y_m: 3, "
           "material: carpet}\n"
           "motion:\n"
           "  speed_m_s: 0.01\n"
           "  waypoints: [{x_m: 0, y_m: 0}, {x_m: 20, y_m: 0}]\n";
    SceneOptions options = small(path);
    options.frames = 0;
    options.rate_hz = 1000.0;
    const auto source = open_scene(options);
    ASSERT_FALSE(source);
    EXPECT_NE(source.error().message.find("at most 1000000 are allowed"), std::string::npos)
        << source.error().message;
    options.frames = 3;
    EXPECT_TRUE(open_scene(options));
    std::remove(path.c_str());
}

TEST(SceneSourceTest, WrongOptionsGetASentence) {
    const auto message = [](const SceneOptions& options) {
        const auto source = open_scene(options);
        if (source) return std::string("no error");
        EXPECT_EQ(source.error().code, ErrorCode::usage);
        return source.error().message;
    };
    SceneOptions unknown_scene = small("stairs_of_penrose");
    EXPECT_NE(message(unknown_scene).find("sim --list"), std::string::npos);
    EXPECT_NE(message(small("demo_stair")).find("demo_stairs"), std::string::npos);
    SceneOptions rate = small("floor");
    rate.rate_hz = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(message(rate).find("rate_hz"), std::string::npos);
    SceneOptions frames = small("floor");
    frames.frames = -1;
    EXPECT_NE(message(frames).find("frames is -1"), std::string::npos);
    SceneOptions rig = small("floor");
    rig.rig->right.reset();
    EXPECT_NE(message(rig).find("right camera"), std::string::npos);
    SceneOptions fault = small("floor");
    fault.frames = 5;
    fault.faults.planned = {{5, ImageFault::dropped, 0}};
    EXPECT_NE(message(fault).find("give a frame from 1 to 4"), std::string::npos);
    SceneOptions no_image = small("floor");
    no_image.sensor = Sensor::analytic;
    no_image.faults.tear_probability = 0.1;
    EXPECT_NE(message(no_image).find("no images that could be torn"), std::string::npos);
    SceneOptions one_camera = small("floor");
    one_camera.sensor = Sensor::analytic;
    one_camera.rig->right.reset();
    EXPECT_NE(message(one_camera).find("sim.sensor = analytic models stereo"), std::string::npos);
    SceneOptions preset;
    preset.rig_preset = "zed_42k";
    EXPECT_NE(message(preset).find("zed_42k"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::sim
