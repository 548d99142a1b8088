// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "surefoot/odometry/inertial/imu_watch.hpp"
#include "surefoot/odometry/inertial/inertial_config.hpp"
#include "surefoot/odometry/inertial/inertial_solver.hpp"
#include "surefoot/odometry/inertial/inertial_start.hpp"

namespace surefoot::odometry {

/// Pose of the camera with its covariance.
struct CameraFix {
    Pose T_odom_camera;
    Matrix6 covariance = Matrix6::Zero();
};

/// Tracks the inertial state from frame to frame beside visual odometry. It initialises itself from
/// the first second of vision, predicts the motion, improves poses, dead-reckons while nothing is
/// seen, and resets when it contradicts vision. Order of calls in a frame: `advance`, then one of
/// `see`, `stand` and `reckon`, then `place`.
///
/// Vision and IMU never agree exactly, because stamps jitter and mounts flex. The tracker measures
/// this random disagreement (`discord`) frame by frame and adds it as noise between the two. A rig
/// whose sensors disagree by millimetres therefore follows vision; a rig whose sensors agree
/// follows both.
class InertialTracker {
  public:
    InertialTracker(const InertialConfig& config, const Pose& T_imu_camera);

    /// Takes the samples up to the frame at `time_ns` and predicts its state.
    void advance(std::span<const ImuSample> samples, std::int64_t time_ns);
    /// Takes the samples of a skipped frame.
    void keep(std::span<const ImuSample> samples);
    /// Camera pose of this frame as the IMU predicts it; nothing before the initialisation.
    [[nodiscard]] std::optional<Pose> predicted() const;
    /// Velocity of the camera in this frame [m/s, rad/s], as right perturbation of its pose per
    /// second; nothing before the initialisation.
    [[nodiscard]] std::optional<Vector6> camera_velocity() const;
    /// Pose from vision and IMU together; nothing when vision must continue alone. `seen` holds the
    /// points behind `visual`. `unmodelled` is the covariance of further errors of the visual
    /// motion since the last frame (in camera axes).
    [[nodiscard]] std::optional<CameraFix> see(const VisualEvidence& seen,
                                               const PoseSolution& visual,
                                               const Matrix6& unmodelled);
    /// Takes a frame in which the camera still stands where it stopped; `held` is its pose.
    void stand(const CameraFix& held);
    /// Pose without vision, with the covariance of the motion since the last frame with vision.
    /// Nothing when the IMU has no state or that frame is longer ago than `dead_reckoning_s`.
    [[nodiscard]] std::optional<CameraFix> reckon();
    /// Sets the final pose of the present frame.
    void place(const Pose& T_odom_camera);
    /// True if the initialisation failed, or if vision and IMU disagreed for long or by 15 sigma.
    [[nodiscard]] bool disagrees() const noexcept { return disagrees_; }
    /// True if samples are missing in this and the previous frame: vision continues alone.
    [[nodiscard]] bool gap() const noexcept { return watch_.gap(); }
    /// State after the last frame; nothing before the initialisation.
    [[nodiscard]] const std::optional<InertialBelief>& belief() const noexcept { return belief_; }

  private:
    void listen(const Vector6& off, const Matrix6& expected);
    [[nodiscard]] Matrix6 discord_covariance() const;
    void collect(const Pose& T_odom_imu, const Matrix6& covariance);
    void give_up();
    [[nodiscard]] Matrix6 predicted_covariance() const;
    [[nodiscard]] bool still_agrees(double chi2);
    void believe(const InertialBelief& belief);

    InertialConfig config_;
    InertialModel model_;
    ImuWatch watch_;
    std::vector<ImuSample> samples_;  ///< samples from the last one at or before this frame on
    std::int64_t time_ns_ = 0;        ///< stamp of the present frame
    bool has_time_ = false;
    Preintegration step_;                    ///< motion from the previous to the present frame
    std::optional<InertialBelief> belief_;   ///< belief after the previous frame
    std::optional<InertialBelief> present_;  ///< predicted belief for the present frame
    std::optional<InertialBelief> unseen_;  ///< belief_; pose errors count from the last seen frame
    double blind_s_ = 0.0;                  ///< time since the last seen frame
    Pose T_odom_camera_;                    ///< returned pose of the present frame
    double discord_m_ = 0.0;
    double discord_rad_ = 0.0;
    std::vector<SeenMotion> frames_;  ///< frames until the initialisation
    int contradictions_ = 0;          ///< number of consecutive contradictions
    int agreements_ = 0;              ///< number of consecutive agreements
    bool disagrees_ = false;
};

}  // namespace surefoot::odometry
