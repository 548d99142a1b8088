// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/rectification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/assert.hpp"

namespace surefoot::camera {
namespace {

constexpr int kBorderSamples = 128;  ///< samples per side of an image
constexpr double kZoomStep = 1.002;  ///< factor per zoom step until no pixel lacks a source
constexpr int kMaxZoomSteps = 700;   ///< 1.002^700 = 4 times
/// In a plane image of a wider view most pixels are near the border: at 150 deg the outermost pixel
/// covers 1/15 of the angle of the middle pixel.
constexpr double kWidestPlane_deg = 150.0;
constexpr int kMaxSide_px = 16384;

/// A rectangle on the plane z = 1 of the rectified frame.
struct View {
    double x_min, x_max, y_min, y_max;
};

/// Bouguet's method: each camera takes half of the relative rotation. Then both rotate so that x
/// runs along the baseline and z stays as near as possible to the mean viewing direction.
void turn_cameras(const Pose& T_left_right, RectifiedCamera& left, RectifiedCamera& right) {
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

/// Direction of a raw pixel on the plane z = 1; nullopt from 90 deg on.
std::optional<Eigen::Vector2d> on_plane(const RectifiedCamera& this_camera, double u, double v) {
    const auto ray = unproject(this_camera.camera.model, Eigen::Vector2d(u, v));
    if (!ray) return std::nullopt;
    const Eigen::Vector3d p = this_camera.R_rectified_raw * *ray;
    if (!(p.z() > 1e-6)) return std::nullopt;
    return Eigen::Vector2d(p.x() / p.z(), p.y() / p.z());
}

/// Shrinks `view` to the largest upright rectangle inside the border of the camera's image. Border
/// points outside the initial view do not limit it: corners of a fisheye point sideways.
void shrink_to(const RectifiedCamera& this_camera, View& view) {
    const View limit = view;
    const double right = this_camera.camera.width - 1;
    const double bottom = this_camera.camera.height - 1;
    for (int i = 0; i <= kBorderSamples; ++i) {
        const double s = static_cast<double>(i) / kBorderSamples;
        const auto inside_y = [&](const auto& p) {
            return p && p->y() > limit.y_min && p->y() < limit.y_max;
        };
        const auto inside_x = [&](const auto& p) {
            return p && p->x() > limit.x_min && p->x() < limit.x_max;
        };
        if (const auto p = on_plane(this_camera, 0.0, s * bottom); inside_y(p)) {
            view.x_min = std::max(view.x_min, p->x());
        }
        if (const auto p = on_plane(this_camera, right, s * bottom); inside_y(p)) {
            view.x_max = std::min(view.x_max, p->x());
        }
        if (const auto p = on_plane(this_camera, s * right, 0.0); inside_x(p)) {
            view.y_min = std::max(view.y_min, p->y());
        }
        if (const auto p = on_plane(this_camera, s * right, bottom); inside_x(p)) {
            view.y_max = std::min(view.y_max, p->y());
        }
    }
}

/// Sets equal focal lengths; the image shows a part of `view` around its centre.
void set_intrinsics(const View& view, RectifiedRig& rig) {
    const double focal_px = std::max((rig.width - 1) / (view.x_max - view.x_min),
                                     (rig.height - 1) / (view.y_max - view.y_min));
    rig.fx_px = rig.fy_px = focal_px;
    rig.cx_px = 0.5 * (rig.width - 1) - focal_px * 0.5 * (view.x_min + view.x_max);
    rig.cy_px = 0.5 * (rig.height - 1) - focal_px * 0.5 * (view.y_min + view.y_max);
}

bool has_source(const RectifiedRig& rig, const RectifiedCamera& this_camera, double u, double v) {
    const Eigen::Vector3d ray((u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0);
    const auto raw = raw_from_ray(this_camera, ray);
    return raw && raw->x() >= 0.0 && raw->y() >= 0.0 && raw->x() <= this_camera.camera.width - 1 &&
           raw->y() <= this_camera.camera.height - 1;
}

bool border_has_source(const RectifiedRig& rig, const RectifiedCamera& this_camera) {
    for (int u = 0; u < rig.width; ++u) {
        if (!has_source(rig, this_camera, u, 0) || !has_source(rig, this_camera, u, rig.height - 1))
            return false;
    }
    for (int v = 0; v < rig.height; ++v) {
        if (!has_source(rig, this_camera, 0, v) || !has_source(rig, this_camera, rig.width - 1, v))
            return false;
    }
    return true;
}

/// Changes the focal length; the middle of the image keeps its direction.
void zoom_to(double focal_px, RectifiedRig& rig) {
    const double factor = focal_px / rig.fx_px;
    const double middle_u = 0.5 * (rig.width - 1);
    const double middle_v = 0.5 * (rig.height - 1);
    rig.fx_px = rig.fy_px = focal_px;
    rig.cx_px = middle_u + (rig.cx_px - middle_u) * factor;
    rig.cy_px = middle_v + (rig.cy_px - middle_v) * factor;
}

void fill_image(Rectification& plan, double max_field_of_view_deg) {
    const double limit = std::tan(0.5 * max_field_of_view_deg * std::numbers::pi / 180.0);
    View view{-limit, limit, -limit, limit};
    shrink_to(plan.left, view);
    if (plan.right) shrink_to(*plan.right, view);
    // The rectangle is empty if a lens does not show the common viewing direction. Then use the
    // limit; pixels without a source become black.
    if (!(view.x_max > view.x_min) || !(view.y_max > view.y_min))
        view = {-limit, limit, -limit, limit};
    set_intrinsics(view, plan.rig);
    const RectifiedRig widest = plan.rig;
    for (int step = 0; step < kMaxZoomSteps; ++step) {
        if (border_has_source(plan.rig, plan.left) &&
            (!plan.right || border_has_source(plan.rig, *plan.right))) {
            return;
        }
        zoom_to(plan.rig.fx_px * kZoomStep, plan.rig);
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

void RectificationConfig::describe(ConfigVisitor& visitor) {
    visitor.number("rectified_focal_px",
                   rectified_focal_px,
                   0.0,
                   1e5,
                   "focal length of rectified images; 0 = the smallest focal length that leaves no "
                   "pixel black and shows at most max_view_deg");
    visitor.integer("rectified_width_px",
                    rectified_width_px,
                    0,
                    kMaxSide_px,
                    "width of rectified images; 0 = width of the raw images");
    visitor.integer("rectified_height_px",
                    rectified_height_px,
                    0,
                    kMaxSide_px,
                    "height of rectified images; 0 = height of the raw images");
    visitor.number("max_view_deg",
                   max_view_deg,
                   10.0,
                   kWidestPlane_deg,
                   "largest angle of view of rectified images if rectified_focal_px is 0; a wider "
                   "view reduces the resolution in the middle of the image");
}

std::optional<std::string> RectificationConfig::problem(int raw_width, int raw_height) const {
    const int width = rectified_width_px > 0 ? rectified_width_px : raw_width;
    const int height = rectified_height_px > 0 ? rectified_height_px : raw_height;
    if (width < 2 || height < 2 || width > kMaxSide_px || height > kMaxSide_px) {
        return fmt::format(
            "camera.rectified_width_px, camera.rectified_height_px: {}x{} px must be between 2 and "
            "{} on each side",
            width,
            height,
            kMaxSide_px);
    }
    if (!(max_view_deg >= 10.0 && max_view_deg <= kWidestPlane_deg)) {
        return fmt::format(
            "camera.max_view_deg = {} must be 10 to {} deg", max_view_deg, kWidestPlane_deg);
    }
    if (rectified_focal_px == 0.0) return std::nullopt;
    const double longest = std::max(width, height) - 1;
    const double view_deg = 2.0 * std::atan2(0.5 * longest, rectified_focal_px) * kDegPerRad;
    if (!(rectified_focal_px > 0.0 && view_deg <= kWidestPlane_deg)) {
        return fmt::format(
            "camera.rectified_focal_px = {} must be at least {:.0f} for a {}x{} image: a plane "
            "image shows at most {} deg",
            rectified_focal_px,
            std::ceil(0.5 * longest / std::tan(0.5 * kWidestPlane_deg / kDegPerRad)),
            width,
            height,
            kWidestPlane_deg);
    }
    return std::nullopt;
}

Rectification plan_rectification(const StereoRig& rig,
                                 const RectificationConfig& config,
                                 double virtual_baseline_m) {
    SUREFOOT_ASSERT(!rig.problem() && !config.problem(rig.left.width, rig.left.height));
    Rectification plan;
    plan.left.camera = rig.left;
    plan.rig.width = config.rectified_width_px > 0 ? config.rectified_width_px : rig.left.width;
    plan.rig.height = config.rectified_height_px > 0 ? config.rectified_height_px : rig.left.height;
    plan.rig.baseline_m = rig.right ? rig.T_left_right.translation_m.norm() : virtual_baseline_m;
    if (rig.right)
        plan.right = RectifiedCamera{.camera = *rig.right, .offset_x_m = plan.rig.baseline_m};

    const auto* pinhole = std::get_if<PinholeRadTan>(&rig.left.model);
    const bool ideal_rgbd = !rig.right && pinhole != nullptr && !pinhole->has_distortion();
    const bool same_size = plan.rig.width == rig.left.width && plan.rig.height == rig.left.height;
    plan.identity = (rig.rectified || ideal_rgbd) && same_size && config.rectified_focal_px == 0.0;
    if (plan.identity) {
        keep_intrinsics(*pinhole, plan.rig);
    } else {
        if (plan.right) turn_cameras(rig.T_left_right, plan.left, *plan.right);
        fill_image(plan, config.max_view_deg);
        if (config.rectified_focal_px > 0.0) zoom_to(config.rectified_focal_px, plan.rig);
    }
    const Eigen::Matrix3d R_left_rectified = plan.left.R_rectified_raw.transpose();
    plan.rig.T_body_camera =
        rig.body_from_left() * Pose{Eigen::Quaterniond(R_left_rectified), Eigen::Vector3d::Zero()};
    return plan;
}

std::optional<Eigen::Vector2d> raw_from_ray(const RectifiedCamera& this_camera,
                                            const Eigen::Vector3d& ray) {
    return project(this_camera.camera.model, this_camera.R_rectified_raw.transpose() * ray);
}

}  // namespace surefoot::camera
