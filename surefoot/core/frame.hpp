// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/core/depth_image.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot {

/// One inertial sample in the IMU's own frame.
struct ImuSample {
    std::int64_t time_ns = 0;
    Eigen::Vector3d angular_velocity_rad_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d specific_force_m_s2 = Eigen::Vector3d::Zero();  ///< at rest: g, upward
};

enum class Health : std::uint8_t { ok, degraded, lost };
[[nodiscard]] const char* to_string(Health health) noexcept;

/// Reason for the health: the first reason that applies. Health ok has the reason `none` or
/// `imu_gap`; every other reason comes with degraded or lost.
enum class HealthReason : std::uint8_t {
    none,
    first_frame,           ///< no earlier frame to compare with
    few_tracks,            ///< too few points agree on one motion
    poor_geometry,         ///< points too clustered to fix all six degrees of freedom
    blur,                  ///< image too blurred or too dark for corners
    large_residual,        ///< the rms reprojection error of the inliers exceeds its limit
    time_gap,              ///< too long since the previous frame, or stamps do not increase
    repeated_image,        ///< the image equals an earlier one: no observation at this instant
    torn_image,            ///< a part of the images comes from an earlier frame
    cameras_swapped,       ///< the left and right images are swapped
    imu_disagreement,      ///< the IMU contradicts the images; vision continues without it
    machine_disagreement,  ///< the motion that the machine reports contradicts the images
    beyond_machine,        ///< the motion is faster than the machine allows and is rejected
    moving_scene,          ///< many points agree on another motion, e.g. of a person in view
    recovered,             ///< motion estimated again after LOST; the motion in between is unknown
    imu_gap,               ///< IMU samples are missing or invalid; vision continues without it
};
[[nodiscard]] const char* to_string(HealthReason reason) noexcept;

/// Pose of the machine with its uncertainty.
struct MotionEstimate {
    std::int64_t time_ns = 0;
    Pose T_odom_body;                               ///< pose of base_link in odom, without jumps
    Pose T_previous_body;                           ///< motion since the previous frame
    Matrix6 relative_covariance = Matrix6::Zero();  ///< covariance of T_previous_body; see pose.hpp
    Health health = Health::lost;
    HealthReason reason = HealthReason::first_frame;
    int tracks = 0;            ///< number of points tracked into this frame
    int inliers = 0;           ///< number of tracked points that agree with the motion
    double residual_px = 0.0;  ///< rms reprojection error of the inliers
};

/// Motion of base_link since the previous frame, even if that frame is repeated or torn. The
/// machine measures this motion with its joints over the standing foot, or with its wheels.
struct MachineMotion {
    Pose T_previous_body;
    Matrix6 covariance = Matrix6::Zero();  ///< covariance of T_previous_body; see pose.hpp
};

/// Delivery of a frame: evidence for a stopped or frozen camera and for torn images (hazards H1 and
/// H2 of the gate). `dropped` to `reconnected` count since the source's previous frame.
struct FrameStatus {
    int dropped = 0;      ///< frames lost before delivery; the device counts them
    int skipped = 0;      ///< frames discarded because newer frames were waiting
    int damaged = 0;      ///< frames too short or impossible to decode
    int reconnected = 0;  ///< number of times the device was reopened
    /// Number of consecutive frames, up to this one, whose image is not new; 0 = new image.
    int repeated = 0;
    bool torn = false;  ///< one part of the images is new, the rest is of an earlier frame

    /// True if the frame counts as an observation at its time stamp.
    [[nodiscard]] bool is_new_and_whole() const noexcept { return repeated == 0 && !torn; }
};

/// One frame of a source: a raw stereo pair, one image with depth (RGB-D), or a modelled frame. A
/// modelled frame has its depth in place of images. Every frame can also carry its motion. The
/// pipeline does not compute values that the frame carries.
struct StereoFrame {
    std::int64_t time_ns = 0;
    int index = 0;               ///< position in the source, counted from 0
    GreyImage left;              ///< raw (not rectified) 8-bit grey; empty with `known_depth`
    GreyImage right;             ///< empty for RGB-D
    Image<float> depth_m;        ///< RGB-D only: depth along z of the left camera, NaN = unknown
    std::vector<ImuSample> imu;  ///< samples since the previous frame, in time order
    std::optional<MachineMotion> machine_motion;
    std::optional<DepthImage> known_depth;  ///< depth of the pixels of the rectified left image
    /// Known motion. Its odom frame is base_link at the source's first frame.
    std::optional<MotionEstimate> known_motion;
    FrameStatus frame_status;
};

}  // namespace surefoot
