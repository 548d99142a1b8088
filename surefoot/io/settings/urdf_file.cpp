// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/settings/urdf_file.hpp"

#include <fmt/format.h>

namespace surefoot::io {
namespace {

/// Formats a number with nine digits, which resolve 1 um in 1 km. Writes zero without a sign.
std::string number(double value) {
    return fmt::format("{:.9g}", value + 0.0);
}

std::string numbers(const Eigen::Vector3d& v) {
    return fmt::format("{} {} {}", number(v.x()), number(v.y()), number(v.z()));
}

std::string origin(const ModelPlace& place) {
    return fmt::format("<origin xyz=\"{}\" rpy=\"{}\"/>",
                       numbers(place.position_m),
                       numbers(place.roll_pitch_yaw_rad));
}

std::string material_text(const ModelMaterial& material) {
    constexpr double kWhite = 255.0;
    return fmt::format(
        "  <material name=\"{}\">\n    <color rgba=\"{} 1\"/>\n  </material>\n",
        material.name,
        numbers(Eigen::Vector3d(material.rgb[0], material.rgb[1], material.rgb[2]) / kWhite));
}

std::string box_text(const ModelBox& box) {
    const std::string shape =
        fmt::format("      {}\n      <geometry>\n        <box size=\"{}\"/>\n      </geometry>\n",
                    origin(box.in_link),
                    numbers(box.size_m));
    return fmt::format(
        "    <visual>\n{}      <material name=\"{}\"/>\n    </visual>\n"
        "    <collision>\n{}    </collision>\n",
        shape,
        box.material,
        shape);
}

std::string link_text(const ModelLink& link) {
    if (link.boxes.empty()) return fmt::format("  <link name=\"{}\"/>\n", link.name);
    std::string text = fmt::format("  <link name=\"{}\">\n", link.name);
    for (const ModelBox& box : link.boxes) text += box_text(box);
    return text + "  </link>\n";
}

std::string joint_text(const ModelJoint& joint) {
    std::string text = fmt::format(
        "  <joint name=\"{}\" type=\"{}\">\n    {}\n    <parent link=\"{}\"/>\n"
        "    <child link=\"{}\"/>\n",
        joint.name,
        joint.moves ? "revolute" : "fixed",
        origin(joint.in_parent),
        joint.parent,
        joint.child);
    if (joint.moves)
        text += fmt::format(
            "    <axis xyz=\"{}\"/>\n"
            "    <limit lower=\"{}\" upper=\"{}\" effort=\"0\" velocity=\"0\"/>\n",
            numbers(joint.axis),
            number(joint.min_rad),
            number(joint.max_rad));
    return text + "  </joint>\n";
}

}  // namespace

std::string urdf_text(const MachineModel& model) {
    std::string text = fmt::format(
        "<?xml version=\"1.0\"?>\n"
        "<!-- Made by `surefoot urdf` from the model \"{0}\": change the model, not this file.\n"
        "     Lengths in m, angles in rad. Effort and velocity are not known: 0. -->\n"
        "<robot name=\"{0}\">\n",
        model.name);
    for (const ModelMaterial& material : model.materials) text += material_text(material);
    for (const ModelLink& link : model.links) text += link_text(link);
    for (const ModelJoint& joint : model.joints) text += joint_text(joint);
    return text + "</robot>\n";
}

}  // namespace surefoot::io
