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

}  // namespace
}  // namespace surefoot::app
