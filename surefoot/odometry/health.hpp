// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/frame.hpp"
#include "surefoot/odometry/odometry.hpp"

namespace surefoot::odometry {

/// What is known about a frame when its health is judged.
struct HealthEvidence {
    bool pose_found = false;
    int tracks = 0;
    int inliers = 0;
    double residual_px = 0.0;
    /// Inliers of which the depth was measured in this frame: seen by both eyes.
    int depth_inliers = 0;
    bool right_shows_something = false;  ///< the right image is neither missing nor dark
    bool cameras_swapped = false;        ///< each eye shows what the other one should
    /// Points that disagree with the pose, but agree among each other on another one.
    int other_motion = 0;
    double gap_s = 0.0;        ///< since the previous frame
    double usual_gap_s = 0.0;  ///< the gap before that; 0 = unknown
    bool stamp_grows = true;
    bool was_unsure = false;       ///< no pose in the previous frame, or too little depth lately
    bool torn_lately = false;      ///< an image shortly before was torn
    double sharpness_ratio = 1.0;  ///< to the last good frame, see ImagePyramid::sharpness
    double translation_sigma_m = 0.0;  ///< weakest direction
    double rotation_sigma_rad = 0.0;   ///< weakest direction
    double scene_depth_m = 0.0;        ///< median of the inliers; 0 = unknown
    bool imu_disagrees = false;        ///< for some time
    bool imu_gap = false;              ///< samples are missing, for more than a frame
    bool machine_disagrees = false;    ///< likewise
    bool beyond_machine = false;       ///< faster than the machine can be
};

struct HealthVerdict {
    Health health = Health::lost;
    HealthReason reason = HealthReason::few_tracks;
};

/// Lost without a pose, with fewer than `min_inliers`, or when points agree in one direction only,
/// or when a right image shows something but not what the left one does, or the eyes are
/// exchanged. The first frame after that, and those within half a second of too few measured
/// depths, are degraded: what they find again may lie elsewhere than the poses meanwhile said (by
/// the baseline, where the eyes were exchanged). For a second after a torn image frames are
/// degraded: more of them may be torn. The reason is the cause where one is known: a time gap, then
/// blur, then what the points say. A gap of the IMU costs no accuracy as long as enough is seen:
/// OK, with that reason.
[[nodiscard]] HealthVerdict judge(const OdometryConfig& config, const HealthEvidence& evidence);

/// Covariance of the unseen motion between `before_s` and `after_s` seconds after the camera was
/// lost. The speed is unknown but lasting, so that the parts add up to (speed * time)^2.
[[nodiscard]] Matrix6 lost_covariance(const OdometryConfig& config,
                                      double before_s,
                                      double after_s);

/// What is said of a frame at `time_ns` that shows nothing new (`arrival`), after `last`: the pose
/// then, LOST, with the motion that may have gone unseen since.
[[nodiscard]] MotionEstimate unseen_motion(const OdometryConfig& config,
                                           const MotionEstimate& last,
                                           std::int64_t time_ns,
                                           const FrameStatus& frame_status);

}  // namespace surefoot::odometry
