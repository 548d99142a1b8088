// SPDX-License-Identifier: Apache-2.0
#include "surefoot/perception.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "surefoot/sim/scene_source.hpp"

namespace surefoot {
namespace {

/// Frames with known depth and motion: fast, and the machine stands level.
std::unique_ptr<sim::SceneSource> open_room(int frames) {
    sim::SceneOptions options;
    options.scene = "room";
    options.seed = 3;
    options.frames = frames;
    options.sensor = sim::Sensor::analytic;
    auto source = sim::open_scene(options, &serial());
    EXPECT_TRUE(source.ok()) << source.error().message;
    return std::move(source).value();
}

std::vector<FrameReport> process_all(Perception& perception, camera::FrameSource& source) {
    std::vector<FrameReport> reports;
    const auto add = [&](std::span<const FrameReport> some) {
        reports.insert(reports.end(), some.begin(), some.end());
    };
    for (auto frame = source.next(); frame.ok() && frame->has_value(); frame = source.next())
        add(perception.process(**frame));
    add(perception.finish());
    return reports;
}

Perception make(camera::FrameSource& source, bool with_machine) {
    std::optional<io::MachineFile> machine;
    if (with_machine) machine = load_machine("rex").value();
    auto made = Perception::make(source.rig(), machine, {}, 1);
    EXPECT_TRUE(made.ok()) << made.error().message;
    return std::move(made).value();
}

TEST(Perception, ReportsEachFrameOnceAndInOrder) {
    const auto source = open_room(25);
    Perception perception = make(*source, false);
    EXPECT_FALSE(perception.is_started());
    const auto reports = process_all(perception, *source);
    ASSERT_EQ(reports.size(), 25U);
    for (std::size_t i = 0; i < reports.size(); ++i)
        EXPECT_EQ(reports[i].index, static_cast<int>(i));
    EXPECT_TRUE(perception.is_started());
    EXPECT_GT(reports.back().known_cells, 2000);
    EXPECT_EQ(perception.rating().traversability.size(), perception.map().layers().height_m.size());
}

TEST(Perception, IsTheChainOfTheCommandLine) {
    const auto source = open_room(20);
    Perception perception = make(*source, true);
    const auto reports = process_all(perception, *source);

    const auto again = open_room(20);
    Settings settings = load_settings().value();
    settings.pipeline.ground.expected_height_m =
        perception.settings().pipeline.ground.expected_height_m;
    settings.pipeline.odometry = perception.settings().pipeline.odometry;
    auto pipeline = pipeline::Pipeline::make(settings.pipeline, again->rig(), serial());
    ASSERT_TRUE(pipeline.ok());
    const pipeline::Start start = pipeline::align_when_ready(*pipeline, [&] {
        auto frame = again->next();
        return frame.ok() ? std::move(*frame) : std::nullopt;
    });
    for (const StereoFrame& frame : start.frames) pipeline->process(frame, Work::full);
    for (auto frame = again->next(); frame.ok() && frame->has_value(); frame = again->next())
        pipeline->process(**frame, Work::full);
    const auto& a = perception.map().layers().height_m;
    const auto& b = pipeline->map().layers().height_m;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        ASSERT_TRUE(a.data()[i] == b.data()[i] ||
                    (a.data()[i] != a.data()[i] && b.data()[i] != b.data()[i]))
            << i;
}

TEST(Perception, ARecordingShorterThanTheStartUpIsProcessedAtItsEnd) {
    const auto source = open_room(4);
    Perception perception = make(*source, false);
    for (auto frame = source->next(); frame.ok() && frame->has_value(); frame = source->next())
        EXPECT_TRUE(perception.process(**frame).empty());
    EXPECT_EQ(perception.finish().size(), 4U);
    EXPECT_TRUE(perception.is_started());
    EXPECT_TRUE(perception.finish().empty());
}

TEST(Perception, WithoutFramesItEndsWithoutAny) {
    const auto source = open_room(1);
    Perception perception = make(*source, true);
    EXPECT_TRUE(perception.finish().empty());
    EXPECT_EQ(perception.map().known_cells(), 0);
    EXPECT_EQ(perception.verdict(9).decision, gate::Decision::error);
}

TEST(Perception, EveryThingThatIsMissingInhibits) {
    const auto source = open_room(1);
    Perception without_machine = make(*source, false);
    (void)process_all(without_machine, *source);
    EXPECT_EQ(without_machine.verdict(9).decision, gate::Decision::error);
    EXPECT_NE(without_machine.text_of(without_machine.verdict(9)).find("no machine file"),
              std::string::npos);

    const auto again = open_room(1);
    Perception not_started = make(*again, true);
    EXPECT_EQ(not_started.verdict(9).decision, gate::Decision::error);
    EXPECT_NE(not_started.text_of(not_started.verdict(9)).find("not started"), std::string::npos);
}

TEST(Perception, MovesWithAllThatRefersToIt) {
    const auto source = open_room(14);
    Perception first = make(*source, true);
    for (int i = 0; i < 12; ++i) (void)first.process(*source->next().value());
    Perception second = std::move(first);
    EXPECT_EQ(second.process(*source->next().value()).size(), 1U);
    EXPECT_GT(second.map().known_cells(), 1000);
}

TEST(Perception, ProblemsOfTheRigAreSaid) {
    const auto source = open_room(1);
    camera::StereoRig rig = source->rig();
    rig.left.width = -1;
    EXPECT_FALSE(Perception::make(rig).ok());
}

}  // namespace
}  // namespace surefoot
