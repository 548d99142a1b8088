// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_steps.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "service/console/source.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/grid/snapshot_builder.hpp"
#include "surefoot/sim/motion/motion_scripts.hpp"
#include "surefoot/sim/scenes/scenes.hpp"

namespace surefoot::app {
namespace {

constexpr double kRate_hz = 3.7;  // steps begin between frames

/// The REX walks straight ahead on the ground of a scene, with a slow camera.
sim::SceneTruth walk_on(const std::string& scene, double distance_m) {
    sim::SceneTruth truth;
    truth.scene = sim::make_scene(scene, 1).value().scene;
    const auto way = sim::make_motion(sim::approach_script(sim::MotionModel::rex, distance_m), 1);
    EXPECT_TRUE(way.ok()) << way.error().message;
    truth.start_ns = kNanosecondsPerSecond;
    truth.steps = way->steps;
    for (int i = 0; i <= static_cast<int>(way->motion->duration_s() * kRate_hz); ++i) {
        const double time_s = i / kRate_hz;
        truth.trajectory.push_back(
            {truth.start_ns + ns_from_seconds(time_s), way->motion->at(time_s).T_world_body});
    }
    return truth;
}

/// A map with known level ground for x >= `known_from_m`, and the machine at `x_m`.
std::unique_ptr<grid::MapSnapshot> level_map(double x_m, double known_from_m) {
    constexpr int kSide = 240;
    grid::SnapshotInput input;
    input.geometry = {0.025, kSide, kSide, {-2.0, -3.0}};
    grid::Layer height_m(kSide, kSide, std::nanf(""));
    for (int iy = 0; iy < kSide; ++iy) {
        for (int ix = 0; ix < kSide; ++ix) {
            if (input.geometry.center_m({ix, iy}).x() >= known_from_m) height_m.at(ix, iy) = 0.0F;
        }
    }
    const grid::Layer variance_m2(kSide, kSide, 1e-6F);
    const grid::Layer drift_m(kSide, kSide, 0.0F);
    input.height_m = height_m.view();
    input.variance_m2 = variance_m2.view();
    input.drift_m = drift_m.view();
    input.T_odom_body.translation_m = {x_m, 0.0, 0.99};
    input.gravity_source = grid::GravitySource::plane;
    input.tilt_sigma_rad = 0.0;
    input.health = grid::SnapshotHealth::ok;
    input.camera = CameraState::ok;
    input.version = 1;
    input.frame_time_ns = input.pose_time_ns = kNanosecondsPerSecond;
    auto map = std::make_unique<grid::MapSnapshot>();
    const Status built = grid::build_snapshot(input, *map);
    EXPECT_TRUE(built.ok());
    return map;
}

class StepQuestionsTest : public testing::Test {
  protected:
    Machine machine_ = load_machine("rex").value()->machine;
};

TEST_F(StepQuestionsTest, EachStepIsDueOnceJustBeforeItBegins) {
    const sim::SceneTruth truth = walk_on("floor", 1.2);
    ASSERT_GE(truth.steps.size(), 3U);
    StepQuestions questions(truth, machine_);
    const auto map = level_map(0.0, -2.0);
    for (const StampedPose& frame : truth.trajectory) {
        while (questions.due(frame.time_ns)) {
            const sim::StepEvent& step = truth.steps[questions.steps().size()];
            const double early_s = step.start_s - seconds_from_ns(frame.time_ns - truth.start_ns);
            EXPECT_GE(early_s, 0.0);
            EXPECT_LT(early_s, 1.0 / kRate_hz);
            questions.ask(*map);
        }
    }
    ASSERT_EQ(questions.steps().size(), truth.steps.size());
    for (std::size_t i = 0; i < truth.steps.size(); ++i)
        EXPECT_EQ(questions.steps()[i].command, truth.steps[i].command);
    const VerdictCounts counts = count_verdicts(questions.steps());
    EXPECT_EQ(counts.safe, static_cast<int>(truth.steps.size()));
    EXPECT_EQ(counts.safe_ok, counts.safe) << questions.steps()[0].reasons;
}

TEST_F(StepQuestionsTest, TheOperatorsWordHoldsAtTheStartOnly) {
    const sim::SceneTruth truth = walk_on("floor", 1.2);
    StepQuestions questions(truth, machine_);
    constexpr double kNothingKnown_m = 9.0;
    questions.ask(*level_map(0.0, kNothingKnown_m));
    EXPECT_TRUE(questions.steps().back().allowed()) << questions.steps().back().reasons;
    questions.ask(
        *level_map(1.5, kNothingKnown_m));  // outside the attested area: the attestation ends ...
    EXPECT_FALSE(questions.steps().back().allowed());
    questions.ask(*level_map(0.0, kNothingKnown_m));  // ... for good
    EXPECT_FALSE(questions.steps().back().allowed());
    EXPECT_NE(questions.steps().back().reasons.find("UNKNOWN_CELLS"), std::string::npos);
    EXPECT_EQ(count_verdicts(questions.steps()).safe_ok, 1);
}

TEST_F(StepQuestionsTest, AHazardThatTheMapDoesNotShowIsCountedAsMissed) {
    // The map shows level ground, but the true platform ends on the path.
    const double edge_m =
        sim::drawn_number(sim::make_scene("platform_edge", 1).value(), "edge_x_m");
    const sim::SceneTruth truth = walk_on("platform_edge", edge_m + 0.6);
    StepQuestions questions(truth, machine_);
    for (const sim::StepEvent& step : truth.steps)
        questions.ask(*level_map(step.T_world_before.translation_m.x(), -2.0));
    const VerdictCounts counts = count_verdicts(questions.steps());
    EXPECT_GE(counts.safe, 4);
    EXPECT_GE(counts.unsafe, 1);
    for (const SuiteStep& step : questions.steps())
        EXPECT_TRUE(step.allowed()) << step.number << ": " << step.reasons;
    EXPECT_EQ(counts.unsafe_ok, counts.unsafe);
    EXPECT_FALSE(questions.steps().back().safe);
    EXPECT_NE(questions.steps().back().dangers, "");
}

}  // namespace
}  // namespace surefoot::app
