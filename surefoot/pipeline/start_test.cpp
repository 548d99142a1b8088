// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/start.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "surefoot/camera/rigs_testing.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::pipeline {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr double kFocal_px = 120.0;
constexpr double kHeight_m = 1.0;

/// A camera one metre above the ground, pitched down by 40 deg.
camera::StereoRig looking_down() {
    camera::StereoRig rig = camera::test::ideal_rig(kWidth, kHeight, kFocal_px);
    const Eigen::AngleAxisd pitch(40.0 * M_PI / 180.0, Eigen::Vector3d::UnitY());
    rig.T_body_left =
        Pose{Eigen::Quaterniond(pitch) * rig.body_from_left().rotation, Eigen::Vector3d::Zero()};
    return rig;
}

/// Depth image of a level floor, or of a wall two metres ahead that fills the view, for a tilted
/// base_link.
DepthImage depth_of(const camera::RectifiedRig& rig,
                    bool floor,
                    const Eigen::Quaterniond& lean = Eigen::Quaterniond::Identity()) {
    DepthImage depth;
    depth.disparity_px = Image<float>(rig.width, rig.height, 0.0F);
    depth.sigma_px = Image<float>(rig.width, rig.height, 0.2F);
    depth.outlier_probability = Image<float>(rig.width, rig.height, 0.0F);
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const Eigen::Vector3d ray =
                lean * rig.T_body_camera.rotation *
                Eigen::Vector3d((u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0);
            const double z_m = floor ? -kHeight_m / ray.z() : 2.0 / ray.x();
            if (z_m > 0.0) {
                depth.disparity_px.row(v)[u] =
                    static_cast<float>(rig.depth_to_disparity_px_m() / z_m);
            }
        }
    }
    return depth;
}

/// Content of the frames of a source by index, at ten frames per second.
struct Script {
    int frames = 0;
    std::function<std::uint8_t(int)> grey_dn;
    std::function<bool(int)> floor;
    std::function<void(int, GreyImage&)> paint = [](int, GreyImage&) {};
    Eigen::Quaterniond lean = Eigen::Quaterniond::Identity();
};

struct Outcome {
    Start start;
    Alignment alignment;
};

Outcome start_of(const Script& script,
                 const PipelineConfig& config,
                 const camera::StereoRig& rig = looking_down()) {
    Serial serial;
    auto pipeline = Pipeline::make(config, rig, serial);
    EXPECT_TRUE(pipeline.ok()) << pipeline.error().message;
    int next = 0;
    const auto source = [&]() -> std::optional<StereoFrame> {
        if (next == script.frames) return std::nullopt;
        StereoFrame frame;
        frame.index = next++;
        frame.time_ns = 1'000'000'000 + frame.index * 100'000'000LL;
        frame.left = GreyImage(kWidth, kHeight, script.grey_dn(frame.index));
        script.paint(frame.index, frame.left);
        frame.right = frame.left;
        frame.known_depth = depth_of(pipeline->rig(), script.floor(frame.index), script.lean);
        MotionEstimate standing;
        standing.time_ns = frame.time_ns;
        standing.health = Health::ok;
        frame.known_motion = standing;
        return frame;
    };
    Outcome outcome{align_when_ready(*pipeline, source), {}};
    outcome.alignment = pipeline->alignment();
    return outcome;
}

std::uint8_t mid_grey(int /*index*/) {
    return 128;
}
bool always(int /*index*/) {
    return true;
}

TEST(Start, TheFirstFramesServeWhereTheyAreGood) {
    const Outcome outcome = start_of({30, mid_grey, always}, {});
    EXPECT_EQ(outcome.start.waited_frames, 0);
    ASSERT_EQ(outcome.start.frames.size(), Pipeline::kAlignmentFrames);
    EXPECT_EQ(outcome.start.frames.front().index, 0);
    ASSERT_TRUE(outcome.alignment.has_ground) << outcome.alignment.reason;
    EXPECT_NEAR(outcome.alignment.ground_height_m, kHeight_m, 1e-3);
}

/// No earlier check has marked these frames; the pipeline uses its own result.
TEST(Start, AnOldImageIsMarked) {
    const auto noise = [](int index, GreyImage& image) {
        const bool old = index == 3 || index == 4;
        Rng rng(mix_seed(7, static_cast<std::uint64_t>(old ? 2 : index)));
        for (int v = 0; v < image.height(); ++v)
            for (int u = 0; u < image.width(); ++u)
                image.at(u, v) = static_cast<std::uint8_t>(100.0 + 50.0 * rng.uniform());
    };
    const Outcome outcome = start_of({30, mid_grey, always, noise}, {});
    ASSERT_EQ(outcome.start.frames.size(), Pipeline::kAlignmentFrames);
    for (const StereoFrame& frame : outcome.start.frames) {
        EXPECT_EQ(frame.frame_status.repeated,
                  frame.index == 3   ? 1
                  : frame.index == 4 ? 2
                                     : 0)
            << frame.index;
    }
}

TEST(Start, OverexposedFramesAreWaitedOut) {
    const auto sun = [](int index) -> std::uint8_t { return index < 40 ? 255 : 128; };
    const Outcome outcome = start_of({60, sun, [](int index) { return index >= 40; }}, {});
    EXPECT_EQ(outcome.start.waited_frames, 40);
    ASSERT_EQ(outcome.start.frames.size(), Pipeline::kAlignmentFrames);
    EXPECT_EQ(outcome.start.frames.front().index, 40);
    EXPECT_TRUE(outcome.alignment.has_ground);
}

TEST(Start, AFlickerBeginsTheWaitAnew) {
    const auto flicker = [](int index) -> std::uint8_t {
        return index < 5 || index == 12 ? 255 : 128;
    };
    const Outcome outcome = start_of({60, flicker, always}, {});
    EXPECT_EQ(outcome.start.frames.front().index, 13) << "ten lit frames in a row are wanted";
}

TEST(Start, TheWaitForLightEnds) {
    PipelineConfig config;
    config.mount.wait_for_exposure_s = 2.0;
    const auto night = [](int /*index*/) -> std::uint8_t { return 0; };
    const Outcome outcome = start_of({60, night, always}, config);
    EXPECT_EQ(outcome.start.frames.back().index, 20) << "two seconds";
    EXPECT_FALSE(outcome.alignment.has_ground) << "no plane from dark frames";
    EXPECT_EQ(outcome.alignment.gravity_source, grid::GravitySource::assumed);
}

TEST(Start, WhatIsThereWhenTheSourceEndsIsKept) {
    const auto sun = [](int /*index*/) -> std::uint8_t { return 255; };
    EXPECT_EQ(start_of({4, sun, always}, {}).start.frames.size(), 4U);
    const Outcome longer = start_of({25, sun, always}, {});
    EXPECT_EQ(longer.start.frames.back().index, 24);
    EXPECT_EQ(longer.start.waited_frames, 15);
    EXPECT_TRUE(start_of({0, sun, always}, {}).start.frames.empty());
}

TEST(Start, GroundIsLookedForWhereTheMachineSaysThereIsSome) {
    const auto wall_first = [](int index) { return index >= 30; };
    PipelineConfig config;
    config.mount.pitch_deg = 0.0;
    const Outcome anywhere = start_of({80, mid_grey, wall_first}, config);
    EXPECT_EQ(anywhere.start.waited_frames, 0) << "a recording may show no ground at all";
    EXPECT_FALSE(anywhere.alignment.has_ground);

    config.ground.expected_height_m = kHeight_m;
    const Outcome machine = start_of({80, mid_grey, wall_first}, config);
    EXPECT_TRUE(machine.alignment.has_ground) << machine.alignment.reason;
    // Five of ten sightings must agree, and the window moves by five: the start comes immediately,
    // at most 2 s later.
    EXPECT_EQ(machine.start.waited_frames, 25);

    config.mount.wait_for_ground_s = 1.5;
    const Outcome impatient = start_of({80, mid_grey, wall_first}, config);
    EXPECT_FALSE(impatient.alignment.has_ground);
    EXPECT_LE(impatient.start.frames.back().index, 20);
}

/// A person holds the camera: the mounting is unknown, and the camera points at a wall first.
TEST(Start, GroundIsLookedForWithAMountThatNobodyKnows) {
    Script script{80, mid_grey, [](int index) { return index >= 20; }};
    script.lean = Eigen::AngleAxisd(40.0 * M_PI / 180.0, Eigen::Vector3d::UnitY());
    const camera::StereoRig rig = camera::test::ideal_rig(kWidth, kHeight, kFocal_px);
    const Outcome found = start_of(script, {}, rig);
    ASSERT_TRUE(found.alignment.has_ground) << found.alignment.reason;
    EXPECT_EQ(found.start.waited_frames, 15);
    EXPECT_EQ(found.start.frames.size(), Pipeline::kAlignmentFrames);
    EXPECT_EQ(found.start.frames.front().index, 15);

    script.floor = [](int /*index*/) { return false; };
    const Outcome none = start_of(script, {}, rig);
    EXPECT_FALSE(none.alignment.has_ground);
    EXPECT_EQ(none.start.waited_frames, 0) << "nothing of the recording is lost";
    EXPECT_EQ(none.start.frames.size(), 40U) << "ten, and those of three seconds";
    EXPECT_EQ(none.start.frames.front().index, 0);

    PipelineConfig impatient;
    impatient.mount.wait_for_search_s = 0.0;
    EXPECT_EQ(start_of(script, impatient, rig).start.frames.size(), Pipeline::kAlignmentFrames);
}

/// Returns the state of the camera after each of 70 frames of a standing machine; from the 20th
/// frame on the camera points 3 deg lower.
std::vector<CameraState> states_when_knocked(double expected_height_m) {
    Serial serial;
    PipelineConfig config;
    config.ground.expected_height_m = expected_height_m;
    auto pipeline = Pipeline::make(config, looking_down(), serial);
    EXPECT_TRUE(pipeline.ok()) << pipeline.error().message;
    const Eigen::Quaterniond knock(Eigen::AngleAxisd(3.0 * M_PI / 180.0, Eigen::Vector3d::UnitY()));
    std::vector<CameraState> states;
    for (int i = 0; i < 70; ++i) {
        StereoFrame frame;
        frame.index = i;
        frame.time_ns = 1'000'000'000 + i * 100'000'000LL;
        MotionEstimate motion;
        motion.time_ns = frame.time_ns;
        motion.health = Health::ok;
        if (i >= 20) motion.T_odom_body.rotation = knock;
        frame.known_depth = depth_of(pipeline->rig(), true, motion.T_odom_body.rotation);
        frame.known_motion = motion;
        if (i == 0) pipeline->align({&frame, 1});
        states.push_back(pipeline->process(frame, Work::full).camera);
    }
    return states;
}

TEST(Start, TheMountIsWatchedOnAMachine) {
    const auto machine = states_when_knocked(kHeight_m);
    EXPECT_EQ(machine[19], CameraState::ok);
    for (const std::size_t i : {20U, 30U, 50U})
        EXPECT_EQ(machine[i], CameraState::leaning) << "at once, for the time being";
    EXPECT_EQ(machine[69], CameraState::moved);
    const auto in_hand = states_when_knocked(0.0);
    EXPECT_EQ(in_hand[69], CameraState::ok) << "a camera in the hand has no mount";
}

}  // namespace
}  // namespace surefoot::pipeline
