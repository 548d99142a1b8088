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
    /// Two poses share most errors of their landmarks and pixels. After this time their
    /// errors count as independent. Motions over several seconds, which the map composes from
    /// motions between frames, then state the error that they really have
    /// (docs/evidence/accuracy.md).
    double landmark_s = 1.3;
    double lost_speed_m_s = 0.5;
    double lost_turn_rad_s = 0.5;
    /// Largest speed and turn rate of the machine; 0 = unknown. Faster motion is rejected.
    double machine_speed_m_s = 0.0;
    double machine_turn_deg_s = 0.0;
    InertialConfig imu;
    void describe(ConfigVisitor& visitor);
};

/// Stereo (or RGB-D) visual odometry on the raw images of both cameras; only points are
/// undistorted. For each frame: track the landmarks by Lucas-Kanade from the predicted motion, then
/// find the pose (P3P and RANSAC). Then align the landmarks' patches in both cameras and refine the
/// pose. At keyframes add landmarks and adjust the last keyframes together (bundle adjustment).
///
/// Standing still causes no drift: a frame whose pose does not differ significantly from the pose
/// at the stop keeps that pose. While lost, the pose coasts to a halt with growing covariance.
/// Landmarks are kept for `bridge_s` to recover the pose; then new landmarks are seeded.
///
/// If the rig states the readout time of its rolling shutter, points are moved to the frame's
/// stamp. The IMU gives the motion; without an IMU, the mean motion since the previous frame is
/// used. The first frame is treated as a frame of a camera at rest.
///
/// With an IMU, the samples of a frame predict the motion, and points and preintegrated readings
/// together give the pose (`inertial_solver`). The first second of vision only serves to find
/// gravity, velocity and gyroscope bias. The IMU's gravity never rotates odom. While lost, the IMU
/// carries the pose for `imu.dead_reckoning_s`. If the IMU contradicts vision for some time, vision
/// continues alone and the health is DEGRADED. If samples are missing, vision also continues alone
/// until the IMU has started again; from the second such frame on the reason is `imu_gap` and the
/// health stays OK.
///
/// Frames may bring the machine's own motion (`machine_motion`). It predicts the motion if there is
/// no IMU, improves the pose by its covariance, and carries the pose while lost. If it contradicts
/// vision for some time, vision continues alone and the health is DEGRADED.
///
/// `update` is serial except for the executor's work. Every executor gives the same bytes.
class Odometry {
  public:
    /// `rectifier` must outlive the odometry. Without `imu` the samples of the frames are not used.
    Odometry(const OdometryConfig& config,
             const camera::Rectifier& rectifier,
             const std::optional<camera::ImuMount>& imu = std::nullopt);
    ~Odometry();
    Odometry(Odometry&&) noexcept;
    Odometry& operator=(Odometry&&) noexcept;

    /// Sets base_link's pose at the first frame (gravity aligned). Call before the first update.
    void start_at(const Pose& T_odom_body);
    /// Tracks the frame. Never throws, and the pose never jumps; health and reason say what
    /// happened. A frame with repeated or torn images is LOST and skipped
    /// (camera::FrameIntegrityCheck).
    [[nodiscard]] MotionEstimate update(const StereoFrame& frame, Executor& executor);
    /// Processes a frame that has already passed the frame integrity check.
    [[nodiscard]] MotionEstimate update_whole(const StereoFrame& frame, Executor& executor);
    /// Tracks the points of another source. All have the same noise: `sigma_px`, or the measured if
    /// clearly larger. A change between images and points costs a LOST frame (new landmarks).
    [[nodiscard]] MotionEstimate update(const PointFrame& frame);
    /// Replaces `update_whole` for a frame whose images are repeated or torn, as `frame_status`
    /// says. Keeps the frame's IMU samples for the next frame.
    void skip(const StereoFrame& frame, const FrameStatus& frame_status);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace surefoot::odometry
