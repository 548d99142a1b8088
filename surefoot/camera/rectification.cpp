// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/rectification.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/core/assert.hpp"

namespace surefoot::camera {
namespace {

constexpr int kBorderSamples = 128;  ///< per side of an image
constexpr double kZoomStep = 1.002;  ///< how fast the view shrinks until all of it is covered
constexpr int kMaxZoomSteps = 700;   ///< 1.002^700 = 4 times

/// Rectangle on the plane z = 1 of the rectified frame.
struct View {
    double x_min, x_max, y_min, y_max;
};

/// Turns of Bouguet's method: each camera takes half of the relative rotation, then both turn so
/// that x runs along the baseline and z stays as near as possible to the mean viewing direction.
void turn_eyes(const Pose& T_left_right, RectifiedEye& left, RectifiedEye& right) {
    const Eigen::Vector3d half = 0.5 * log_so3(T_left_right.rotation);
    const Eigen::Matrix3d R_middle_left = exp_so3(-half).toRotationMatrix();
    const Eigen::Vector3d x = (R_middle_left * T_left_right.translation_m).normalized();
    const Eigen::Vector3d y = Eigen::Vector3d::UnitZ().cross(x).normalized();
    Eigen::Matrix3d R_rectified_middle;
    R_rectified_middle << x.transpose(), y.transpose(), x.cross(y).transpose();
    left.R_rectified_raw = R_rectified_middle * R_middle_left;
    right.R_rectified_raw = R_rectified_middle * exp_so3(half).toRotationMatrix();
    right.offset_x_m = T_left_right.translation_m.norm();
}

/// Direction of a raw pixel on the plane z = 1; nothing beyond 90 deg.
std::optional<Eigen::Vector2d> on_plane(const RectifiedEye& eye, double u, double v) {
    const auto ray = unproject(eye.camera.model, Eigen::Vector2d(u, v));
    if (!ray) return std::nullopt;
    const Eigen::Vector3d p = eye.R_rectified_raw * *ray;
    if (!(p.z() > 1e-6)) return std::nullopt;
    return Eigen::Vector2d(p.x() / p.z(), p.y() / p.z());
}

/// Shrinks `view` to the largest upright rectangle inside the border of the eye's image. Border
/// points outside the view so far do not limit it (corners of a fisheye look sideways).
void shrink_to(const RectifiedEye& eye, View& view) {
    const View limit = view;
    const double right = eye.camera.width - 1;
    const double bottom = eye.camera.height - 1;
    for (int i = 0; i <= kBorderSamples; ++i) {
        const double s = static_cast<double>(i) / kBorderSamples;
        const auto inside_y = [&](const auto& p) {
            return p && p->y() > limit.y_min && p->y() < limit.y_max;
        };
        const auto inside_x = [&](const auto& p) {
            return p && p->x() > limit.x_min && p->x() < limit.x_max;
        };
        if (const auto p = on_plane(eye, 0.0, s * bottom); inside_y(p)) {
            view.x_min = std::max(view.x_min, p->x());
        }
        if (const auto p = on_plane(eye, right, s * bottom); inside_y(p)) {
            view.x_max = std::min(view.x_max, p->x());
        }
        if (const auto p = on_plane(eye, s * right, 0.0); inside_x(p)) {
            view.y_min = std::max(view.y_min, p->y());
        }
        if (const auto p = on_plane(eye, s * right, bottom); inside_x(p)) {
            view.y_max = std::min(view.y_max, p->y());
        }
    }
}

/// Equal focal lengths; the image shows a part of `view` around its centre.
void set_intrinsics(const View& view, RectifiedRig& rig) {
    const double focal_px = std::max((rig.width - 1) / (view.x_max - view.x_min),
                                     (rig.height - 1) / (view.y_max - view.y_min));
    rig.fx_px = rig.fy_px = focal_px;
    rig.cx_px = 0.5 * (rig.width - 1) - focal_px * 0.5 * (view.x_min + view.x_max);
    rig.cy_px = 0.5 * (rig.height - 1) - focal_px * 0.5 * (view.y_min + view.y_max);
}

bool has_source(const RectifiedRig& rig, const RectifiedEye& eye, double u, double v) {
    const Eigen::Vector3d ray((u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0);
    const auto raw = raw_from_ray(eye, ray);
    return raw && raw->x() >= 0.0 && raw->y() >= 0.0 && raw->x() <= eye.camera.width - 1 &&
           raw->y() <= eye.camera.height - 1;
}

bool border_has_source(const RectifiedRig& rig, const RectifiedEye& eye) {
    for (int u = 0; u < rig.width; ++u) {
        if (!has_source(rig, eye, u, 0) || !has_source(rig, eye, u, rig.height - 1)) return false;
    }
    for (int v = 0; v < rig.height; ++v) {
        if (!has_source(rig, eye, 0, v) || !has_source(rig, eye, rig.width - 1, v)) return false;
    }
    return true;
}

void fill_image(Rectification& plan, double max_field_of_view_deg) {
    const double limit = std::tan(0.5 * max_field_of_view_deg * std::numbers::pi / 180.0);
    View view{-limit, limit, -limit, limit};
    shrink_to(plan.left, view);
    if (plan.right) shrink_to(*plan.right, view);
    // A lens whose picture does not hold the common viewing direction leaves nothing: keep the
    // limit and let the pixels without a source be black.
    if (!(view.x_max > view.x_min) || !(view.y_max > view.y_min))
        view = {-limit, limit, -limit, limit};
    set_intrinsics(view, plan.rig);
    const RectifiedRig widest = plan.rig;
    for (int step = 0; step < kMaxZoomSteps; ++step) {
        if (border_has_source(plan.rig, plan.left) &&
            (!plan.right || border_has_source(plan.rig, *plan.right))) {
            return;
        }
        // Zoom about the middle of the image.
        const double middle_u = 0.5 * (plan.rig.width - 1);
        const double middle_v = 0.5 * (plan.rig.height - 1);
        plan.rig.fx_px *= kZoomStep;
        plan.rig.fy_px *= kZoomStep;
        plan.rig.cx_px = middle_u + (plan.rig.cx_px - middle_u) * kZoomStep;
        plan.rig.cy_px = middle_v + (plan.rig.cy_px - middle_v) * kZoomStep;
    }
    plan.rig = widest;
}

void keep_intrinsics(const PinholeRadTan& model, RectifiedRig& rig) {
    rig.fx_px = model.fx_px;
    rig.fy_px = model.fy_px;
    rig.cx_px = model.cx_px;
    rig.cy_px = model.cy_px;
}

}  // namespace

Rectification plan_rectification(const StereoRig& rig,
                                 double max_field_of_view_deg,
                                 double virtual_baseline_m) {
    SUREFOOT_ASSERT(!rig.problem());
    Rectification plan;
    plan.left.camera = rig.left;
    plan.rig.width = rig.left.width;
    plan.rig.height = rig.left.height;
    plan.rig.baseline_m = rig.right ? rig.T_left_right.translation_m.norm() : virtual_baseline_m;
    if (rig.right)
        plan.right = RectifiedEye{.camera = *rig.right, .offset_x_m = plan.rig.baseline_m};

    const auto* pinhole = std::get_if<PinholeRadTan>(&rig.left.model);
    const bool ideal_rgbd = !rig.right && pinhole != nullptr && !pinhole->has_distortion();
    plan.identity = rig.rectified || ideal_rgbd;
    if (plan.identity) {
        keep_intrinsics(*pinhole, plan.rig);
    } else {
        if (plan.right) turn_eyes(rig.T_left_right, plan.left, *plan.right);
        fill_image(plan, max_field_of_view_deg);
    }
    const Eigen::Matrix3d R_left_rectified = plan.left.R_rectified_raw.transpose();
    plan.rig.T_body_camera =
        rig.body_from_left() * Pose{Eigen::Quaterniond(R_left_rectified), Eigen::Vector3d::Zero()};
    return plan;
}

std::optional<Eigen::Vector2d> raw_from_ray(const RectifiedEye& eye, const Eigen::Vector3d& ray) {
    return project(eye.camera.model, eye.R_rectified_raw.transpose() * ray);
}

}  // namespace surefoot::camera
