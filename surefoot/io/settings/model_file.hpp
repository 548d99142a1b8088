// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::io {

/// Pose in the frame of the parent; rotation Rz(yaw) Ry(pitch) Rx(roll).
struct ModelPlace {
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d roll_pitch_yaw_rad = Eigen::Vector3d::Zero();

    [[nodiscard]] Pose pose() const;
};

struct ModelMaterial {
    std::string name;
    std::array<std::uint8_t, 3> rgb{};
};

struct ModelBox {
    Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
    ModelPlace in_link;  ///< pose of the centre of the box in the link
    std::string material;
};

struct ModelLink {
    std::string name;
    std::vector<ModelBox> boxes;
};

/// Attaches a child link to a parent link; a moving joint turns the child about `axis`.
struct ModelJoint {
    std::string name;
    std::string parent;
    std::string child;
    ModelPlace in_parent;
    bool moves = false;
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit vector in the joint frame
    double min_rad = 0.0;
    double max_rad = 0.0;
    double stand_rad = 0.0;  ///< angle to display if the real angle is unknown
};

/// Appearance of a machine. The links form one tree: `base_link` is the root, every other link
/// hangs on exactly one joint, and all referenced names exist.
struct MachineModel {
    std::string name;
    std::vector<ModelMaterial> materials;
    std::vector<ModelLink> links;
    std::vector<ModelJoint> joints;

    /// Returns the moving joints in file order.
    [[nodiscard]] std::vector<const ModelJoint*> moving_joints() const;
    /// Returns the pose of a link in base_link for the given angles of the moving joints (in the
    /// order of `moving_joints`). Precondition: the link exists.
    [[nodiscard]] Pose T_base_link(std::string_view link,
                                   const std::vector<double>& angles_rad) const;
};

/// Every key is checked, as in machine files (models/rex.yaml shows every key). A usage error names
/// file, line, key, value and what to do.
[[nodiscard]] Result<MachineModel> parse_model(std::string_view yaml, const std::string& file);
[[nodiscard]] Result<MachineModel> read_model(const std::string& path);

}  // namespace surefoot::io
