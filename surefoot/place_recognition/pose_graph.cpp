// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/pose_graph.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "surefoot/core/assert.hpp"

namespace surefoot::place_recognition {
namespace {

constexpr int kIterations = 20;
constexpr double kConverged = 1e-7;  ///< largest step of a converged graph [m, rad]
constexpr double kCauchy2 = 16.0;  ///< chi^2 at which a recognition has half weight; the mean is 6
/// Smallest sigma [m, rad], because even the motion of a standing machine is uncertain.
constexpr double kLeastSigma = 1e-5;

Matrix6 information_of(const Matrix6& covariance) {
    Matrix6 known = covariance;
    known.diagonal().array() += kLeastSigma * kLeastSigma;
    return known.ldlt().solve(Matrix6::Identity());
}

/// Returns the inverse of the right Jacobian of SO(3) to first order. The first order is enough,
/// because rotation errors are at most a few degrees.
Eigen::Matrix3d inverse_right_jacobian(const Eigen::Vector3d& theta_rad) {
    return Eigen::Matrix3d::Identity() + 0.5 * skew(theta_rad);
}

/// Derivatives of error = difference(T_from_to, X_from^-1 X_to) with respect to both poses.
struct Jacobians {
    Matrix6 from = Matrix6::Zero();
    Matrix6 to = Matrix6::Zero();
};

Jacobians jacobians_of(const Pose& T_from_to, const Pose& T_now) {
    const Eigen::Matrix3d R_back = T_from_to.R().transpose();
    const Eigen::Matrix3d R_now = T_now.R();
    const Eigen::Vector3d theta = log_so3(T_from_to.rotation.conjugate() * T_now.rotation);
    const Eigen::Matrix3d J = inverse_right_jacobian(theta);
    Jacobians out;
    out.to.topLeftCorner<3, 3>() = R_back * R_now;
    out.to.bottomRightCorner<3, 3>() = J;
    out.from.topLeftCorner<3, 3>() = -R_back;
    out.from.topRightCorner<3, 3>() = R_back * skew(T_now.translation_m);
    out.from.bottomRightCorner<3, 3>() = -J * R_now.transpose();
    return out;
}

/// Adds a 6 x 6 block to the lower half of a symmetric matrix.
void add_block(std::vector<Eigen::Triplet<double>>& H, int row, int column, const Matrix6& block) {
    if (row < column) return;
    for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 6; ++k)
            if (row != column || i >= k) H.emplace_back(6 * row + i, 6 * column + k, block(i, k));
}

}  // namespace

int PoseGraph::add_first(const Pose& T_map_body) {
    SUREFOOT_ASSERT(poses_.empty());
    poses_.push_back(T_map_body);
    return 0;
}

int PoseGraph::add_next(const Pose& T_previous_body, const Matrix6& covariance) {
    SUREFOOT_ASSERT(!poses_.empty());
    const int node = nodes();
    motions_.push_back({node - 1, node, T_previous_body, information_of(covariance), false});
    poses_.push_back(poses_.back() * T_previous_body);
    return node;
}

int PoseGraph::recognise_fixed(int node, const Pose& T_map_body, const Matrix6& covariance) {
    return recognise(-1, node, T_map_body, covariance);
}

int PoseGraph::recognise(int from, int to, const Pose& T_from_to, const Matrix6& covariance) {
    SUREFOOT_ASSERT(from < nodes() && to >= 0 && to < nodes());
    recognitions_.push_back({from, to, T_from_to, information_of(covariance), true});
    return static_cast<int>(recognitions_.size()) - 1;
}

void PoseGraph::forget_from(int recognition) {
    recognitions_.resize(
        std::min(recognitions_.size(), static_cast<std::size_t>(std::max(recognition, 0))));
}

void PoseGraph::place(int node, const Pose& T_map_body) {
    const Pose T_new_old = T_map_body * this->T_map_body(node).inverse();
    for (Pose& pose : poses_) {
        pose = T_new_old * pose;
        pose.rotation.normalize();
    }
}

Vector6 PoseGraph::error(const Edge& edge) const {
    const Pose& to = T_map_body(edge.to);
    return difference(edge.T_from_to, edge.from < 0 ? to : T_map_body(edge.from).inverse() * to);
}

double PoseGraph::chi2(int recognition) const {
    const Edge& edge = recognitions_[static_cast<std::size_t>(recognition)];
    const Vector6 e = error(edge);
    return e.dot(edge.information * e);
}

double PoseGraph::cost() const {
    double sum = 0.0;
    for (const Edge& edge : motions_) {
        const Vector6 e = error(edge);
        sum += e.dot(edge.information * e);
    }
    for (std::size_t i = 0; i < recognitions_.size(); ++i)
        sum += kCauchy2 * std::log1p(chi2(static_cast<int>(i)) / kCauchy2);
    return sum;
}

bool PoseGraph::step(double& largest) {
    const int held = first_held_ ? 1 : 0;
    const int unknowns = 6 * (nodes() - held);
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(84 * (motions_.size() + recognitions_.size()));
    Eigen::VectorXd b = Eigen::VectorXd::Zero(unknowns);
    const auto add = [&](const Edge& edge) {
        const Vector6 e = error(edge);
        const double weight =
            edge.robust ? 1.0 / (1.0 + e.dot(edge.information * e) / kCauchy2) : 1.0;
        const Matrix6 W = weight * edge.information;
        const Pose& to = T_map_body(edge.to);
        const Jacobians J =
            jacobians_of(edge.T_from_to, edge.from < 0 ? to : T_map_body(edge.from).inverse() * to);
        const int i = edge.from - held;
        const int k = edge.to - held;
        if (k >= 0) {
            add_block(entries, k, k, J.to.transpose() * W * J.to);
            b.segment<6>(6 * k) -= J.to.transpose() * W * e;
        }
        if (i < 0 || edge.from < 0) return;
        add_block(entries, i, i, J.from.transpose() * W * J.from);
        b.segment<6>(6 * i) -= J.from.transpose() * W * e;
        if (k < 0) return;
        add_block(entries, k, i, J.to.transpose() * W * J.from);
        add_block(entries, i, k, J.from.transpose() * W * J.to);
    };
    for (const Edge& edge : motions_) add(edge);
    for (const Edge& edge : recognitions_) add(edge);
    Eigen::SparseMatrix<double> H(unknowns, unknowns);
    H.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver(H);
    if (solver.info() != Eigen::Success) return false;
    const Eigen::VectorXd delta = solver.solve(b);
    if (!delta.allFinite()) return false;
    for (int i = held; i < nodes(); ++i) {
        Pose& pose = poses_[static_cast<std::size_t>(i)];
        pose = perturbed(pose, delta.segment<6>(6 * (i - held)));
        pose.rotation.normalize();
    }
    largest = delta.cwiseAbs().maxCoeff();
    return true;
}

bool PoseGraph::solve() {
    const bool fixed = first_held_ || std::any_of(recognitions_.begin(),
                                                  recognitions_.end(),
                                                  [](const Edge& e) { return e.from < 0; });
    if (!fixed || poses_.empty()) return false;
    if (nodes() == 1 && first_held_) return true;
    const std::vector<Pose> before = poses_;
    const double cost_before = cost();
    double largest = 1.0;
    for (int i = 0; i < kIterations && largest > kConverged; ++i) {
        if (step(largest)) continue;
        poses_ = before;
        return false;
    }
    if (cost() <= cost_before * (1.0 + 1e-9) + 1e-9) return true;
    poses_ = before;  // diverged: keep the previous poses
    return false;
}

}  // namespace surefoot::place_recognition
