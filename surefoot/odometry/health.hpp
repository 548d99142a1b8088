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
    bool cameras_swapped = false;        ///< each image shows the view of the other camera
    /// Points that disagree with the pose but agree with each other on a second motion.
    int other_motion = 0;
    double gap_s = 0.0;        ///< time since the previous frame
    double usual_gap_s = 0.0;  ///< time between the two previous frames; 0 = unknown
    bool stamp_grows = true;
    bool was_unsure = false;       ///< the previous frame was LOST, or too little depth recently
    bool torn_lately = false;      ///< an image shortly before this one was torn
    double sharpness_ratio = 1.0;  ///< sharpness of this frame / that of the last good frame
    double translation_sigma_m = 0.0;  ///< one sigma in the weakest direction
    double rotation_sigma_rad = 0.0;   ///< one sigma in the weakest direction
    double scene_depth_m = 0.0;        ///< median depth of the inliers; 0 = unknown
    bool imu_disagrees = false;        ///< the IMU contradicts vision in several frames in a row
    bool imu_gap = false;              ///< IMU samples are missing in at least two frames in a row
    bool machine_disagrees = false;    ///< machine motion contradicts vision for several frames
    bool beyond_machine = false;       ///< the pose implies a motion above the machine's limit
};

struct HealthVerdict {
    Health health = Health::lost;
    HealthReason reason = HealthReason::few_tracks;
};

/// Decides the health of a frame. LOST: swapped cameras, no pose, too few points, a pose beyond the
/// machine's speed, points that leave a direction uncertain, or `ok_inliers` points without any
/// measured depth although the right image has content. DEGRADED: a second motion, few points,
/// little measured depth, a weak direction, blur, a large residual, a time gap, or an IMU or
/// machine that disagrees. Also DEGRADED: the first frame after a LOST one and half a second after
/// too little depth (points found again may contradict the poses in between), and one second after
/// a torn image (more may follow). The reason names the cause if known: first a time gap, then
/// blur, then the points. An IMU gap alone leaves the health OK, with reason imu_gap.
[[nodiscard]] HealthVerdict judge(const OdometryConfig& config, const HealthEvidence& evidence);

/// Covariance of the unseen motion from `before_s` to `after_s` seconds after tracking was lost.
/// Assumes an unknown constant speed: consecutive intervals add up to (speed * time)^2.
[[nodiscard]] Matrix6 lost_covariance(const OdometryConfig& config,
                                      double before_s,
                                      double after_s);

/// Returns the estimate for a repeated or torn frame (`frame_status`) at `time_ns`, after `last`:
/// the pose of `last`, health LOST, and the covariance of the motion since `last`.
[[nodiscard]] MotionEstimate unseen_motion(const OdometryConfig& config,
                                           const MotionEstimate& last,
                                           std::int64_t time_ns,
                                           const FrameStatus& frame_status);

}  // namespace surefoot::odometry
