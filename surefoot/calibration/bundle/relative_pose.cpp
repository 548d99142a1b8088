// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/relative_pose.hpp"

#include <vector>

#include "surefoot/calibration/bundle/view_check.hpp"
#include "surefoot/core/assert.hpp"

namespace surefoot::calibration {
namespace {

/// Rotation vectors are almost linear around their origin, so a few rounds are enough for full
/// precision.
constexpr int kRounds = 5;

template <typename Coordinates>
Eigen::Vector3d median_of(std::span<const Pose> poses, const Coordinates& coordinates) {
    Eigen::Vector3d result;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (const Pose& pose : poses) values.push_back(coordinates(pose)[axis]);
        result[axis] = median(values);
    }
    return result;
}

}  // namespace

Pose median_pose(std::span<const Pose> poses) {
    SUREFOOT_ASSERT(!poses.empty());
    Pose middle = poses.front();
    middle.translation_m = median_of(poses, [](const Pose& pose) { return pose.translation_m; });
    for (int round = 0; round < kRounds; ++round) {
        const Eigen::Vector3d turn = median_of(poses, [&](const Pose& pose) {
            return log_so3(middle.rotation.conjugate() * pose.rotation);
        });
        middle.rotation = (middle.rotation * exp_so3(turn)).normalized();
    }
    return middle;
}

PoseDistance distance(const Pose& a, const Pose& b) {
    return {(a.translation_m - b.translation_m).norm(),
            log_so3(a.rotation.conjugate() * b.rotation).norm()};
}

}  // namespace surefoot::calibration
