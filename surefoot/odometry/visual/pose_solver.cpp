// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/pose_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace surefoot::odometry {
namespace {

constexpr double kMinDepth_m = 0.02;
/// Lower limit of the weakest direction of the information relative to the strongest, after scaling
/// to unit diagonal. Below it the points lie on a line or in one spot.
constexpr double kMinConditioning = 1e-7;
/// From this many points with a full vote on, they alone determine the pose in the first rounds.
constexpr int kMinTrusted = 20;
/// Medians of the norms of two and of three normal errors: square roots of the chi-square medians.
constexpr double kMedianOfTwo = 1.1774;
constexpr double kMedianOfThree = 1.5382;

/// Residual of one match with its Jacobian; `rows` is 2 without a disparity, 0 behind the camera.
struct Residual {
    int rows = 0;
    Eigen::Vector3d value = Eigen::Vector3d::Zero();  ///< measured - predicted [px]
    Eigen::Matrix<double, 3, 6> d_pose;               ///< d prediction / d pose perturbation
    Eigen::Matrix3d d_camera;                         ///< d prediction / d point in camera axes
};

Residual residual_of(const camera::RectifiedRig& rig, const PointMatch& match, const Pose& T) {
    Residual residual;
    const Eigen::Vector3d p_camera = T.rotation.conjugate() * (match.p_world_m - T.translation_m);
    if (p_camera.z() < kMinDepth_m) return residual;
    const StereoPixel predicted = project_stereo(rig, p_camera, &residual.d_camera);
    residual.rows = std::isfinite(match.pixel_px.z()) ? 3 : 2;
    residual.value.head(residual.rows) = (match.pixel_px - predicted).head(residual.rows);
    // p(T perturbed) = Exp(-theta) (p - dp) = p - dp + p x theta
    residual.d_pose.leftCols<3>() = -residual.d_camera;
    residual.d_pose.rightCols<3>() = residual.d_camera * skew(p_camera);
    return residual;
}

/// Inverse covariance of the residual: pixel noise plus the covariance of the point.
Eigen::Matrix3d weight_of(const Residual& residual,
                          const PointMatch& match,
                          const Eigen::Matrix3d& R_camera_world,
                          double config_sigma_px) {
    const Eigen::Matrix3d J = residual.d_camera * R_camera_world;
    Eigen::Matrix3d S = J * match.covariance_m2 * J.transpose();
    const double sigma_px = match.noise_factor * config_sigma_px;
    S.diagonal().array() += sigma_px * sigma_px;
    if (residual.rows == 3) return S.inverse();
    Eigen::Matrix3d W = Eigen::Matrix3d::Zero();
    W.topLeftCorner<2, 2>() = S.topLeftCorner<2, 2>().inverse();
    return W;
}

double huber_weight(double norm_sigmas, double limit_sigmas) {
    return norm_sigmas <= limit_sigmas ? 1.0 : limit_sigmas / norm_sigmas;
}

/// True if the information determines all six directions, whatever their units.
bool well_conditioned(const Matrix6& H) {
    const Vector6 diagonal = H.diagonal();
    if (!(diagonal.minCoeff() > 0.0)) return false;
    const Vector6 scale = diagonal.cwiseSqrt().cwiseInverse();
    const Matrix6 scaled = scale.asDiagonal() * H * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(scaled, Eigen::EigenvaluesOnly);
    return eigen.info() == Eigen::Success &&
           eigen.eigenvalues().minCoeff() > kMinConditioning * eigen.eigenvalues().maxCoeff();
}

/// Matches with a full vote; empty if there are too few.
std::vector<PointMatch> trusted_of(std::span<const PointMatch> matches) {
    std::vector<PointMatch> trusted;
    std::ranges::copy_if(
        matches, std::back_inserter(trusted), [](const PointMatch& m) { return m.vote >= 1.0; });
    if (std::ssize(trusted) < kMinTrusted) trusted.clear();
    return trusted;
}

/// Levenberg-Marquardt with a fixed gate; false when the points do not determine the pose.
bool iterate(const camera::RectifiedRig& rig,
             const PoseSolverConfig& config,
             std::span<const PointMatch> matches,
             double gate_sigmas,
             Pose& T,
             std::vector<std::uint8_t>& inlier) {
    inlier.assign(matches.size(), 0);
    std::vector<std::uint8_t> trial_inlier(matches.size());
    VisualNormalEquations normal =
        visual_normal_equations(rig, config, matches, T, gate_sigmas, inlier);
    double damping = 1e-6;
    for (int iteration = 0; iteration < config.iterations; ++iteration) {
        if (normal.inliers < kMinimalPoseMatches) return false;
        Matrix6 damped = normal.H;
        damped.diagonal() *= 1.0 + damping;
        const Vector6 step = damped.ldlt().solve(normal.b);
        if (!step.allFinite()) return false;
        const Pose trial = perturbed(T, step);
        const VisualNormalEquations next =
            visual_normal_equations(rig, config, matches, trial, gate_sigmas, trial_inlier);
        if (next.cost <= normal.cost) {
            const bool converged = normal.cost - next.cost <= 1e-9 * normal.cost;
            T = trial;
            normal = next;
            inlier.swap(trial_inlier);
            damping *= 0.1;
            if (converged) break;
        } else {
            damping = std::max(damping, 1e-6) * 20.0;
            if (damping > 1e4) break;
        }
    }
    return normal.inliers >= kMinimalPoseMatches;
}

}  // namespace

VisualNormalEquations visual_normal_equations(const camera::RectifiedRig& rig,
                                              const PoseSolverConfig& config,
                                              std::span<const PointMatch> matches,
                                              const Pose& T,
                                              double gate_sigmas,
                                              std::span<std::uint8_t> inlier) {
    VisualNormalEquations normal;
    const Eigen::Matrix3d R_camera_world = T.R().transpose();
    for (std::size_t i = 0; i < matches.size(); ++i) {
        inlier[i] = 0;
        const Residual residual = residual_of(rig, matches[i], T);
        if (residual.rows == 0) continue;
        const Eigen::Matrix3d W = weight_of(residual, matches[i], R_camera_world, config.sigma_px);
        const double chi2 = residual.value.dot(W * residual.value);
        const double norm = std::sqrt(chi2);
        if (!(norm <= gate_sigmas)) {  // an outlier adds a constant cost
            normal.cost += config.huber_sigmas * (2.0 * gate_sigmas - config.huber_sigmas);
            continue;
        }
        const double weight = huber_weight(norm, config.huber_sigmas);
        const Eigen::Matrix<double, 3, 6> weighted_jacobian = weight * (W * residual.d_pose);
        normal.H.noalias() += residual.d_pose.transpose() * weighted_jacobian;
        normal.b.noalias() += weighted_jacobian.transpose() * residual.value;
        normal.cost +=
            weight < 1.0 ? config.huber_sigmas * (2.0 * norm - config.huber_sigmas) : chi2;
        normal.chi2 += chi2;
        normal.square_px += residual.value.head<2>().squaredNorm();
        normal.rows += residual.rows;
        normal.inliers += 1;
        inlier[i] = 1;
    }
    return normal;
}

PoseSolution refine_pose(const camera::RectifiedRig& rig,
                         const PoseSolverConfig& config,
                         std::span<const PointMatch> matches,
                         const Pose& T_world_camera_start) {
    PoseSolution solution;
    solution.inlier.assign(matches.size(), 0);
    Pose T = T_world_camera_start;
    // First a wide gate, because the start may be a few pixels off. Points of a person who walks in
    // may be equally far off, so only points that agreed with earlier poses take part, if at least
    // kMinTrusted of them exist.
    const std::vector<PointMatch> trusted = trusted_of(matches);
    if (!iterate(rig,
                 config,
                 trusted.empty() ? matches : std::span<const PointMatch>(trusted),
                 4.0 * config.gate_sigmas,
                 T,
                 solution.inlier))
        return solution;
    if (!iterate(rig, config, matches, config.gate_sigmas, T, solution.inlier)) return solution;
    const VisualNormalEquations normal =
        visual_normal_equations(rig, config, matches, T, config.gate_sigmas, solution.inlier);
    if (normal.inliers < kMinimalPoseMatches || !well_conditioned(normal.H)) return solution;
    solution.residual_scale = std::sqrt(normal.chi2 / std::max(normal.rows - 6, 1));
    const double scale = std::max(solution.residual_scale, kMinResidualScale);
    solution.covariance = scale * scale * normal.H.ldlt().solve(Matrix6::Identity());
    solution.covariance = 0.5 * (solution.covariance + solution.covariance.transpose()).eval();
    solution.T_world_camera = T;
    solution.inliers = normal.inliers;
    solution.residual_px = std::sqrt(normal.square_px / (2.0 * normal.inliers));
    solution.found = T.all_finite() && solution.covariance.allFinite();
    return solution;
}

std::optional<double> residual_scale_of_all(const camera::RectifiedRig& rig,
                                            const PoseSolverConfig& config,
                                            std::span<const PointMatch> matches,
                                            const Pose& T_world_camera) {
    const std::vector<PointMatch> trusted = trusted_of(matches);
    const Eigen::Matrix3d R_camera_world = T_world_camera.R().transpose();
    std::vector<double> ratios;
    for (const PointMatch& match : trusted.empty() ? matches : std::span(trusted)) {
        const Residual residual = residual_of(rig, match, T_world_camera);
        if (residual.rows == 0 || !(residual.value.head<2>().norm() <= config.ransac_threshold_px))
            continue;
        const Eigen::Matrix3d W = weight_of(residual, match, R_camera_world, config.sigma_px);
        ratios.push_back(std::sqrt(residual.value.dot(W * residual.value)) /
                         (residual.rows == 3 ? kMedianOfThree : kMedianOfTwo));
    }
    if (std::ssize(ratios) < kMinTrusted) return std::nullopt;
    const auto middle = ratios.begin() + std::ssize(ratios) / 2;
    std::nth_element(ratios.begin(), middle, ratios.end());
    return *middle;
}

Matrix6 adjoint(const Pose& T_a_b) {
    // A perturbation D of b is X D X^-1 of a with X = T_a_b:
    // theta_a = R theta_b, dp_a = R dp_b + [t]x R theta_b.
    Matrix6 J = Matrix6::Zero();
    const Eigen::Matrix3d R = T_a_b.R();
    J.topLeftCorner<3, 3>() = R;
    J.topRightCorner<3, 3>() = skew(T_a_b.translation_m) * R;
    J.bottomRightCorner<3, 3>() = R;
    return J;
}

Matrix6 camera_to_body_covariance(const Matrix6& covariance_camera, const Pose& T_body_camera) {
    const Matrix6 J = adjoint(T_body_camera);
    return J * covariance_camera * J.transpose();
}

}  // namespace surefoot::odometry
