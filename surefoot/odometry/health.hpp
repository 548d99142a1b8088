// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/frame.hpp"
#include "surefoot/odometry/odometry.hpp"

namespace surefoot::odometry {

/// Evidence from which `judge` decides the health of a frame.
struct HealthEvidence {
    bool pose_found = false;
    int tracks = 0;
    int inliers = 0;
    double residual_px = 0.0;
    /// Inliers whose depth was measured in this frame, because both cameras see them.
    int depth_inliers = 0;
    bool right_shows_something = false;  ///< the right image is neither missing nor dark
    bool cameras_swapped = false;        ///< the left image is the right camera's and vice versa
    /// Points that disagree with the pose but agree with each other on a second motion.
    int other_motion = 0;
    double gap_s = 0.0;        ///< since the previous frame
    double usual_gap_s = 0.0;  ///< the gap before that; 0 = unknown
    bool stamp_grows = true;
    bool was_unsure = false;       ///< no pose in the previous frame, or too little depth recently
    bool torn_lately = false;      ///< an image shortly before this one was torn
    double sharpness_ratio = 1.0;  ///< to the last good frame, see ImagePyramid::sharpness
    double translation_sigma_m = 0.0;  ///< weakest direction
    double rotation_sigma_rad = 0.0;   ///< weakest direction
    double scene_depth_m = 0.0;        ///< median of the inliers; 0 = unknown
    bool imu_disagrees = false;        ///< the IMU disagrees for several frames in a row
    bool imu_gap = false;              ///< samples are missing, for more than a frame
    bool machine_disagrees = false;    ///< the machine disagrees for several frames in a row
    bool beyond_machine = false;       ///< faster than the machine can move
};

struct HealthVerdict {
    Health health = Health::lost;
    HealthReason reason = HealthReason::few_tracks;
};

/// Decides the health of a frame. LOST: no pose, fewer than `min_inliers`, points that agree
/// in one direction only, a right image with content but no measured depth, or swapped
/// cameras. DEGRADED: the first frame after that, and half a second after too few depths.
/// Points found again then may lie elsewhere than the poses meanwhile said (by the baseline
/// after swapped cameras). DEGRADED too: one second after a torn image, because more may
/// follow. The reason names the cause if known: first a time gap, then blur, then the
/// points. An IMU gap costs no accuracy while enough points are seen: health OK, reason
/// imu_gap.
[[nodiscard]] HealthVerdict judge(const OdometryConfig& config, const HealthEvidence& evidence);

/// Covariance of the unseen motion between `before_s` and `after_s` seconds after the tracking was
/// lost. The speed is unknown but constant, so that parts of the time add up to (speed * time)^2.
[[nodiscard]] Matrix6 lost_covariance(const OdometryConfig& config,
                                      double before_s,
                                      double after_s);

/// Motion estimate for a frame at `time_ns` after `last` that is repeated or torn (`frame_status`).
/// It has the pose of `last`, health LOST, and the covariance of the motion since then.
[[nodiscard]] MotionEstimate unseen_motion(const OdometryConfig& config,
                                           const MotionEstimate& last,
                                           std::int64_t time_ns,
                                           const FrameStatus& frame_status);

}  // namespace surefoot::odometry
