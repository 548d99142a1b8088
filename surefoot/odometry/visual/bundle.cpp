// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/bundle.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace surefoot::odometry {
namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;

constexpr double kMinDepth_m = 0.02;

double robust(double norm_sigmas, double limit_sigmas) {
    return norm_sigmas <= limit_sigmas ? norm_sigmas * norm_sigmas
                                       : limit_sigmas * (2.0 * norm_sigmas - limit_sigmas);
}

/// Residual in sigmas (measured - predicted). Infinite if the point is behind the camera or nearer
/// than kMinDepth_m. The component of u_right is 0 if u_right is unknown.
Eigen::Vector3d residual_of(const camera::RectifiedRig& rig,
                            const BundleSight& sight,
                            const Eigen::Vector3d& p_camera,
                            double sigma_px,
                            Eigen::Matrix3d* d_pixel_d_point = nullptr) {
    if (p_camera.z() < kMinDepth_m)
        return Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d residual = sight.pixel_px - project_stereo(rig, p_camera, d_pixel_d_point);
    if (!std::isfinite(sight.pixel_px.z())) {
        residual.z() = 0.0;
        if (d_pixel_d_point != nullptr) d_pixel_d_point->row(2).setZero();
    }
    return residual / (sigma_px * sight.noise_factor);
}

/// The normal equations in blocks, with their solution.
class Solver {
  public:
    Solver(const camera::RectifiedRig& rig, const BundleConfig& config, BundleProblem& problem)
        : rig_(rig), config_(config), problem_(problem), column_(problem.fixed.size(), -1) {
        int free = 0;
        for (std::size_t i = 0; i < problem.fixed.size(); ++i)
            if (problem.fixed[i] == 0) column_[i] = 6 * free++;
        size_ = 6 * free;
        cross_.resize(problem.sights.size());
        H_point_.resize(problem.p_world_m.size());
        b_point_.resize(problem.p_world_m.size());
    }

    BundleResult run() {
        BundleResult result;
        double cost = cost_of(problem_.T_world_camera, problem_.p_world_m);
        result.cost_before = cost;
        double damping = 1e-4;
        bool stale = true;
        for (int i = 0; i < config_.iterations && size_ > 0; ++i) {
            if (stale) linearise();
            if (!step(damping)) break;
            const double next = cost_of(trial_poses_, trial_points_);
            stale = next < cost;
            if (stale) {
                const bool converged = cost - next < 1e-4 * cost;
                problem_.T_world_camera = trial_poses_;
                problem_.p_world_m = trial_points_;
                cost = next;
                damping = std::max(damping * 0.1, 1e-8);
                result.steps += 1;
                if (converged) break;
            } else {
                damping *= 20.0;
            }
        }
        linearise();
        result.cost_after = cost;
        result.information = H_point_;
        result.residual_sigmas = residuals();
        return result;
    }

  private:
    [[nodiscard]] Eigen::Vector3d in_camera(const Pose& T, const Eigen::Vector3d& p) const {
        return T.rotation.conjugate() * (p - T.translation_m);
    }

    [[nodiscard]] double cost_of(const std::vector<Pose>& poses,
                                 const std::vector<Eigen::Vector3d>& points) const {
        double cost = 0.0;
        for (const BundleSight& sight : problem_.sights) {
            const auto p = in_camera(poses[static_cast<std::size_t>(sight.pose)],
                                     points[static_cast<std::size_t>(sight.point)]);
            cost +=
                robust(residual_of(rig_, sight, p, config_.sigma_px).norm(), config_.huber_sigmas);
        }
        return cost;
    }

    [[nodiscard]] std::vector<double> residuals() const {
        std::vector<double> norms;
        norms.reserve(problem_.sights.size());
        for (const BundleSight& sight : problem_.sights) {
            const auto p = in_camera(problem_.T_world_camera[static_cast<std::size_t>(sight.pose)],
                                     problem_.p_world_m[static_cast<std::size_t>(sight.point)]);
            norms.push_back(residual_of(rig_, sight, p, config_.sigma_px).norm());
        }
        return norms;
    }

    void linearise() {
        H_pose_.setZero(size_, size_);
        b_pose_.setZero(size_);
        for (auto& H : H_point_) H.setZero();
        for (auto& b : b_point_) b.setZero();
        for (std::size_t i = 0; i < problem_.sights.size(); ++i) add_sight(i);
    }

    void add_sight(std::size_t index) {
        const BundleSight& sight = problem_.sights[index];
        const Pose& T = problem_.T_world_camera[static_cast<std::size_t>(sight.pose)];
        const auto point = static_cast<std::size_t>(sight.point);
        const Eigen::Vector3d p_camera = in_camera(T, problem_.p_world_m[point]);
        Eigen::Matrix3d d_camera;
        const Eigen::Vector3d r = residual_of(rig_, sight, p_camera, config_.sigma_px, &d_camera);
        cross_[index].setZero();
        if (!r.allFinite()) return;
        const double norm = r.norm();
        const double weight = norm <= config_.huber_sigmas ? 1.0 : config_.huber_sigmas / norm;
        d_camera /= config_.sigma_px * sight.noise_factor;
        const Eigen::Matrix3d J_point = d_camera * T.R().transpose();
        H_point_[point].noalias() += weight * J_point.transpose() * J_point;
        b_point_[point].noalias() += weight * J_point.transpose() * r;
        const int column = column_[static_cast<std::size_t>(sight.pose)];
        if (column < 0) return;
        Eigen::Matrix<double, 3, 6> J_pose;  // p(T perturbed) = p - dp + p x theta
        J_pose.leftCols<3>() = -d_camera;
        J_pose.rightCols<3>() = d_camera * skew(p_camera);
        H_pose_.block<6, 6>(column, column).noalias() += weight * J_pose.transpose() * J_pose;
        b_pose_.segment<6>(column).noalias() += weight * J_pose.transpose() * r;
        cross_[index].noalias() = weight * J_pose.transpose() * J_point;
    }

    /// Solves one damped step and writes the trial state; returns false on failure.
    bool step(double damping) {
        reduced_ = H_pose_;
        reduced_.diagonal() *= 1.0 + damping;
        rhs_ = b_pose_;
        inverse_.resize(H_point_.size());
        for (std::size_t i = 0; i < H_point_.size(); ++i) {
            Eigen::Matrix3d H = H_point_[i];
            H.diagonal() *= 1.0 + damping;
            H.diagonal().array() += 1e-9;  // a point observed once without disparity stays in place
            inverse_[i] = H.inverse();
        }
        eliminate_points();
        const Eigen::VectorXd delta = reduced_.selfadjointView<Eigen::Lower>().ldlt().solve(rhs_);
        if (!delta.allFinite()) return false;
        move(delta);
        return true;
    }

    /// reduced = H_pose - sum over points of cross H_point^-1 cross^T (lower triangle).
    void eliminate_points() {
        const auto& sights = problem_.sights;
        for (std::size_t begin = 0; begin < sights.size();) {
            std::size_t end = begin;
            while (end < sights.size() && sights[end].point == sights[begin].point) ++end;
            const auto point = static_cast<std::size_t>(sights[begin].point);
            for (std::size_t i = begin; i < end; ++i) {
                const int row = column_[static_cast<std::size_t>(sights[i].pose)];
                if (row < 0) continue;
                const Matrix63 scaled = cross_[i] * inverse_[point];
                rhs_.segment<6>(row).noalias() -= scaled * b_point_[point];
                for (std::size_t j = begin; j < end; ++j) {
                    const int column = column_[static_cast<std::size_t>(sights[j].pose)];
                    if (column < 0 || column > row) continue;
                    reduced_.block<6, 6>(row, column).noalias() -= scaled * cross_[j].transpose();
                }
            }
            begin = end;
        }
    }

    void move(const Eigen::VectorXd& delta) {
        trial_poses_ = problem_.T_world_camera;
        for (std::size_t i = 0; i < trial_poses_.size(); ++i)
            if (column_[i] >= 0)
                trial_poses_[i] = perturbed(trial_poses_[i], Vector6(delta.segment<6>(column_[i])));
        rhs_points_ = b_point_;
        for (std::size_t i = 0; i < problem_.sights.size(); ++i) {
            const BundleSight& sight = problem_.sights[i];
            const int column = column_[static_cast<std::size_t>(sight.pose)];
            if (column >= 0)
                rhs_points_[static_cast<std::size_t>(sight.point)].noalias() -=
                    cross_[i].transpose() * delta.segment<6>(column);
        }
        trial_points_ = problem_.p_world_m;
        for (std::size_t i = 0; i < trial_points_.size(); ++i)
            trial_points_[i] += inverse_[i] * rhs_points_[i];
    }

    const camera::RectifiedRig& rig_;
    const BundleConfig& config_;
    BundleProblem& problem_;
    std::vector<int> column_;  ///< first row of a pose in the reduced system, -1 = fixed
    int size_ = 0;
    Eigen::MatrixXd H_pose_, reduced_;
    Eigen::VectorXd b_pose_, rhs_;
    std::vector<Eigen::Matrix3d> H_point_, inverse_;
    std::vector<Eigen::Vector3d> b_point_, rhs_points_;
    std::vector<Matrix63> cross_;
    std::vector<Pose> trial_poses_;
    std::vector<Eigen::Vector3d> trial_points_;
};

}  // namespace

void BundleProblem::clear() {
    T_world_camera.clear();
    fixed.clear();
    p_world_m.clear();
    sights.clear();
}

BundleResult adjust_bundle(const camera::RectifiedRig& rig,
                           const BundleConfig& config,
                           BundleProblem& problem) {
    return Solver(rig, config, problem).run();
}

}  // namespace surefoot::odometry
