// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/odometry/visual/point_frame.hpp"

namespace surefoot::odometry::testing {

/// A recording of the test data. Its calibration is a literal in the code, because this module must
/// not include the readers of `io`.
struct Recording {
    camera::StereoRig rig;
    int frames = 0;
    std::function<StereoFrame(int)> frame;  ///< loads frame 0, 1, ...
    std::vector<Pose> T_world_camera;  ///< truth of the left camera, one per frame; may be empty
};

/// A recording without images: only tracked points remain.
struct PointRecording {
    camera::StereoRig rig;  ///< with its IMU
    std::vector<PointFrame> frames;
    /// Truth of the left camera, one per frame; empty where it is unknown.
    std::vector<std::optional<Pose>> T_world_camera;
};

/// SUREFOOT_DATA_DIR if it is set, otherwise the folder beside the sources.
[[nodiscard]] std::string data_folder();

// Each function returns nothing when its data are not there.
[[nodiscard]] std::optional<Recording> kitti_city();
[[nodiscard]] std::optional<Recording> zed_office();
[[nodiscard]] std::optional<Recording> euroc_still();
/// A folder that render_room.py has written, with its IMU samples.
[[nodiscard]] std::optional<Recording> rendered_room(const std::string& folder);

/// Corners of the AprilGrid in front of a hand-held EuRoC rig: 1439 frames; 1416 of them show
/// the grid, in two parts 1.2 s apart. Truth by PnP. Empty if tar cannot unpack the data.
[[nodiscard]] std::optional<PointRecording> euroc_april();

/// The rig of EuRoC's V1 recordings; its IMU frame is the body frame.
[[nodiscard]] camera::StereoRig euroc_rig();
/// Reads rows of stamp [ns], x, y, z [rad/s], x, y, z [m/s^2]; empty if the file is missing.
[[nodiscard]] std::vector<ImuSample> read_imu(const std::string& path);
/// The samples after `after_ns` and up to `until_ns`.
[[nodiscard]] std::vector<ImuSample> samples_between(const std::vector<ImuSample>& imu,
                                                     std::int64_t after_ns,
                                                     std::int64_t until_ns);
/// Poses of a TUM file, in file order.
[[nodiscard]] Trajectory read_tum(const std::string& path);

/// Rms distance of positions after the best rigid alignment (Umeyama 1991 without scale) [m].
[[nodiscard]] double aligned_rmse_m(const std::vector<Eigen::Vector3d>& estimate,
                                    const std::vector<Eigen::Vector3d>& truth);

}  // namespace surefoot::odometry::testing
