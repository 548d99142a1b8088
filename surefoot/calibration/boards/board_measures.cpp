// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/boards/board_measures.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <span>
#include <vector>

#include "surefoot/calibration/bundle/planar_pose.hpp"
#include "surefoot/calibration/lenses/rectified_errors.hpp"
#include "surefoot/camera/rectifier.hpp"

namespace surefoot::calibration {
namespace {

constexpr std::size_t kLeastPoints = 8;
constexpr int kPoseSteps = 10;
/// Step of the pose in m and rad, for central differences.
constexpr double kPoseStep = 1e-6;

struct Mean {
    double mean = 0.0;
    double std = 0.0;
};

Mean mean_of(const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    Mean result;
    for (const double value : values) result.mean += value / count;
    double square = 0.0;
    for (const double value : values) square += (value - result.mean) * (value - result.mean);
    result.std = std::sqrt(square / count);
    return result;
}

/// Points that both cameras see: their positions on the board, in the left image, and in the
/// rectified left frame.
struct Triangulated {
    std::vector<int> ids;
    std::vector<Eigen::Vector3d> board_m;
    std::vector<Eigen::Vector2d> left_pixels;
    std::vector<Eigen::Vector3d> rectified_m;
};

Triangulated triangulate(const Board& board,
                         const BoardView& left,
                         const BoardView& right,
                         const camera::Rectification& plan) {
    const std::vector<Eigen::Vector3d> points = board.points_m();
    Triangulated result;
    const auto add = [&](int id, const Eigen::Vector2d& left_px, const Eigen::Vector2d& right_px) {
        const auto l = rectified_direction(plan.left, left_px);
        const auto r = rectified_direction(*plan.right, right_px);
        if (!l || !r || !(l->x() > r->x())) return;
        const double z_m = plan.rig.baseline_m / (l->x() - r->x());
        result.ids.push_back(id);
        result.board_m.push_back(points[static_cast<std::size_t>(id)]);
        result.left_pixels.push_back(left_px);
        result.rectified_m.emplace_back(z_m * l->x(), z_m * l->y(), z_m);
    };
    for_each_common_point(left, right, add);
    return result;
}

/// Returns the reprojection errors of the points in the left image, two values per point [px].
/// Returns nullopt if a point has no image.
std::optional<Eigen::VectorXd> errors_px(const Triangulated& seen,
                                         const camera::Camera& camera,
                                         const Pose& T_camera_board) {
    Eigen::VectorXd errors(2 * std::ssize(seen.board_m));
    for (std::size_t i = 0; i < seen.board_m.size(); ++i) {
        const auto pixel = camera::project(camera.model, T_camera_board * seen.board_m[i]);
        if (!pixel) return std::nullopt;
        errors.segment<2>(static_cast<Eigen::Index>(2 * i)) = seen.left_pixels[i] - *pixel;
    }
    return errors;
}

/// Computes the pose of the board from its size alone: least squares in the left image with the
/// Gauss-Newton method.
std::optional<Pose> pose_by_size(const Triangulated& seen, const camera::Camera& camera) {
    std::vector<Eigen::Vector3d> rays;
    rays.reserve(seen.left_pixels.size());
    for (const Eigen::Vector2d& pixel : seen.left_pixels) {
        const auto ray = camera::unproject(camera.model, pixel);
        if (!ray) return std::nullopt;
        rays.push_back(*ray);
    }
    std::optional<Pose> pose = planar_pose(seen.board_m, rays);
    for (int step = 0; pose && step < kPoseSteps; ++step) {
        const auto here = errors_px(seen, camera, *pose);
        if (!here) return std::nullopt;
        Eigen::MatrixXd J(here->size(), 6);
        for (int i = 0; i < 6; ++i) {
            const Vector6 little = kPoseStep * Vector6::Unit(i);
            const auto on = errors_px(seen, camera, perturbed(*pose, little));
            const auto back = errors_px(seen, camera, perturbed(*pose, -little));
            if (!on || !back) return std::nullopt;
            J.col(i) = (*back - *on) / (2.0 * kPoseStep);
        }
        const Vector6 change = (J.transpose() * J).ldlt().solve(J.transpose() * *here);
        pose = perturbed(*pose, change);
    }
    return pose;
}

/// Returns the depths relative to the plane through all points [m]. The plane is fitted in 1/z,
/// because 1/z is linear along a plane, and the noise of a disparity gives equal errors of 1/z
/// everywhere.
std::vector<double> beside_plane_m(std::span<const Eigen::Vector3d> points_m) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p_m : points_m) {
        const Eigen::Vector3d direction = p_m / p_m.z();
        normal += direction * direction.transpose();
        right += direction / p_m.z();
    }
    const Eigen::Vector3d inverse_depth_1_m = normal.ldlt().solve(right);
    std::vector<double> off_m;
    off_m.reserve(points_m.size());
    for (const Eigen::Vector3d& p_m : points_m)
        off_m.push_back(p_m.z() - p_m.z() / inverse_depth_1_m.dot(p_m));
    return off_m;
}

/// Returns triangulated minus true distance [m] from every point to the next point of its row and
/// of its column.
std::vector<double> length_errors_m(const Board& board, const Triangulated& seen) {
    std::vector<double> errors_m;
    errors_m.reserve(2 * seen.ids.size());
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
        for (std::size_t k = i + 1; k < seen.ids.size(); ++k) {
            const int ahead = seen.ids[k] - seen.ids[i];
            const bool in_row = ahead == 1 && seen.ids[k] % board.columns != 0;
            if (!in_row && ahead != board.columns) continue;
            errors_m.push_back((seen.rectified_m[k] - seen.rectified_m[i]).norm() -
                               (seen.board_m[k] - seen.board_m[i]).norm());
        }
    }
    return errors_m;
}

}  // namespace

std::optional<BoardMeasures> measure_board(const Board& board,
                                           const BoardView& left,
                                           const BoardView& right,
                                           const camera::StereoRig& rig) {
    if (!rig.right || left.disc_radius_m > 0.0 || right.disc_radius_m > 0.0) return std::nullopt;
    const camera::Rectification plan = camera::plan_rectification(
        rig, camera::RectificationConfig{}, camera::Rectifier::kVirtualBaseline_m);
    const Triangulated seen = triangulate(board, left, right, plan);
    if (seen.ids.size() < kLeastPoints || collinear(seen.board_m)) return std::nullopt;
    const std::optional<Pose> T_left_board = pose_by_size(seen, rig.left);
    if (!T_left_board) return std::nullopt;
    std::vector<double> by_size_m;
    std::vector<double> axial_m;
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
        const Eigen::Vector3d p_left = *T_left_board * seen.board_m[i];
        by_size_m.push_back((plan.left.R_rectified_raw * p_left).z());
        axial_m.push_back(seen.rectified_m[i].z() - by_size_m.back());
    }
    const std::vector<double> lengths_m = length_errors_m(board, seen);
    const Mean lateral = mean_of(lengths_m);
    return BoardMeasures{static_cast<int>(seen.ids.size()),
                         static_cast<int>(lengths_m.size()),
                         mean_of(by_size_m).mean,
                         mean_of(axial_m).mean,
                         mean_of(beside_plane_m(seen.rectified_m)).std,
                         lateral.mean,
                         lateral.std};
}

}  // namespace surefoot::calibration
