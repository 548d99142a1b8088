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

/// A recording of the test data, with the calibration written out literally: the readers of `io`
/// are out of reach from here.
struct Recording {
    camera::StereoRig rig;
    int frames = 0;
    std::function<StereoFrame(int)> frame;  ///< loads frame 0, 1, ...
    std::vector<Pose> T_world_camera;  ///< truth of the left camera, one per frame; may be empty
};

/// A recording of which the images are gone and tracked points are left.
struct PointRecording {
    camera::StereoRig rig;  ///< with its IMU
    std::vector<PointFrame> frames;
    /// Truth of the left camera, one per frame; nothing where it is not known.
    std::vector<std::optional<Pose>> T_world_camera;
};

/// SUREFOOT_DATA_DIR, else the folder beside the sources.
[[nodiscard]] std::string data_folder();

// Each gives nothing when its data is not there.
[[nodiscard]] std::optional<Recording> kitti_city();
[[nodiscard]] std::optional<Recording> zed_office();
[[nodiscard]] std::optional<Recording> euroc_still();
/// A folder written by render_room.py, with its IMU.
[[nodiscard]] std::optional<Recording> rendered_room(const std::string& folder);

/// Corners of the AprilGrid in front of a hand-held EuRoC rig: 1439 frames, two parts with the grid
/// in view and 1.2 s between them. Truth by PnP. Nothing when tar cannot unpack it.
[[nodiscard]] std::optional<PointRecording> euroc_april();

/// The rig of EuRoC's V1 recordings; its IMU is the body.
[[nodiscard]] camera::StereoRig euroc_rig();
/// Rows of stamp [ns], x, y, z [rad/s], x, y, z [m/s^2]; empty without the file.
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
