// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/odometry/inertial/imu_preintegration.hpp"
#include "surefoot/odometry/visual/pose_solver.hpp"

namespace surefoot::odometry {

/// Components of an inertial state's error, and where they begin.
inline constexpr int kInertialSize = 17;
inline constexpr int kPoseAt = 0;      ///< (translation, rotation) as in pose.hpp
inline constexpr int kVelocityAt = 6;  ///< in odom axes
inline constexpr int kGyroBiasAt = 9;
inline constexpr int kAccelBiasAt = 12;
inline constexpr int kTiltAt = 15;  ///< of gravity in odom
using Vector17 = Eigen::Matrix<double, kInertialSize, 1>;
using Matrix17 = Eigen::Matrix<double, kInertialSize, kInertialSize>;

/// What the IMU's readings depend on at one instant.
struct InertialState {
    Pose T_odom_imu;
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();  ///< of the IMU, in odom axes
    ImuBias bias;
    /// Odom need not be level: up is R_odom_level Exp(tilt_x, tilt_y, 0) applied to z. The first
    /// factor never changes after the start.
    Eigen::Quaterniond R_odom_level = Eigen::Quaterniond::Identity();
    Eigen::Vector2d tilt_rad = Eigen::Vector2d::Zero();

    [[nodiscard]] Eigen::Vector3d up_odom() const;
};
[[nodiscard]] InertialState perturbed(const InertialState& state, const Vector17& delta);
/// The delta with `to == perturbed(from, delta)`; both start from the same R_odom_level.
[[nodiscard]] Vector17 difference(const InertialState& from, const InertialState& to);

/// A state and how sure it is.
struct InertialBelief {
    InertialState state;
    Matrix17 covariance = Matrix17::Zero();
};

struct InertialModel {
    Pose T_imu_camera;
    ImuNoise noise;
    double gravity_m_s2 = 9.80665;
};

/// What the present frame sees: landmarks that are given, as in `refine_pose`.
struct VisualEvidence {
    const camera::RectifiedRig& rig;
    const PoseSolverConfig& config;
    std::span<const PointMatch> matches;
    double residual_scale = 1.0;  ///< the pixel noise is this many times the configured one
};

/// A pose that is known by itself, and the speed where the machine stands.
struct PoseEvidence {
    Pose T_odom_imu;
    Matrix6 covariance = Matrix6::Zero();
    std::optional<double> standing_sigma_m_s;  ///< the velocity is zero up to this
};

struct InertialSolution {
    bool found = false;  ///< else nothing below means anything
    InertialBelief belief;
    std::vector<std::uint8_t> inlier;  ///< one per match
    int inliers = 0;
    double residual_px = 0.0;  ///< rms of the pixel components of the inliers
};

/// Where the IMU alone says that the present frame is, `motion` after `before`.
[[nodiscard]] InertialBelief predict(const InertialModel& model,
                                     const InertialBelief& before,
                                     const ImuMotion& motion);

/// The most likely states of the previous and the present frame, given a belief about the previous
/// one, the IMU's motion between them, and what the present frame sees: Gauss-Newton over both
/// states and gravity, robust for the points as `refine_pose` is; then the previous state is
/// marginalised (Schur complement). What comes out is the belief about the present state.
///
/// The landmarks are taken as known but for their covariance, which counts as noise of this frame
/// alone; see `with_vision_counted_once` for what that means for the next frame.
///
/// The residuals are those of Forster et al. 2017, (45), with gravity's direction as an unknown.
[[nodiscard]] InertialSolution fuse(const InertialModel& model,
                                    const InertialBelief& before,
                                    const ImuMotion& motion,
                                    const VisualEvidence& seen,
                                    const Pose& T_odom_camera_start);
/// The same with a pose instead of points; one that stands shows the gyroscope's bias.
[[nodiscard]] InertialSolution fuse(const InertialModel& model,
                                    const InertialBelief& before,
                                    const ImuMotion& motion,
                                    const PoseEvidence& known);

/// The belief to go on with after a frame whose vision alone knows the pose up to
/// `visual_covariance` (of the IMU's pose). Neighbouring frames see the same landmarks with the
/// same errors: a pose that gathered information from frame to frame would count them again and
/// again. Assumed is the worst, that all of the visual error is theirs: the pose's covariance is
/// raised to that of vision alone, as by an independent shift of the map. What vision told about
/// velocity, biases and gravity, which come from differences of poses, stays.
[[nodiscard]] InertialBelief with_vision_counted_once(const InertialBelief& belief,
                                                      const Matrix6& visual_covariance);

/// Of a difference of covariances what is not negative in any direction.
[[nodiscard]] Matrix6 positive_part(const Matrix6& symmetric);

/// Covariance of T_a_c = T_a_b * T_b_c for a fixed T_b_c.
[[nodiscard]] Matrix6 carried_covariance(const Matrix6& covariance_ab, const Pose& T_b_c);

}  // namespace surefoot::odometry
