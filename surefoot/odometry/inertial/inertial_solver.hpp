// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/odometry/inertial/imu_preintegration.hpp"
#include "surefoot/odometry/visual/pose_solver.hpp"

namespace surefoot::odometry {

/// Layout of the error vector of an inertial state: first index of each component.
inline constexpr int kInertialSize = 17;
inline constexpr int kPoseAt = 0;      ///< index of the pose: translation, rotation, as in pose.hpp
inline constexpr int kVelocityAt = 6;  ///< index of the velocity in odom axes
inline constexpr int kGyroBiasAt = 9;
inline constexpr int kAccelBiasAt = 12;
inline constexpr int kTiltAt = 15;  ///< index of the tilt of gravity in odom
using Vector17 = Eigen::Matrix<double, kInertialSize, 1>;
using Matrix17 = Eigen::Matrix<double, kInertialSize, kInertialSize>;

/// The quantities on which the IMU's readings depend at one instant.
struct InertialState {
    Pose T_odom_imu;
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();  ///< velocity of the IMU, in odom axes
    ImuBias bias;
    /// Odom need not be level: up is R_odom_level Exp(tilt_x, tilt_y, 0) applied to z. R_odom_level
    /// never changes after the start.
    Eigen::Quaterniond R_odom_level = Eigen::Quaterniond::Identity();
    Eigen::Vector2d tilt_rad = Eigen::Vector2d::Zero();

    [[nodiscard]] Eigen::Vector3d up_odom() const;
};
[[nodiscard]] InertialState perturbed(const InertialState& state, const Vector17& delta);
/// Returns the delta for which `to == perturbed(from, delta)`. Both must share R_odom_level.
[[nodiscard]] Vector17 difference(const InertialState& from, const InertialState& to);

/// A state and its covariance.
struct InertialBelief {
    InertialState state;
    Matrix17 covariance = Matrix17::Zero();
};

struct InertialModel {
    Pose T_imu_camera;
    ImuNoise noise;
    double gravity_m_s2 = 9.80665;
};

/// Observations of the present frame: matches with known landmarks, as in `refine_pose`.
struct VisualEvidence {
    const camera::RectifiedRig& rig;
    const PoseSolverConfig& config;
    std::span<const PointMatch> matches;
    double residual_scale = 1.0;  ///< actual pixel noise / configured pixel noise
};

/// A pose known from another source, and a velocity of zero if the machine stands still.
struct PoseEvidence {
    Pose T_odom_imu;
    Matrix6 covariance = Matrix6::Zero();
    std::optional<double> standing_sigma_m_s;  ///< 1 sigma of zero velocity; empty = may be moving
};

struct InertialSolution {
    bool found = false;  ///< if false, the other members are invalid
    InertialBelief belief;
    std::vector<std::uint8_t> inlier;  ///< one flag per match
    int inliers = 0;
    double residual_px = 0.0;  ///< rms residual of the inliers, per pixel component
};

/// Predicts the present state from the IMU alone: `before`, moved by `motion`.
[[nodiscard]] InertialBelief predict(const InertialModel& model,
                                     const InertialBelief& before,
                                     const ImuMotion& motion);

/// Estimates the states of the previous and the present frame from a belief about the previous
/// state, the IMU's motion and the observations of the present frame. Levenberg-Marquardt over both
/// states and gravity, robust for points as in `refine_pose`. Then marginalises the previous state
/// (Schur complement). Returns the belief about the present state.
///
/// Landmarks count as known up to their covariance, which acts as noise of this frame alone. See
/// `with_vision_counted_once` for the consequence for the next frame.
///
/// Residuals as in Forster et al. 2017, (45), with the direction of gravity as an extra unknown.
[[nodiscard]] InertialSolution fuse(const InertialModel& model,
                                    const InertialBelief& before,
                                    const ImuMotion& motion,
                                    const VisualEvidence& seen,
                                    const Pose& T_odom_camera_start);
/// Fuses a known pose instead of points. A standing camera reveals the gyroscope's bias.
[[nodiscard]] InertialSolution fuse(const InertialModel& model,
                                    const InertialBelief& before,
                                    const ImuMotion& motion,
                                    const PoseEvidence& known);

/// Returns the belief for the next frame. `visual_covariance` is the covariance of the IMU's pose
/// from vision alone. Neighbouring frames see the same landmarks with the same errors. A pose that
/// collects information from frame to frame would count these errors several times. The function
/// assumes the worst case: landmarks cause all of the visual error. It raises the pose covariance
/// to that of vision alone, as an independent shift of the map would. Information about velocity,
/// biases and gravity stays, because it comes from differences of poses.
[[nodiscard]] InertialBelief with_vision_counted_once(const InertialBelief& belief,
                                                      const Matrix6& visual_covariance);

/// The symmetric matrix with its negative eigenvalues set to zero.
[[nodiscard]] Matrix6 positive_part(const Matrix6& symmetric);

/// Covariance of T_a_c = T_a_b * T_b_c for a fixed T_b_c.
[[nodiscard]] Matrix6 carried_covariance(const Matrix6& covariance_ab, const Pose& T_b_c);

}  // namespace surefoot::odometry
