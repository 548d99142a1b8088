// SPDX-License-Identifier: Apache-2.0
#include "service/live/machine_joints.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {
namespace {

io::MachineModel rex() {
    auto model = io::read_model("models/rex.yaml");
    EXPECT_TRUE(model.ok());
    return std::move(model).value();
}

std::unique_ptr<sim::SceneSource> scene(const char* name) {
    sim::SceneOptions options;
    options.scene = name;
    options.sensor = sim::Sensor::analytic;
    return sim::open_scene(options).value();
}

TEST(MachineJoints, come_in_the_order_of_the_model) {
    io::MachineModel model = rex();
    std::reverse(model.joints.begin(), model.joints.end());
    const auto source = scene("walk_floor");
    const JointsAt joints_at = joints_of(*source, model);
    ASSERT_TRUE(joints_at);
    std::vector<float> joints_rad;
    const std::int64_t time_ns = source->truth().trajectory[60].time_ns;
    joints_at(time_ns, joints_rad);
    joints_at(time_ns, joints_rad);  // must replace the content, not append to it
    const auto moving = model.moving_joints();
    ASSERT_EQ(joints_rad.size(), moving.size());
    const auto knee = std::find_if(moving.begin(), moving.end(), [](const io::ModelJoint* joint) {
        return joint->name == "right_upperleg_to_right_lowerleg";
    });
    EXPECT_FLOAT_EQ(joints_rad[static_cast<std::size_t>(knee - moving.begin())],
                    static_cast<float>(source->rex_joints(time_ns)->right.knee_rad));
}

TEST(MachineJoints, are_not_known_of_a_trolley_or_of_another_machine) {
    const auto rolling = scene("floor");
    const JointsAt of_trolley = joints_of(*rolling, rex());
    std::vector<float> joints_rad{1.0F};
    ASSERT_TRUE(of_trolley);
    of_trolley(rolling->truth().start_ns, joints_rad);
    EXPECT_TRUE(joints_rad.empty());
    io::MachineModel other = rex();
    for (io::ModelJoint& joint : other.joints) {
        if (joint.name == "frame_roll") joint.name = "roll_of_frame";
    }
    const auto walking = scene("walk_floor");
    EXPECT_FALSE(joints_of(*walking, other));
}

}  // namespace
}  // namespace surefoot::app
