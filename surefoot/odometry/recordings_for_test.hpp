// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/frame.hpp"

namespace surefoot::odometry::testing {

/// A recording of the test data, with the calibration written out literally: the readers of `io`
/// are out of reach from here.
struct Recording {
    camera::StereoRig rig;
    int frames = 0;
    std::function<StereoFrame(int)> frame;  ///< loads frame 0, 1, ...
    std::vector<Pose> T_world_camera;  ///< truth of the left camera, one per frame; may be empty
};

/// SUREFOOT_DATA_DIR, else the folder beside the sources.
[[nodiscard]] std::string data_folder();

// Each gives nothing when its data is not there.
[[nodiscard]] std::optional<Recording> kitti_city();
[[nodiscard]] std::optional<Recording> zed_office();
[[nodiscard]] std::optional<Recording> euroc_still();
/// A folder written by render_room.py.
[[nodiscard]] std::optional<Recording> rendered_room(const std::string& folder);

/// Rms distance of positions after the best rigid alignment (Umeyama 1991 without scale) [m].
[[nodiscard]] double aligned_rmse_m(const std::vector<Eigen::Vector3d>& estimate,
                                    const std::vector<Eigen::Vector3d>& truth);

}  // namespace surefoot::odometry::testing
