// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::camera {

/// Frames that a source passed over because they cannot be had.
struct BrokenFrames {
    int count = 0;
    std::string first;  ///< why the first of them cannot be had
};

struct SourceInfo {
    std::string kind;  ///< "euroc", "kitti", "side_by_side", "tum_rgbd", "sim", ...
    std::string path;
    std::optional<int> frames;  ///< how many there are, where that is known beforehand
    bool has_imu = false;
    bool modelled_depth = false;   ///< frames come with depth that nobody measured
    bool modelled_motion = false;  ///< frames come with motion that nobody measured
    /// Stamps are of this machine's steady clock (CLOCK_MONOTONIC): how old a frame is can be told.
    bool steady_stamps = false;
    /// base_link of the first frame in odom (z up, the ground at 0), where the source knows.
    std::optional<Pose> T_odom_first_body = {};
    std::vector<std::string> notes = {};  ///< what a user should know about how it was opened
    BrokenFrames broken = {};             ///< up to now
};

/// Where frames come from: a recording, a video, a camera, a simulated scene. Frames come in time
/// order with strictly growing stamps; anything else is an error that names file and frame.
class FrameSource {
  public:
    virtual ~FrameSource() = default;
    [[nodiscard]] virtual const StereoRig& rig() const = 0;
    [[nodiscard]] virtual const SourceInfo& info() const = 0;
    /// The next frame, nothing at the end, or why the frame cannot be had.
    [[nodiscard]] virtual Result<std::optional<StereoFrame>> next() = 0;
};

}  // namespace surefoot::camera
