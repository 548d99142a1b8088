// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "studies/suite/suite_progress.hpp"
#include "surefoot/sim/scenes/scenes.hpp"

namespace surefoot::app {
namespace {

EvalSuiteOptions choice(std::vector<std::string> scenes, int seeds, std::vector<double> noise) {
    EvalSuiteOptions options;
    options.scenes = std::move(scenes);
    options.seeds = seeds;
    options.noise = std::move(noise);
    options.common.seed = 5;
    return options;
}

TEST(SuitePlan, SeedBySeedAndTheLongScenesFirst) {
    const auto plan = plan_suite(choice({"floor", "demo_stairs"}, 2, {1.0, 2.0}), {});
    ASSERT_TRUE(plan.ok());
    std::vector<std::string> names;
    for (const PlannedCase& planned : *plan) names.push_back(planned.which.name());
    EXPECT_EQ(names,
              (std::vector<std::string>{"demo_stairs/trolley/seed 5/noise 1",
                                        "demo_stairs/trolley/seed 5/noise 2",
                                        "floor/trolley/seed 5/noise 1",
                                        "floor/trolley/seed 5/noise 2",
                                        "demo_stairs/trolley/seed 6/noise 1",
                                        "demo_stairs/trolley/seed 6/noise 2",
                                        "floor/trolley/seed 6/noise 1",
                                        "floor/trolley/seed 6/noise 2"}));
    EXPECT_GT((*plan)[0].frames, (*plan)[2].frames);
    EXPECT_EQ((*plan)[0].which.motion_model, "trolley");
    EXPECT_EQ((*plan)[0].which.max_frames, 0);
}

TEST(SuitePlan, EverySceneOnceByDefaultAndAFewShortOnesWhenQuick) {
    EvalSuiteOptions options;
    options.noise = {1.0};
    const auto all = plan_suite(options, {});
    ASSERT_TRUE(all.ok());
    EXPECT_EQ(all->size(), sim::list_scenes().size());
    options.quick = true;
    const auto quick = plan_suite(options, {});
    ASSERT_TRUE(quick.ok());
    EXPECT_LT(quick->size(), 12U);
    std::int64_t walks = 0;
    for (const PlannedCase& planned : *quick) {
        EXPECT_GT(planned.which.max_frames, 0);
        walks += planned.which.motion_model == "rex" ? 1 : 0;
    }
    EXPECT_GE(walks, 1);
    options.frames = 3;
    const auto short_cases = plan_suite(options, {});
    ASSERT_TRUE(short_cases.ok());
    for (const PlannedCase& planned : *short_cases) EXPECT_EQ(planned.which.max_frames, 3);
}

TEST(SuitePlan, EveryMotionModelThatCanGoTheSceneSWayGoesItOnce) {
    EvalSuiteOptions options = choice({"floor", "walk_floor"}, 1, {1.0});
    options.motion_models = {"scene", "rex", "hand"};
    const auto plan = plan_suite(options, {});
    ASSERT_TRUE(plan.ok());
    std::set<std::string> names;
    for (const PlannedCase& planned : *plan) {
        names.insert(planned.which.name());
        EXPECT_EQ(planned.which.rate_hz, planned.which.motion_model == "rex" ? 4.0 : 10.0);
    }
    EXPECT_EQ(names,
              (std::set<std::string>{"floor/trolley/seed 5/noise 1",
                                     "floor/rex/seed 5/noise 1",
                                     "floor/hand/seed 5/noise 1",
                                     "walk_floor/rex/seed 5/noise 1",
                                     "walk_floor/hand/seed 5/noise 1"}));
}

TEST(SuitePlan, AWayThatAMotionModelCannotGoIsLeftOut) {
    EvalSuiteOptions options = choice({"walk_descend_backwards", "floor"}, 1, {1.0});
    options.motion_models = {"trolley"};  // no trolley goes down a step
    const auto plan = plan_suite(options, {});
    ASSERT_TRUE(plan.ok()) << plan.error().message;
    for (const PlannedCase& planned : *plan) EXPECT_EQ(planned.which.scene, "floor");
    EXPECT_EQ(plan->size(), 1U);
    options.scenes = {"walk_descend_backwards"};
    const auto none = plan_suite(options, {});
    ASSERT_FALSE(none.ok());
    EXPECT_NE(none.error().message.find("--motion-models"), std::string::npos);
}

TEST(SuitePlan, ImpossibleChoicesAreSentences) {
    for (const auto& [options, word] :
         {std::pair{choice({"nowhere"}, 1, {1.0}), "nowhere"},
          std::pair{choice({"floor", "floor"}, 1, {1.0}), "twice"},
          std::pair{choice({"floor"}, 1, {1.0, 2.0, 1.0}), "--noise: 1 is given twice"},
          std::pair{choice({"no/such/file.yaml"}, 1, {1.0}), "no/such/file.yaml"}}) {
        const auto plan = plan_suite(options, {});
        ASSERT_FALSE(plan.ok()) << word;
        EXPECT_EQ(plan.error().code, ErrorCode::usage);
        EXPECT_NE(plan.error().message.find(word), std::string::npos) << plan.error().message;
    }
}

TEST(SuiteProgress, TimeGoesByFrames) {
    EXPECT_EQ(time_left(0, 100, 5.0), "");
    EXPECT_EQ(time_left(100, 100, 5.0), "");
    EXPECT_EQ(time_left(50, 100, 30.0), "about 30 s left");
    EXPECT_EQ(time_left(10, 100, 20.0), "about 3 min left");
    EXPECT_EQ(time_left(1, 101, 75.0), "about 2 h 5 min left");
}

}  // namespace
}  // namespace surefoot::app
