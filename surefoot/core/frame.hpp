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
    Eigen::Vector3d specific_force_m_s2 = Eigen::Vector3d::Zero();  ///< +g upward at rest
};

enum class Health : std::uint8_t { ok, degraded, lost };
[[nodiscard]] const char* to_string(Health health) noexcept;

/// Why the health is not ok; the first that applies is the reason reported.
enum class HealthReason : std::uint8_t {
    none,
    first_frame,     ///< nothing to compare with yet
    few_tracks,      ///< too few points agree on one motion
    poor_geometry,   ///< points too clustered to fix all six degrees of freedom
    blur,            ///< image too blurred or too dark for corners
    large_residual,  ///< tracks disagree with the motion more than their noise allows
    time_gap,        ///< the source skipped longer than the tracker can bridge
};
[[nodiscard]] const char* to_string(HealthReason reason) noexcept;

/// Where the machine is, and how sure that is.
struct MotionEstimate {
    std::int64_t time_ns = 0;
    Pose T_odom_body;                               ///< odom never jumps
    Pose T_previous_body;                           ///< motion since the previous frame
    Matrix6 relative_covariance = Matrix6::Zero();  ///< of T_previous_body; see pose.hpp
    Health health = Health::lost;
    HealthReason reason = HealthReason::first_frame;
    int tracks = 0;            ///< points that were followed into this frame
    int inliers = 0;           ///< of these, points that agree with the motion
    double residual_px = 0.0;  ///< rms reprojection error of the inliers
};

/// Depth and motion of one instant, where nobody has to compute them from images.
struct DepthAndMotion {
    DepthImage depth;       ///< of the rig, whose images are rectified
    MotionEstimate motion;  ///< its odom begins at the source's first base_link
};

/// What a source delivers at one instant: a raw stereo pair, or (RGB-D) one image with its depth,
/// or no image at all, but what the chain would have made of it.
struct StereoFrame {
    std::int64_t time_ns = 0;
    int index = 0;               ///< position in the source, from 0
    GreyImage left;              ///< raw (not rectified) 8-bit grey; empty with `ready`
    GreyImage right;             ///< empty for RGB-D
    Image<float> depth_m;        ///< RGB-D only: depth along z of the left camera, NaN = unknown
    std::vector<ImuSample> imu;  ///< samples since the previous frame, in time order
    std::optional<DepthAndMotion> ready;
};

}  // namespace surefoot
