// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/run_session.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {
namespace {

/// A simulated floor whose source throws after some frames, like a library that runs out of memory.
class ThrowingSource final : public camera::FrameSource {
  public:
    ThrowingSource(camera::FrameSource& source, int good_frames)
        : source_(source), good_frames_(good_frames) {}

    [[nodiscard]] const camera::StereoRig& rig() const override { return source_.rig(); }
    [[nodiscard]] const camera::SourceInfo& info() const override { return source_.info(); }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override {
        if (good_frames_-- == 0) throw std::runtime_error("no memory left");
        return source_.next();
    }

  private:
    camera::FrameSource& source_;
    int good_frames_;
};

TEST(RunSession, KeepsWhatWasComputedWhenSomethingThrows) {
    Serial serial;
    sim::SceneOptions options;
    options.scene = "floor";
    auto floor = sim::open_scene(options, &serial);
    ASSERT_TRUE(floor.ok());
    constexpr int kGoodFrames = static_cast<int>(pipeline::Pipeline::kAlignmentFrames) + 2;
    ThrowingSource source(**floor, kGoodFrames);
    auto pipeline = pipeline::Pipeline::make({}, source.rig(), serial, steady_now_ns);
    ASSERT_TRUE(pipeline.ok());
    RunSession session(*pipeline, source, source.rig(), 1, {});
    session.drive();
    const RunRecord& record = session.record();
    ASSERT_TRUE(record.error.has_value());
    EXPECT_NE(record.error->message.find("no memory left"), std::string::npos);
    EXPECT_EQ(record.frames.size(), static_cast<std::size_t>(kGoodFrames));
    EXPECT_GT(pipeline->map().known_cells(), 0);
}

TEST(RunSession, MapsDepthAndMotionThatComeReady) {
    Serial serial;
    sim::SceneOptions options;
    options.scene = "floor";
    options.sensor = sim::Sensor::analytic;
    options.frames = 40;
    options.drift = {0.0, 0.0};
    auto floor = sim::open_scene(options, &serial);
    ASSERT_TRUE(floor.ok());
    auto pipeline = pipeline::Pipeline::make({}, (*floor)->rig(), serial, steady_now_ns);
    ASSERT_TRUE(pipeline.ok());
    RunSession session(*pipeline, **floor, (*floor)->rig(), 1, {});
    session.drive();
    const RunRecord& record = session.record();
    EXPECT_TRUE(record.complete());
    EXPECT_TRUE(record.source.modelled_motion);
    EXPECT_TRUE(pipeline->pair().left.empty());
    ASSERT_EQ(record.frames.size(), 40U);
    // Odom starts at the first body pose of the alignment and moves with the poses of the source.
    const Pose& T_odom_first = pipeline->alignment().T_odom_body;
    const auto& truth = (*floor)->truth().trajectory;
    for (std::size_t i = 0; i < record.frames.size(); ++i) {
        const Pose moved = truth.front().T_world_body.inverse() * truth[i].T_world_body;
        EXPECT_LT(difference(T_odom_first * moved, record.frames[i].motion.T_odom_body).norm(),
                  1e-12);
    }
    // Nominal disparities (0.25 px) are 6 mm of depth at 1 m; the median of the fused map is below.
    EXPECT_LT(record.truth->maps.elevation.median_abs_m, 0.006);
    EXPECT_GT(record.truth->coverage_within_2_5_m, 0.95);
    EXPECT_NEAR(record.truth->depth.within_3_sigma, 0.98, 0.02);
}

// The reference thesis (Lange 2016) lost whole recordings, because it took the ground plane from
// the first, over-exposed seconds in the sun.
TEST(RunSession, TheSunWarmUpDoesNotFoolTheAlignment) {
    Serial serial;
    sim::SceneOptions options;
    options.scene = "floor";
    options.seed = 22;
    options.rate_hz = 2.0;
    options.frames = 70;  // the warm-up takes 10 to 30 s
    options.profile = sim::CameraProfile::zed;
    options.camera.exposure.sun_warm_up = true;
    auto floor = sim::open_scene(options, &serial);
    ASSERT_TRUE(floor.ok()) << floor.error().message;
    auto pipeline = pipeline::Pipeline::make({}, (*floor)->rig(), serial, steady_now_ns);
    ASSERT_TRUE(pipeline.ok());
    RunSession session(*pipeline, **floor, (*floor)->rig(), 1, {});
    session.drive();
    const RunRecord& record = session.record();
    EXPECT_GT(record.waited_frames, 10) << "five seconds at the least";
    ASSERT_EQ(record.frames.size() + static_cast<std::size_t>(record.waited_frames), 70U);
    EXPECT_EQ(record.frames.front().index, record.waited_frames);
    EXPECT_FALSE(record.truth) << "the trolley moved before odom was placed";
    const auto& truth = (*floor)->truth().trajectory;
    const Pose T_world_first = truth[static_cast<std::size_t>(record.waited_frames)].T_world_body;
    const pipeline::Alignment& alignment = pipeline->alignment();
    ASSERT_TRUE(alignment.has_ground) << alignment.reason;
    // Without the wait the error is 21 mm and 0.95 deg. Well-exposed frames must reach 3 mm and
    // 0.15 deg.
    EXPECT_NEAR(alignment.ground_height_m, T_world_first.translation_m.z(), 0.003);
    const Eigen::Vector3d up_by_odom =
        alignment.T_odom_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d up = T_world_first.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    EXPECT_LT(up_by_odom.cross(up).norm(), 0.15 * M_PI / 180.0);
}

TEST(RunSession, FindsEveryRepeatedTornAndFrozenImage) {
    Serial serial;
    sim::SceneOptions options;
    options.scene = "floor";
    options.frames = 26;
    options.faults.planned = {{4, sim::ImageFault::repeated, 0},
                              {13, sim::ImageFault::torn, 100},
                              {16, sim::ImageFault::repeated, 0},
                              {19, sim::ImageFault::frozen, 0},
                              {20, sim::ImageFault::frozen, 0},
                              {21, sim::ImageFault::frozen, 0}};
    auto floor = sim::open_scene(options, &serial);
    ASSERT_TRUE(floor.ok()) << floor.error().message;
    auto pipeline = pipeline::Pipeline::make({}, (*floor)->rig(), serial, steady_now_ns);
    ASSERT_TRUE(pipeline.ok());
    RunSession session(*pipeline, **floor, (*floor)->rig(), 1, {});
    session.drive();
    const RunRecord& record = session.record();
    ASSERT_EQ(record.frames.size(), 26U);
    for (const FrameReport& frame : record.frames) {
        const bool frozen = frame.index >= 19 && frame.index <= 21;
        const int repeated = frozen ? frame.index - 18 : frame.index == 4 || frame.index == 16;
        const bool torn = frame.index == 13;
        EXPECT_EQ(frame.frame_status.repeated, repeated) << "frame " << frame.index;
        EXPECT_EQ(frame.frame_status.torn, torn) << "frame " << frame.index;
        const bool used = repeated == 0 && !torn;
        EXPECT_EQ(frame.motion.health == Health::lost, !used) << "frame " << frame.index;
        EXPECT_EQ(frame.fusion.points > 0, used) << "frame " << frame.index;
    }
    EXPECT_EQ(record.frame_status.repeated_frames, 5);
    EXPECT_EQ(record.frame_status.longest_freeze_frames, 3);
    EXPECT_EQ(record.frame_status.torn_frames, 1);
    // Tracking continues from the last good image, so the whole path keeps its length.
    const auto& truth = (*floor)->truth().trajectory;
    const double way_m =
        (truth.back().T_world_body.translation_m - truth.front().T_world_body.translation_m).norm();
    const double seen_m = (record.frames.back().motion.T_odom_body.translation_m -
                           record.frames.front().motion.T_odom_body.translation_m)
                              .norm();
    EXPECT_NEAR(seen_m, way_m, 0.02 * way_m + 0.005);
}

}  // namespace
}  // namespace surefoot::app
