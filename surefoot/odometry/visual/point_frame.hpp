// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "surefoot/core/frame.hpp"

namespace surefoot::odometry {

/// A point of the scene where both eyes see it, found by somebody else: the corner of a marker, or
/// the track of another front-end.
struct SeenPoint {
    std::int64_t id = 0;  ///< the same for the same point, whenever it is seen
    Eigen::Vector2d raw_left_px = Eigen::Vector2d::Zero();
    std::optional<Eigen::Vector2d> raw_right_px;  ///< nothing where the right eye does not see it
};

/// What is seen at one instant, instead of images. Where the points lie in space is not asked for.
struct PointFrame {
    std::int64_t time_ns = 0;
    std::vector<SeenPoint> points;  ///< of one id the first counts; may be empty
    std::vector<ImuSample> imu;     ///< samples since the previous frame, in time order
    std::optional<MachineMotion> machine_motion;
};

}  // namespace surefoot::odometry
