// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/run_session.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "sim/scene_source.hpp"

namespace surefoot::app {
namespace {

/// A simulated floor whose source throws after some frames, as a library out of memory would.
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
    EXPECT_TRUE(record.source.modelled);
    EXPECT_TRUE(pipeline->pair().left.empty());
    ASSERT_EQ(record.frames.size(), 40U);
    // Odom begins where the alignment put the first body, and moves as the source says.
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

}  // namespace
}  // namespace surefoot::app
