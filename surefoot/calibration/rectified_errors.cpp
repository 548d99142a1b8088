// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/rectified_errors.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <optional>

#include "surefoot/camera/rectifier.hpp"

namespace surefoot::calibration {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
/// Central differences over this share of a standard deviation: depth is straight that far.
constexpr double kStep = 0.1;

/// Direction of a raw pixel on the plane z = 1 of the rectified frame.
std::optional<Eigen::Vector2d> rectified(const camera::RectifiedEye& eye,
                                         const Eigen::Vector2d& raw) {
    const auto ray = camera::unproject(eye.camera.model, raw);
    if (!ray) return std::nullopt;
    const Eigen::Vector3d p = eye.R_rectified_raw * *ray;
    if (!(p.z() > 0.0)) return std::nullopt;
    return Eigen::Vector2d(p.x() / p.z(), p.y() / p.z());
}

std::optional<Eigen::Vector2d> seen(const camera::RectifiedEye& eye,
                                    const Eigen::Vector3d& p_rectified) {
    const auto raw =
        camera::raw_from_ray(eye, p_rectified - eye.offset_x_m * Eigen::Vector3d::UnitX());
    if (!raw || raw->x() < -0.5 || raw->y() < -0.5 || raw->x() > eye.camera.width - 0.5 ||
        raw->y() > eye.camera.height - 0.5) {
        return std::nullopt;
    }
    return raw;
}

camera::Rectification plan_of(const camera::StereoRig& rig) {
    return camera::plan_rectification(
        rig, camera::Rectifier::kMaxFieldOfView_deg, camera::Rectifier::kVirtualBaseline_m);
}

StereoParameters moved(const StereoParameters& from, const Eigen::VectorXd& delta) {
    const Eigen::Index lens = from.left.size();
    StereoParameters to = from;
    to.left += delta.head(lens);
    to.right += delta.segment(lens, lens);
    to.T_left_right = perturbed(from.T_left_right, Vector6(delta.tail<6>()));
    return to;
}

/// Depth that a calibration makes of two raw pixels.
double depth_m(const StereoParameters& parameters,
               const Eigen::Vector2d& left,
               const Eigen::Vector2d& right) {
    const camera::StereoRig rig = rig_of(parameters);
    if (rig.problem()) return kNan;
    const camera::Rectification plan = plan_of(rig);
    const auto l = rectified(plan.left, left);
    const auto r = rectified(*plan.right, right);
    return l && r ? plan.rig.baseline_m / (l->x() - r->x()) : kNan;
}

}  // namespace

double row_rms_px(const camera::Rectification& plan,
                  std::span<const std::pair<BoardView, BoardView>> pairs) {
    double square = 0.0;
    double count = 0.0;
    for (const auto& [left, right] : pairs) {
        for (std::size_t i = 0, k = 0; i < left.ids.size() && k < right.ids.size();) {
            if (left.ids[i] != right.ids[k]) {
                ++(left.ids[i] < right.ids[k] ? i : k);
                continue;
            }
            const auto l = rectified(plan.left, left.pixels[i++]);
            const auto r = rectified(*plan.right, right.pixels[k++]);
            if (!l || !r) continue;
            const double row_px = plan.rig.fy_px * (l->y() - r->y());
            square += row_px * row_px;
            count += 1.0;
        }
    }
    return std::sqrt(square / count);
}

camera::StereoRig rig_of(const StereoParameters& parameters) {
    const auto eye = [&](const Eigen::VectorXd& lens) {
        return camera::Camera{
            model_of(parameters.kind, lens), parameters.size.width, parameters.size.height};
    };
    camera::StereoRig rig;
    rig.left = eye(parameters.left);
    rig.right = eye(parameters.right);
    rig.T_left_right = parameters.T_left_right;
    return rig;
}

double depth_sigma_m(const StereoParameters& parameters,
                     const Eigen::MatrixXd& covariance,
                     double distance_m) {
    const camera::Rectification plan = plan_of(rig_of(parameters));
    const Eigen::Vector3d p_rectified(0.0, 0.0, distance_m);
    const auto left = seen(plan.left, p_rectified);
    const auto right = seen(*plan.right, p_rectified);
    if (!left || !right) return kNan;
    // Independent directions of error, each one standard deviation long.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
    double variance = 0.0;
    for (Eigen::Index i = 0; i < covariance.cols(); ++i) {
        const double sigma = std::sqrt(std::max(0.0, solver.eigenvalues()[i]));
        const Eigen::VectorXd step = kStep * sigma * solver.eigenvectors().col(i);
        const double slope = (depth_m(moved(parameters, step), *left, *right) -
                              depth_m(moved(parameters, -step), *left, *right)) /
                             (2.0 * kStep);
        variance += slope * slope;
    }
    return std::sqrt(variance);
}

}  // namespace surefoot::calibration
