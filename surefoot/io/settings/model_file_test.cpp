// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/settings/model_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "surefoot/core/angles.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;

/// Two links, the upper one fixed to the root, the lower one on a knee that is turned by 90 deg.
constexpr const char* kSmall = R"(name: small
materials:
  - {name: blue, color: "#0072b2"}
links:
  - {name: base_link}
  - {name: thigh, boxes: [{size_x_m: 0.1, size_y_m: 0.2, size_z_m: 0.4, z_m: -0.2, material: blue}]}
  - {name: shank}
joints:
  - {name: hip, kind: fixed, parent: base_link, child: thigh, x_m: 0.5, yaw_deg: 90}
  - {name: knee, kind: revolute, parent: thigh, child: shank, z_m: -0.4, axis: y, min_deg: 0, max_deg: 90, stand_deg: 5}
)";

std::string small_with(const std::string& from, const std::string& to) {
    std::string text = kSmall;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    return at == text.npos ? text : text.replace(at, from.size(), to);
}

TEST(ModelFile, everything_that_it_says_is_read) {
    const auto model = parse_model(kSmall, "m.yaml");
    ASSERT_TRUE(model.ok()) << model.error().message;
    EXPECT_EQ(model->name, "small");
    ASSERT_EQ(model->materials.size(), 1U);
    EXPECT_EQ(model->materials[0].rgb, (std::array<std::uint8_t, 3>{0x00, 0x72, 0xb2}));
    ASSERT_EQ(model->links.size(), 3U);
    ASSERT_EQ(model->links[1].boxes.size(), 1U);
    EXPECT_EQ(model->links[1].boxes[0].size_m, Eigen::Vector3d(0.1, 0.2, 0.4));
    EXPECT_EQ(model->links[1].boxes[0].in_link.position_m, Eigen::Vector3d(0.0, 0.0, -0.2));
    EXPECT_TRUE(model->links[2].boxes.empty());
    ASSERT_EQ(model->joints.size(), 2U);
    EXPECT_FALSE(model->joints[0].moves);
    EXPECT_NEAR(model->joints[0].in_parent.roll_pitch_yaw_rad.z(), 90.0 * kRadPerDeg, 1e-15);
    const std::vector<const ModelJoint*> moving = model->moving_joints();
    ASSERT_EQ(moving.size(), 1U);
    EXPECT_EQ(moving[0]->axis, Eigen::Vector3d::UnitY());
    EXPECT_NEAR(moving[0]->max_rad, 90.0 * kRadPerDeg, 1e-15);
    EXPECT_NEAR(moving[0]->stand_rad, 5.0 * kRadPerDeg, 1e-15);
}

TEST(ModelFile, links_lie_where_joints_bring_them) {
    const auto model = parse_model(kSmall, "m.yaml");
    ASSERT_TRUE(model.ok()) << model.error().message;
    const Pose T = model->T_base_link("shank", {90.0 * kRadPerDeg});
    EXPECT_LT((T.translation_m - Eigen::Vector3d(0.5, 0.0, -0.4)).norm(), 1e-12);
    // Bent by a right angle the shank's -z looks back, and the thigh's "back" is -y of the root.
    const Eigen::Vector3d down = T.rotation * -Eigen::Vector3d::UnitZ();
    EXPECT_LT((down - Eigen::Vector3d(0.0, -1.0, 0.0)).norm(), 1e-12);
    EXPECT_LT(difference(model->T_base_link("base_link", {0.0}), Pose{}).norm(), 1e-12);
}

TEST(ModelFile, every_mistake_is_named_with_file_line_key_and_value) {
    struct Case {
        const char* from;
        const char* to;
        int line;
        const char* expected;
    };
    const Case cases[] = {
        {"name: small", "name: small\ncolour: red", 2, "unknown key 'colour'"},
        {"name: small",
         "name: my robot",
         1,
         "name: 'my robot': a name may have only letters, digits and _"},
        {"color: \"#0072b2\"", "color: blue", 3, "materials[0].color: 'blue' is not a color"},
        {"#0072b2", "#0072bg", 3, "'#0072bg' is not a color: write it as"},
        {"#0072b2", "x0072b2", 3, "'x0072b2' is not a color: write it as"},
        {"- {name: shank}", "- {name: thigh}", 7, "links[2].name: 'thigh' is used twice"},
        {"- {name: shank}", "- {name: shank, mass: 1}", 7, "unknown key 'links[2].mass'"},
        {"size_y_m: 0.2", "size_y_m: -0.2", 6, "links[1].boxes[0].size_y_m: -0.2 is outside"},
        {"size_y_m: 0.2, ", "", 6, "links[1].boxes[0].size_y_m: this key is missing"},
        {"material: blue", "material: bleu", 6, "no material 'bleu' in `materials`; did you mean"},
        {"parent: thigh", "parent: thing", 10, "joints[1].parent: there is no link 'thing'"},
        {"child: shank", "child: foot", 10, "joints[1].child: there is no link 'foot'"},
        {"child: shank", "child: thigh", 10, "child: 'thigh' is already the child of joint 'hip'"},
        {"parent: base_link",
         "parent: shank",
         10,
         "joints[1].child: 'shank' would be its own ancestor"},
        {"child: thigh", "child: base_link", 9, "'base_link' would be its own ancestor: give"},
        {"kind: fixed", "kind: screw", 9, "'screw' is neither fixed nor revolute"},
        {"kind: revolute", "kind: fixed", 10, "unknown key 'joints[1].axis'"},
        {"axis: y", "axis: w", 10, "joints[1].axis: 'w' is not x, y or z: turn the joint"},
        {"max_deg: 90", "max_deg: 0", 10, "max_deg: the range from min_deg 0 to 0 is empty: give"},
        {"max_deg: 90", "max_deg: -9", 10, "from min_deg 0 to -9 is empty"},
        {"max_deg: 90", "max_deg: .nan", 10, "joints[1].max_deg: nan is outside"},
        {"stand_deg: 5", "stand_deg: 95", 10, "stand_deg: 95 is outside 0 .. 90"},
        {"name: knee", "name: hip", 10, "joints[1].name: 'hip' is used twice"},
        {"name: base_link", "name: hips", 9, "joints[0].parent: there is no link 'base_link'"},
        {"joints:", "joints: []\nrest:", 9, "unknown key 'rest'"},
    };
    for (const Case& c : cases) {
        const auto model = parse_model(small_with(c.from, c.to), "m.yaml");
        ASSERT_FALSE(model.ok()) << c.to;
        EXPECT_EQ(model.error().code, ErrorCode::usage) << c.to;
        const std::string& message = model.error().message;
        EXPECT_TRUE(contains(message, c.expected)) << message;
        EXPECT_TRUE(contains(message, "m.yaml:" + std::to_string(c.line) + ":"))
            << message << " should name line " << c.line;
    }
}

TEST(ModelFile, there_is_one_root_and_it_is_base_link) {
    const auto said = [](const std::string& text) {
        const auto model = parse_model(text, "m.yaml");
        EXPECT_FALSE(model.ok());
        return model.ok() ? std::string() : model.error().message;
    };
    EXPECT_TRUE(
        contains(said(small_with("- {name: shank}", "- {name: shank}\n  - {name: hat}")),
                 "m.yaml:8: links[3].name: 'hat' is not the child of a joint, but only base_link"));
    EXPECT_TRUE(
        contains(said("name: a\nmaterials: []\nlinks: [{name: hips}]\njoints: []\n"),
                 "m.yaml:3: links: there is no link base_link: give the root link this name"));
    const std::string other =
        "name: a\nmaterials: []\nlinks: [{name: hips}, {name: base_link}]\njoints:\n"
        "  - {name: j, kind: fixed, parent: hips, child: base_link}\n";
    EXPECT_TRUE(
        contains(said(other),
                 "base_link is the root and cannot be a child: swap parent and child of joint"));
}

TEST(ModelFile, an_empty_or_missing_file_is_refused) {
    EXPECT_FALSE(parse_model("", "m.yaml").ok());
    EXPECT_FALSE(parse_model("[1, 2]", "m.yaml").ok());
    const auto missing = read_model("/nowhere/rex.yaml");
    ASSERT_FALSE(missing.ok());
    EXPECT_TRUE(contains(missing.error().message, "/nowhere/rex.yaml"));
}

TEST(ModelFile, damaged_files_are_refused_or_valid_but_never_crash) {
    const auto text = read_file(SUREFOOT_SOURCE_DIR "/models/rex.yaml");
    ASSERT_TRUE(text.ok());
    int accepted = 0;
    testing::for_each_mutation(*text, 400, 37, [&](const std::string& damaged) {
        const auto model = parse_model(damaged, "m.yaml");
        if (!model.ok()) {
            EXPECT_FALSE(model.error().message.empty());
            return;
        }
        ++accepted;
        const std::vector<double> zero(model->moving_joints().size(), 0.0);
        for (const ModelLink& link : model->links)
            EXPECT_TRUE(model->T_base_link(link.name, zero).all_finite());
    });
    EXPECT_GT(accepted, 0) << "comments may be damaged";
}

}  // namespace
}  // namespace surefoot::io
