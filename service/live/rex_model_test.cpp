// SPDX-License-Identifier: Apache-2.0
// models/rex.yaml, machines/rex.yaml and the simulated REX describe the same machine.
#include <gtest/gtest.h>

#include <algorithm>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/io/settings/model_file.hpp"
#include "surefoot/sim/motion/rex_gait.hpp"
#include "surefoot/sim/motion/rex_joints.hpp"

namespace surefoot::app {
namespace {

using Eigen::Vector3d;

constexpr double kTenthMm_m = 1e-4;  ///< rounding of the machine file

class RexModel : public ::testing::Test {
  protected:
    void SetUp() override {
        auto model = io::read_model("models/rex.yaml");
        ASSERT_TRUE(model.ok()) << model.error().message;
        model_ = std::move(model).value();
        auto machine = io::read_machine("machines/rex.yaml");
        ASSERT_TRUE(machine.ok()) << machine.error().message;
        machine_ = std::move(machine).value();
    }
    [[nodiscard]] const io::ModelJoint& joint(const std::string& name) const {
        const auto found = std::find_if(model_.joints.begin(),
                                        model_.joints.end(),
                                        [&](const auto& one) { return one.name == name; });
        EXPECT_NE(found, model_.joints.end()) << name;
        return *found;
    }
    [[nodiscard]] const io::ModelBox& only_box(const std::string& link) const {
        const auto found = std::find_if(model_.links.begin(),
                                        model_.links.end(),
                                        [&](const auto& one) { return one.name == link; });
        EXPECT_EQ(found->boxes.size(), 1U) << link;
        return found->boxes.front();
    }
    [[nodiscard]] std::vector<double> standing() const {
        std::vector<double> angles_rad;
        for (const io::ModelJoint* one : model_.moving_joints())
            angles_rad.push_back(one->stand_rad);
        return angles_rad;
    }

    io::MachineModel model_;
    io::MachineFile machine_;
};

TEST_F(RexModel, JointsAreThoseOfTheSimulatedRexInTheirOrder) {
    const auto moving = model_.moving_joints();
    ASSERT_EQ(moving.size(), sim::kRexJointNames.size());
    for (std::size_t i = 0; i < moving.size(); ++i)
        EXPECT_EQ(moving[i]->name, sim::kRexJointNames[i]) << i;
}

/// Signs differ: in the machine file flexion, abduction and dorsiflexion are positive; the model
/// uses the right-hand rule.
TEST_F(RexModel, RangesAreThoseOfTheMachineFile) {
    struct Same {
        const char* machine;
        const char* left;
        const char* right;
        double left_sign;
        double right_sign;
    };
    const Same all[] = {
        {"hip_flexion", "pelvis_to_left_upperleg", "pelvis_to_right_upperleg", -1.0, -1.0},
        {"hip_abduction", "left_hip_abduction", "right_hip_abduction", 1.0, -1.0},
        {"knee_flexion",
         "left_upperleg_to_left_lowerleg",
         "right_upperleg_to_right_lowerleg",
         1.0,
         1.0},
        {"ankle_dorsiflexion",
         "left_lowerleg_to_left_foot",
         "right_lowerleg_to_right_foot",
         -1.0,
         -1.0},
        {"ankle_inversion", "left_ankle_inversion", "right_ankle_inversion", -1.0, 1.0}};
    ASSERT_EQ(machine_.joints.size(), std::size(all));
    for (std::size_t i = 0; i < std::size(all); ++i) {
        const io::JointRange& range = machine_.joints[i];
        EXPECT_EQ(range.name, all[i].machine);
        for (const auto& [name, sign] : {std::pair(all[i].left, all[i].left_sign),
                                         std::pair(all[i].right, all[i].right_sign)}) {
            const auto [low, high] = std::minmax({sign * range.min_deg, sign * range.max_deg});
            EXPECT_NEAR(joint(name).min_rad * kDegPerRad, low, 1e-9) << name;
            EXPECT_NEAR(joint(name).max_rad * kDegPerRad, high, 1e-9) << name;
        }
    }
}

TEST_F(RexModel, StandsOnTheFeetOfTheMachineFile) {
    for (const auto& [side, foot] : {std::pair("left", machine_.machine.left_foot),
                                     std::pair("right", machine_.machine.right_foot)}) {
        const std::string name = std::string(side) + "_foot";
        const io::ModelBox& box = only_box(name);
        const Pose T_base_box = model_.T_base_link(name, standing()) * box.in_link.pose();
        // The angles of the stand are rounded to 0.001 deg: 0.02 mm at the end of a leg.
        EXPECT_NEAR(T_base_box.translation_m.x(), foot.center_x_tenth_mm * 1e-4, kTenthMm_m);
        EXPECT_NEAR(T_base_box.translation_m.y(), foot.center_y_tenth_mm * 1e-4, kTenthMm_m);
        EXPECT_NEAR(
            T_base_box.translation_m.z() - box.size_m.z() / 2.0, -sim::rex::kStand_m, kTenthMm_m);
        EXPECT_LT(log_so3(T_base_box.rotation).norm(), 1e-4) << "flat on the ground";
        EXPECT_NEAR(box.size_m.x(), foot.length_tenth_mm * 1e-4, 1e-9);
        EXPECT_NEAR(box.size_m.y(), foot.width_tenth_mm * 1e-4, 1e-9);
        EXPECT_NEAR(box.size_m.x() / 2.0 - box.in_link.position_m.x(),
                    machine_.machine.ankle_from_heel_tenth_mm * 1e-4,
                    1e-9);
    }
}

TEST_F(RexModel, IsAsHighAsTheMachineFileSays) {
    const std::vector<double> straight(model_.moving_joints().size(), 0.0);
    EXPECT_NEAR(model_.T_base_link("left_sole", straight).translation_m.z(),
                -1e-4 * machine_.machine.sole_depth_tenth_mm,
                1e-9);
}

TEST_F(RexModel, HasTheCameraWhereTheMachineFileHasIt) {
    const Pose T_base_camera = model_.T_base_link("camera", standing());
    EXPECT_LT(difference(T_base_camera * T_body_optical(), machine_.T_body_left).norm(), 1e-9);
}

TEST_F(RexModel, MovesAsTheKinematicsOfTheSimulator) {
    Rng rng(5);
    for (int i = 0; i < 200; ++i) {
        sim::RexJoints joints;
        for (sim::LegAngles* leg : {&joints.left, &joints.right}) {
            *leg = {rng.uniform(-0.1, 0.1),
                    rng.uniform(-0.3, 0.3),
                    rng.uniform(-1.5, 0.2),
                    rng.uniform(0.0, 1.6),
                    rng.uniform(-0.3, 0.1),
                    rng.uniform(-0.1, 0.1)};
        }
        const auto all = joints.in_order();
        const std::vector<double> angles_rad(all.begin(), all.end());
        for (const auto side : {sim::Side::left, sim::Side::right}) {
            const std::string name = sim::kSideNames[static_cast<int>(side)];
            const sim::LegPoses poses =
                sim::leg_poses(side, side == sim::Side::left ? joints.left : joints.right);
            for (const auto& [link, T_body_link] : {std::pair("_upperleg", poses.T_body_upper),
                                                    std::pair("_lowerleg", poses.T_body_lower),
                                                    std::pair("_sole", poses.T_body_sole)})
                EXPECT_LT(
                    difference(model_.T_base_link(name + link, angles_rad), T_body_link).norm(),
                    1e-9)
                    << name << link;
        }
    }
}

TEST_F(RexModel, RangesHoldEveryMovementOfTheSimulatedRex) {
    const auto moving = model_.moving_joints();
    for (const sim::RexMovement& movement : sim::rex_movements({})) {
        sim::RexPlan plan;
        plan.steps.push_back({0.0, movement, {}, sim::moved({}, movement, 1.0)});
        const auto motion = sim::RexMotion::make(
            plan, {}, [](double, double) { return 0.0; }, 7);
        ASSERT_TRUE(motion.ok()) << motion.error().message;
        for (double t_s = 0.0; t_s < motion->duration_s(); t_s += 0.1) {
            const auto angles_rad = motion->rex_joints(t_s)->in_order();
            for (std::size_t i = 0; i < moving.size(); ++i) {
                EXPECT_GE(angles_rad[i], moving[i]->min_rad) << moving[i]->name;
                EXPECT_LE(angles_rad[i], moving[i]->max_rad) << moving[i]->name;
            }
        }
    }
}

}  // namespace
}  // namespace surefoot::app
