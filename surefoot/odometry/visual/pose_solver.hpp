// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/odometry/visual/stereo_projection.hpp"

namespace surefoot::odometry {

/// A landmark with known position and its observation in the present frame.
struct PointMatch {
    Eigen::Vector3d p_world_m;
    Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();  ///< covariance of p_world_m, in world
    StereoPixel pixel_px;
    double noise_factor = 1.0;  ///< sigma of this measurement / configured sigma
    double vote = 1.0;          ///< weight of the point in the vote for a pose
};

struct PoseSolverConfig {
    double sigma_px = 0.3;  ///< sigma of each of (u_left, v, u_right)
    int ransac_rounds = 150;
    double ransac_threshold_px = 3.0;
    double gate_sigmas = 3.5;   ///< larger residuals are outliers of the refinement
    double huber_sigmas = 1.0;  ///< larger residuals count linearly, not squared
    int iterations = 12;
};

struct PoseSolution {
    bool found = false;  ///< if false, the other members are invalid
    Pose T_world_camera;
    Matrix6 covariance =
        Matrix6::Zero();               ///< covariance of T_world_camera, scaled by the residuals
    std::vector<std::uint8_t> inlier;  ///< one flag per match
    int inliers = 0;
    double residual_px = 0.0;     ///< rms residual of the inliers, per pixel component
    double residual_scale = 1.0;  ///< rms of the inliers' residuals in sigmas; 1 = as expected
};

/// Smallest number of points for a pose; at least one point is redundant.
inline constexpr int kMinimalPoseMatches = 5;

/// Finds the pose with the most votes of points within `ransac_threshold_px` of their (u_left, v).
/// Tries the predicted pose first, then three-point poses of random samples (P3P). The same seed
/// gives the same pose.
///
/// Fischler and Bolles 1981 (sample consensus); cv::solveP3P for the minimal problem.
[[nodiscard]] PoseSolution find_pose(const camera::RectifiedRig& rig,
                                     const PoseSolverConfig& config,
                                     std::span<const PointMatch> matches,
                                     const Pose& T_world_camera_predicted,
                                     Rng rng);

/// Refines a good start pose by robust least squares over (u_left, v, u_right): Levenberg-Marquardt
/// with Huber weights and a gate. The first rounds use a wide gate and, if there are enough, only
/// matches with a full vote. Each residual is weighted by its pixel noise plus the projected
/// covariance of its point; points count as independent. The covariance is the inverse information,
/// scaled by the residuals (by no less than kMinResidualScale).
///
/// `found` is false if fewer than kMinimalPoseMatches points agree or a direction is unconstrained.
[[nodiscard]] PoseSolution refine_pose(const camera::RectifiedRig& rig,
                                       const PoseSolverConfig& config,
                                       std::span<const PointMatch> matches,
                                       const Pose& T_world_camera_start);

/// Ratio of actual to expected residuals of the matches at a pose: the median of the residuals in
/// sigmas, divided by the median of normal errors. The ratio is valid while fewer than half of the
/// matches are outliers. Residuals beyond `ransac_threshold_px` do not count. If enough matches
/// have a full vote (1), only these count. Returns nothing if too few matches remain.
[[nodiscard]] std::optional<double> residual_scale_of_all(const camera::RectifiedRig& rig,
                                                          const PoseSolverConfig& config,
                                                          std::span<const PointMatch> matches,
                                                          const Pose& T_world_camera);

/// Normal equations of all matches at one pose: H step = b for a perturbation of the camera pose.
struct VisualNormalEquations {
    Matrix6 H = Matrix6::Zero();
    Vector6 b = Vector6::Zero();
    double cost = 0.0;       ///< robust cost [sigma^2]
    double chi2 = 0.0;       ///< sum of squared residuals [sigma^2] inside the gate
    double square_px = 0.0;  ///< sum of squared pixel residuals inside the gate
    int rows = 0;
    int inliers = 0;
};

/// One step of `refine_pose`, for solvers with further evidence. `inlier` has one entry per match
/// and is overwritten.
[[nodiscard]] VisualNormalEquations visual_normal_equations(const camera::RectifiedRig& rig,
                                                            const PoseSolverConfig& config,
                                                            std::span<const PointMatch> matches,
                                                            const Pose& T_world_camera,
                                                            double gate_sigmas,
                                                            std::span<std::uint8_t> inlier);

/// Lower limit of the factor by which small residuals shrink the sigmas of the covariance.
inline constexpr double kMinResidualScale = 0.5;

/// Maps a perturbation of T_x_b to one of T_x_a = T_x_b * T_b_a, given T_a_b (both on the right).
[[nodiscard]] Matrix6 adjoint(const Pose& T_a_b);

/// Covariance of T_a_body = T_a_camera * T_body_camera^-1 from that of T_a_camera.
[[nodiscard]] Matrix6 camera_to_body_covariance(const Matrix6& covariance_camera,
                                                const Pose& T_body_camera);

}  // namespace surefoot::odometry
