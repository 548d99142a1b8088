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

/// Follows the inertial state from frame to frame beside visual odometry: it starts by itself from
/// the first second of vision, predicts, improves poses, reckons while nothing is seen, and gives
/// up when it contradicts vision. Order of a frame: `advance`, then one of `see`, `stand` and
/// `reckon`, then `place`.
///
/// Vision and IMU never agree quite: stamps jitter, mounts flex. How far the camera is from where
/// the IMU's path has it, frame by frame and at random, is measured on the way (`discord`) and
/// counts as noise between the two: a rig whose parts disagree by millimetres is led by its eyes,
/// one whose parts agree by both.
class InertialTracker {
  public:
    InertialTracker(const InertialConfig& config, const Pose& T_imu_camera);

    /// Takes the samples up to a frame at `time_ns`.
    void advance(std::span<const ImuSample> samples, std::int64_t time_ns);
    /// Takes samples of a frame that will not be asked about.
    void keep(std::span<const ImuSample> samples);
    /// Where the IMU says the camera is in this frame; nothing before the start.
    [[nodiscard]] std::optional<Pose> predicted() const;
    /// How the camera moves in this frame, per second (right perturbation of its pose); nothing
    /// before the start.
    [[nodiscard]] std::optional<Vector6> camera_velocity() const;
    /// The pose from vision and the IMU together; nothing when vision has to do alone. `seen` holds
    /// the points behind `visual`; `unmodelled` is what else may be wrong with the visual motion
    /// since the last frame (of the camera).
    [[nodiscard]] std::optional<CameraFix> see(const VisualEvidence& seen,
                                               const PoseSolution& visual,
                                               const Matrix6& unmodelled);
    /// The camera stands where it stood before.
    void stand(const CameraFix& held);
    /// The pose without vision, with the covariance of the motion since the last frame that was
    /// seen; nothing when the IMU does not know, or when that is longer ago than may be.
    [[nodiscard]] std::optional<CameraFix> reckon();
    /// Where the present frame was put in the end.
    void place(const Pose& T_odom_camera);
    /// Vision and the IMU have contradicted each other for some time, or once beyond any accident.
    [[nodiscard]] bool disagrees() const noexcept { return disagrees_; }
    /// Samples are missing, in this frame and the one before at least: vision has to do alone.
    [[nodiscard]] bool gap() const noexcept { return watch_.gap(); }
    /// The state after the last frame; nothing before the start.
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
    std::vector<ImuSample> samples_;  ///< from the last one at or before the present frame
    std::int64_t time_ns_ = 0;        ///< of the present frame
    bool has_time_ = false;
    Preintegration step_;                    ///< from the previous to the present frame
    std::optional<InertialBelief> belief_;   ///< after the previous frame
    std::optional<InertialBelief> present_;  ///< predicted for the present one
    std::optional<InertialBelief> unseen_;   ///< as belief_, pose errors since the last seen frame
    double blind_s_ = 0.0;                   ///< since then
    Pose T_odom_camera_;                     ///< of the present frame, as answered
    double discord_m_ = 0.0;
    double discord_rad_ = 0.0;
    std::vector<SeenMotion> frames_;  ///< until the start
    int contradictions_ = 0;          ///< in a row
    int agreements_ = 0;              ///< in a row
    bool disagrees_ = false;
};

}  // namespace surefoot::odometry
