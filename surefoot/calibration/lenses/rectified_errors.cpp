// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/lenses/rectified_errors.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::calibration {
namespace {

/// Step of central differences, as a share of a standard deviation: up to this step, depth is
/// linear.
constexpr double kStep = 0.1;

std::optional<Eigen::Vector2d> seen(const camera::RectifiedCamera& camera,
                                    const Eigen::Vector3d& p_rectified) {
    auto raw =
        camera::raw_from_ray(camera, p_rectified - camera.offset_x_m * Eigen::Vector3d::UnitX());
    if (!raw || raw->x() < -0.5 || raw->y() < -0.5 || raw->x() > camera.camera.width - 0.5 ||
        raw->y() > camera.camera.height - 0.5) {
        return std::nullopt;
    }
    return raw;
}

/// Uses a small image: the rotations of the cameras do not depend on the size, and planning is
/// fast.
camera::Rectification plan_of(const camera::StereoRig& rig) {
    camera::RectificationConfig config;
    config.max_view_deg = 20.0;
    return camera::plan_rectification(rig, config, camera::Rectifier::kVirtualBaseline_m);
}

/// The raw pixels of one point in both images.
struct PixelPair {
    Eigen::Vector2d left;
    Eigen::Vector2d right;
};

StereoParameters moved(const StereoParameters& from, const Eigen::VectorXd& delta) {
    const Eigen::Index lens = from.left.size();
    StereoParameters to = from;
    to.left += delta.head(lens);
    to.right += delta.segment(lens, lens);
    to.T_left_right = perturbed(from.T_left_right, Vector6(delta.tail<6>()));
    return to;
}

/// Returns the depths of pairs of raw pixels [m], for a given calibration.
Eigen::VectorXd depths_m(const StereoParameters& parameters, std::span<const PixelPair> pixels) {
    Eigen::VectorXd depths = Eigen::VectorXd::Constant(std::ssize(pixels), kNan);
    const camera::StereoRig rig = rig_of(parameters);
    if (rig.problem()) return depths;
    const camera::Rectification plan = plan_of(rig);
    for (Eigen::Index i = 0; i < depths.size(); ++i) {
        const auto left = rectified_direction(plan.left, pixels[static_cast<std::size_t>(i)].left);
        const auto right =
            rectified_direction(*plan.right, pixels[static_cast<std::size_t>(i)].right);
        if (left && right) depths[i] = plan.rig.baseline_m / (left->x() - right->x());
    }
    return depths;
}

}  // namespace

std::optional<Eigen::Vector2d> rectified_direction(const camera::RectifiedCamera& camera,
                                                   const Eigen::Vector2d& raw) {
    const auto ray = camera::unproject(camera.camera.model, raw);
    if (!ray) return std::nullopt;
    const Eigen::Vector3d p = camera.R_rectified_raw * *ray;
    if (!(p.z() > 0.0)) return std::nullopt;
    return Eigen::Vector2d(p.x() / p.z(), p.y() / p.z());
}

double row_rms_px(const camera::Rectification& plan,
                  std::span<const std::pair<BoardView, BoardView>> pairs,
                  double focal_px) {
    double square = 0.0;
    double count = 0.0;
    const auto add = [&](int, const Eigen::Vector2d& left_px, const Eigen::Vector2d& right_px) {
        const auto l = rectified_direction(plan.left, left_px);
        const auto r = rectified_direction(*plan.right, right_px);
        if (!l || !r) return;
        const double row_px = focal_px * (l->y() - r->y());
        square += row_px * row_px;
        count += 1.0;
    };
    for (const auto& [left, right] : pairs) for_each_common_point(left, right, add);
    return std::sqrt(square / count);
}

camera::StereoRig rig_of(const StereoParameters& parameters) {
    const auto camera = [&](const Eigen::VectorXd& lens) {
        return camera::Camera{
            model_of(parameters.kind, lens), parameters.size.width, parameters.size.height};
    };
    camera::StereoRig rig;
    rig.left = camera(parameters.left);
    rig.right = camera(parameters.right);
    rig.T_left_right = parameters.T_left_right;
    return rig;
}

std::vector<double> depth_sigmas_m(const StereoParameters& parameters,
                                   const Eigen::MatrixXd& covariance,
                                   std::span<const double> distances_m) {
    const camera::Rectification plan = plan_of(rig_of(parameters));
    std::vector<PixelPair> pixels;
    for (const double z_m : distances_m) {
        const Eigen::Vector3d p_rectified(0.0, 0.0, z_m);
        const auto left = seen(plan.left, p_rectified);
        const auto right = seen(*plan.right, p_rectified);
        const Eigen::Vector2d none = Eigen::Vector2d::Constant(kNan);
        pixels.push_back({left.value_or(none), right.value_or(none)});
    }
    // The eigenvectors are independent error directions; the roots of their eigenvalues are the
    // standard deviations.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
    Eigen::ArrayXd variance = Eigen::ArrayXd::Zero(std::ssize(pixels));
    for (Eigen::Index i = 0; i < covariance.cols(); ++i) {
        const double sigma = std::sqrt(std::max(0.0, solver.eigenvalues()[i]));
        const Eigen::VectorXd step = kStep * sigma * solver.eigenvectors().col(i);
        const Eigen::VectorXd change =
            depths_m(moved(parameters, step), pixels) - depths_m(moved(parameters, -step), pixels);
        variance += (change.array() / (2.0 * kStep)).square();
    }
    const Eigen::ArrayXd sigmas = variance.sqrt();
    return {sigmas.begin(), sigmas.end()};
}

}  // namespace surefoot::calibration
