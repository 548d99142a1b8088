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

/// Frames that a source skipped because they are unreadable.
struct BrokenFrames {
    int count = 0;
    std::string first;  ///< reason why the first skipped frame is unreadable
};

struct SourceInfo {
    std::string kind;  ///< for example "euroc", "kitti", "side_by_side", "tum_rgbd" or "sim"
    std::string path;
    std::optional<int> frames;  ///< number of frames, if the source knows it in advance
    bool has_imu = false;
    bool modelled_depth = false;   ///< the depth of the frames is known, not measured
    bool modelled_motion = false;  ///< the motion of the frames is known, not measured
    /// True if stamps are times of this computer's CLOCK_MONOTONIC. Then the frame age is known.
    bool steady_stamps = false;
    /// Pose of base_link at the first frame in odom (z up, ground at 0), if the source knows it.
    std::optional<Pose> T_odom_first_body = {};
    std::vector<std::string> notes = {};  ///< notes for the user about how the source was opened
    BrokenFrames broken = {};             ///< skipped frames so far
};

/// A source of frames: a recording, a video, a camera, or a simulated scene. Frames are in time
/// order with strictly increasing stamps. Any other stamp is an error with file and frame number.
class FrameSource {
  public:
    virtual ~FrameSource() = default;
    [[nodiscard]] virtual const StereoRig& rig() const = 0;
    [[nodiscard]] virtual const SourceInfo& info() const = 0;
    /// Returns the next frame, nullopt at the end, or an error if the frame cannot be read.
    [[nodiscard]] virtual Result<std::optional<StereoFrame>> next() = 0;
};

}  // namespace surefoot::camera
