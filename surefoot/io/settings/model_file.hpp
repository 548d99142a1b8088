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

/// Where something sits in its parent's frame: turns as in Rz(yaw) Ry(pitch) Rx(roll).
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
    ModelPlace in_link;  ///< of its middle
    std::string material;
};

struct ModelLink {
    std::string name;
    std::vector<ModelBox> boxes;
};

/// Hangs a link on another one; a joint that moves turns it about an axis of its own frame.
struct ModelJoint {
    std::string name;
    std::string parent;
    std::string child;
    ModelPlace in_parent;
    bool moves = false;
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit
    double min_rad = 0.0;
    double max_rad = 0.0;
    double stand_rad = 0.0;  ///< shown where nothing is known
};

/// What a machine looks like. One tree: `base_link` is its root, every other link hangs on one
/// joint, and all names are there.
struct MachineModel {
    std::string name;
    std::vector<ModelMaterial> materials;
    std::vector<ModelLink> links;
    std::vector<ModelJoint> joints;

    /// In the order of the file.
    [[nodiscard]] std::vector<const ModelJoint*> moving_joints() const;
    /// Of a link in base_link, the moving joints at these angles (in the order of
    /// `moving_joints`). The link must be there.
    [[nodiscard]] Pose T_base_link(std::string_view link,
                                   const std::vector<double>& angles_rad) const;
};

/// Strict, as machine files are (models/rex.yaml shows every key); otherwise a usage error with
/// file, line, key, value and what to do.
[[nodiscard]] Result<MachineModel> parse_model(std::string_view yaml, const std::string& file);
[[nodiscard]] Result<MachineModel> read_model(const std::string& path);

}  // namespace surefoot::io
