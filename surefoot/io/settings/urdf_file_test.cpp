// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/settings/urdf_file.hpp"

#include <gtest/gtest.h>

#include "surefoot/io/file.hpp"

namespace surefoot::io {
namespace {

TEST(UrdfFile, has_every_part_of_the_model) {
    const auto model = parse_model(R"(name: small
materials:
  - {name: blue, color: "#0072b2"}
links:
  - {name: base_link}
  - {name: leg, boxes: [{size_x_m: 0.1, size_y_m: 0.2, size_z_m: 0.4, z_m: -0.2, material: blue}]}
joints:
  - {name: hip, kind: revolute, parent: base_link, child: leg, y_m: -0.5, yaw_deg: 90, axis: y, min_deg: -90, max_deg: 45, stand_deg: 0}
)",
                                   "m.yaml");
    ASSERT_TRUE(model.ok()) << model.error().message;
    EXPECT_EQ(urdf_text(*model), R"(<?xml version="1.0"?>
<!-- Made by `surefoot urdf` from the model "small": change the model, not this file.
     Lengths in m, angles in rad. Effort and velocity are not known: 0. -->
<robot name="small">
  <material name="blue">
    <color rgba="0 0.447058824 0.698039216 1"/>
  </material>
  <link name="base_link"/>
  <link name="leg">
    <visual>
      <origin xyz="0 0 -0.2" rpy="0 0 0"/>
      <geometry>
        <box size="0.1 0.2 0.4"/>
      </geometry>
      <material name="blue"/>
    </visual>
    <collision>
      <origin xyz="0 0 -0.2" rpy="0 0 0"/>
      <geometry>
        <box size="0.1 0.2 0.4"/>
      </geometry>
    </collision>
  </link>
  <joint name="hip" type="revolute">
    <origin xyz="0 -0.5 0" rpy="0 0 1.57079633"/>
    <parent link="base_link"/>
    <child link="leg"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1.57079633" upper="0.785398163" effort="0" velocity="0"/>
  </joint>
</robot>
)");
}

TEST(UrdfFile, of_the_rex_in_the_repository_is_that_of_its_model) {
    const auto model = read_model(SUREFOOT_SOURCE_DIR "/models/rex.yaml");
    ASSERT_TRUE(model.ok()) << model.error().message;
    const auto written = read_file(SUREFOOT_SOURCE_DIR "/models/rex.urdf");
    ASSERT_TRUE(written.ok()) << written.error().message;
    EXPECT_EQ(urdf_text(*model), *written)
        << "surefoot urdf models/rex.yaml --out models/rex.urdf writes it anew";
}

}  // namespace
}  // namespace surefoot::io
