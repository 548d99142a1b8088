// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "surefoot/core/frame.hpp"

namespace surefoot::odometry {

/// Observation of a scene point by both cameras, from another source: the corner of a marker, or
/// the track of another front end.
struct SeenPoint {
    std::int64_t id = 0;  ///< id of the point in all observations
    Eigen::Vector2d raw_left_px = Eigen::Vector2d::Zero();
    std::optional<Eigen::Vector2d> raw_right_px;  ///< empty: not visible to the right camera
};

/// Point observations of one instant, used instead of images. Positions in space are not needed.
struct PointFrame {
    std::int64_t time_ns = 0;
    std::vector<SeenPoint> points;  ///< if an id repeats, the first counts; may be empty
    std::vector<ImuSample> imu;     ///< samples since the previous frame, in time order
    std::optional<MachineMotion> machine_motion;
};

}  // namespace surefoot::odometry
