// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/odometry/inertial/inertial_config.hpp"
#include "surefoot/odometry/visual/point_frame.hpp"

namespace surefoot::odometry {

struct OdometryConfig {
    int max_tracks = 240;
    int grid_columns = 16;
    int grid_rows = 10;
    double min_depth_m = 0.4;
    double sigma_px = 0.2;
    int window_keyframes = 8;
    double still_parallax_px = 0.3;
    double bridge_s = 0.6;
    double max_gap_s = 1.0;
    int ok_inliers = 30;
    int min_inliers = 10;
    double ok_residual_px = 1.2;
    double calibration_share = 0.0025;
    /// Poses err by what their landmarks and pixels err, and share most of both with the pose
    /// before. After this time they are taken as independent, so that motions over some seconds,
    /// which the map composes of those between frames, state the error that they have
    /// (docs/evidence/accuracy.md).
    double landmark_s = 1.3;
    double lost_speed_m_s = 0.5;
    double lost_turn_rad_s = 0.5;
    /// What the machine can do, from its file; 0 = unknown. Faster motion is not believed.
    double machine_speed_m_s = 0.0;
    double machine_turn_deg_s = 0.0;
    InertialConfig imu;
    void describe(ConfigVisitor& visitor);
};

/// Stereo (or RGB-D) visual odometry, every frame, on the raw images of both eyes; points are
/// undistorted as points. Order of a frame: follow the landmarks by Lucas-Kanade from the predicted
/// motion, find the pose (P3P consensus), align the landmarks' patches in both eyes, refine the
/// pose; at keyframes add landmarks and adjust the last keyframes together.
///
/// Standing still is held exactly: a frame that statistics cannot tell from the pose where the
/// camera stopped keeps that pose. While lost the pose coasts to a halt with growing covariance,
/// and the landmarks are kept for `bridge_s` to find the way back; then they are seeded anew.
///
/// Where the rig says how long its rolling shutter reads an image, points are brought to the stamp
/// by the motion of the frame: that of the IMU, else the mean one since the frame before. The first
/// frame is taken for one of a camera at rest.
///
/// With an IMU the frames' samples predict the motion, and every pose comes from the points and the
/// preintegrated readings together (`inertial_solver`), the first second apart, from which gravity,
/// velocity and the gyroscope's bias are found. Odom is not turned by what the IMU says about
/// gravity. While lost the IMU carries the pose for `imu.dead_reckoning_s`. When it contradicts
/// vision for some time, vision goes on alone and the health is degraded. When samples are missing
/// vision goes on alone too, until the IMU has started anew; from the second such frame on the
/// reason is `imu_gap`, the health stays ok.
///
/// Where the frames bring what the machine says of its own motion (`machine_motion`), that predicts
/// when there is no IMU, weighs in by its covariance, and carries the pose while lost. When it
/// contradicts vision for some time, vision goes on alone and the health is degraded.
///
/// `update` is serial apart from what it gives to the executor; any executor gives the same bytes.
class Odometry {
  public:
    /// `rectifier` must outlive the odometry. Without `imu` the frames' samples are not used.
    Odometry(const OdometryConfig& config,
             const camera::Rectifier& rectifier,
             const std::optional<camera::ImuMount>& imu = std::nullopt);
    ~Odometry();
    Odometry(Odometry&&) noexcept;
    Odometry& operator=(Odometry&&) noexcept;

    /// Pose of base_link at the first frame (gravity aligned); call before the first update.
    void start_at(const Pose& T_odom_body);
    /// Follows the frame. Never throws, never jumps; health and reason say what happened. A frame
    /// whose images were there before, or are torn, is LOST and skipped
    /// (camera::FrameIntegrityCheck).
    [[nodiscard]] MotionEstimate update(const StereoFrame& frame, Executor& executor);
    /// The same for a frame that was found to be new and whole already.
    [[nodiscard]] MotionEstimate update_whole(const StereoFrame& frame, Executor& executor);
    /// The same by points that were found elsewhere: all of them are used, `sigma_px` is their
    /// noise. A change between images and points costs one LOST frame, which seeds new landmarks.
    [[nodiscard]] MotionEstimate update(const PointFrame& frame);
    /// Instead of `update_whole` for a frame whose images are not worth it, as its `arrival` says:
    /// keeps its inertial samples for the next one.
    void skip(const StereoFrame& frame, const FrameStatus& frame_status);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace surefoot::odometry
