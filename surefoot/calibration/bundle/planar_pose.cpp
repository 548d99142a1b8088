// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/planar_pose.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <cmath>

namespace surefoot::calibration {
namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;

/// Points count as collinear if the shortest axis of their scatter is below this share of the
/// longest axis.
constexpr double kLine = 1e-3;

Eigen::Vector3d mean(std::span<const Eigen::Vector3d> points) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : points) sum += p;
    return sum / static_cast<double>(points.size());
}

/// Returns the map of board coordinates to mean 0 and mean square 2. This scaling keeps the system
/// well conditioned.
Eigen::Matrix3d normaliser(std::span<const Eigen::Vector3d> points) {
    const Eigen::Vector3d centre = mean(points);
    double square = 0.0;
    for (const Eigen::Vector3d& p : points) square += (p - centre).squaredNorm();
    const double scale = std::sqrt(2.0 * static_cast<double>(points.size()) / square);
    Eigen::Matrix3d N = Eigen::Vector3d(scale, scale, 1.0).asDiagonal();
    N(0, 2) = -scale * centre.x();
    N(1, 2) = -scale * centre.y();
    return N;
}

/// Returns H such that the rays are parallel to H (x, y, 1); H is known up to scale.
Eigen::Matrix3d homography(std::span<const Eigen::Vector3d> points,
                           std::span<const Eigen::Vector3d> rays) {
    const Eigen::Matrix3d N = normaliser(points);
    Matrix9 normal = Matrix9::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d m = N * Eigen::Vector3d(points[i].x(), points[i].y(), 1.0);
        const Eigen::Matrix3d S = skew(rays[i]);  // ray x (H m) = 0 is linear in H
        Eigen::Matrix<double, 3, 9> rows;
        rows << m.x() * S, m.y() * S, m.z() * S;
        normal += rows.transpose() * rows;
    }
    const Eigen::SelfAdjointEigenSolver<Matrix9> solver(normal);
    const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);
    return Eigen::Map<const Eigen::Matrix3d>(h.data()) * N;
}

}  // namespace

bool collinear(std::span<const Eigen::Vector3d> points_board_m) {
    if (points_board_m.size() < 3) return true;
    const Eigen::Vector3d centre = mean(points_board_m);
    Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
    for (const Eigen::Vector3d& p : points_board_m) {
        const Eigen::Vector2d d = (p - centre).head<2>();
        scatter += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(scatter);
    return !(solver.eigenvalues()[0] > kLine * kLine * solver.eigenvalues()[1]);
}

std::optional<Pose> planar_pose(std::span<const Eigen::Vector3d> points_board_m,
                                std::span<const Eigen::Vector3d> rays_camera) {
    if (points_board_m.size() < 4 || collinear(points_board_m)) return std::nullopt;
    Eigen::Matrix3d H = homography(points_board_m, rays_camera);
    double agreement = 0.0;
    for (std::size_t i = 0; i < points_board_m.size(); ++i) {
        agreement += rays_camera[i].dot(
            H * Eigen::Vector3d(points_board_m[i].x(), points_board_m[i].y(), 1.0));
    }
    if (agreement < 0.0) H = -H;  // the board must lie in the direction of the rays
    const double scale = 0.5 * (H.col(0).norm() + H.col(1).norm());
    Eigen::Matrix3d R;
    R << H.col(0) / scale, H.col(1) / scale, H.col(0).cross(H.col(1)) / (scale * scale);
    if (!R.allFinite()) return std::nullopt;
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
    R = svd.matrixU() * svd.matrixV().transpose();
    if (R.determinant() < 0.0) return std::nullopt;
    return Pose{Eigen::Quaterniond(R), H.col(2) / scale};
}

}  // namespace surefoot::calibration
