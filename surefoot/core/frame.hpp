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

/// Why the health is not ok; the first that applies is the reason reported. `imu_gap` alone comes
/// with a health that is ok.
enum class HealthReason : std::uint8_t {
    none,
    first_frame,           ///< nothing to compare with yet
    few_tracks,            ///< too few points agree on one motion
    poor_geometry,         ///< points too clustered to fix all six degrees of freedom
    blur,                  ///< image too blurred or too dark for corners
    large_residual,        ///< tracks disagree with the motion more than their noise allows
    time_gap,              ///< the source skipped frames, or its stamps do not grow
    repeated_image,        ///< the same image once more: nothing was seen at this instant
    torn_image,            ///< parts of two images in one
    cameras_swapped,       ///< each eye shows what the other one should
    imu_disagreement,      ///< the IMU contradicts what is seen; vision goes on alone
    machine_disagreement,  ///< what the machine says of its motion contradicts what is seen
    beyond_machine,        ///< faster than the machine can move: not believed
    moving_scene,          ///< many points agree on another motion: somebody stands in the view
    recovered,             ///< found again after LOST: the pose may have moved by what went unseen
    imu_gap,               ///< samples of the IMU are missing or useless; vision goes on alone
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

/// How base_link moved since the frame before (in time order, every frame counts), as the machine
/// itself tells it: by its joints over the foot that stands, by its wheels.
struct MachineMotion {
    Pose T_previous_body;
    Matrix6 covariance = Matrix6::Zero();  ///< of T_previous_body; see pose.hpp
};

/// How a frame came in, apart from what it shows: the evidence for a stopped, frozen or torn camera
/// (hazards H1 and H2 of the gate). Counts are since the previous frame of the source.
struct FrameStatus {
    int dropped = 0;      ///< lost before they reached us, by the device's own frame counter
    int skipped = 0;      ///< given up because newer ones were waiting already
    int damaged = 0;      ///< too short, or impossible to decode
    int reconnected = 0;  ///< how often the device had to be opened again
    /// How many frames in a row, up to this one, brought an image that was there before; 0 = new.
    int repeated = 0;
    bool torn = false;  ///< one part is new, the rest is that of an earlier image

    /// May it count as something seen at its time stamp?
    [[nodiscard]] bool is_new_and_whole() const noexcept { return repeated == 0 && !torn; }
};

/// What a source delivers at one instant: a raw stereo pair, or (RGB-D) one image with its depth,
/// or no image at all, but what the chain would have made of it. What is known already is not
/// computed.
struct StereoFrame {
    std::int64_t time_ns = 0;
    int index = 0;               ///< position in the source, from 0
    GreyImage left;              ///< raw (not rectified) 8-bit grey; empty with `known_depth`
    GreyImage right;             ///< empty for RGB-D
    Image<float> depth_m;        ///< RGB-D only: depth along z of the left camera, NaN = unknown
    std::vector<ImuSample> imu;  ///< samples since the previous frame, in time order
    std::optional<MachineMotion> machine_motion;
    std::optional<DepthImage> known_depth;  ///< of the rig, whose images are rectified
    /// Its odom begins at the source's first base_link.
    std::optional<MotionEstimate> known_motion;
    FrameStatus frame_status;
};

}  // namespace surefoot
