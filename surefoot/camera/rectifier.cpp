// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/rectifier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/camera/rectification.hpp"
#include "surefoot/camera/remap.hpp"
#include "surefoot/core/nearest_pixel.hpp"

namespace surefoot::camera {
namespace {

/// Direction of a rectified pixel, in the rectified frame.
Eigen::Vector3d ray_of(const RectifiedRig& rig, int u, int v) {
    return {(u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0};
}

RemapTable make_table(const RectifiedRig& rig, const RectifiedCamera& this_camera) {
    RemapTable table(rig.width, rig.height, this_camera.camera.width, this_camera.camera.height);
    const double u_max = this_camera.camera.width - 1;
    const double v_max = this_camera.camera.height - 1;
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const auto raw = raw_from_ray(this_camera, ray_of(rig, u, v));
            const bool seen =
                raw && raw->x() >= 0.0 && raw->y() >= 0.0 && raw->x() <= u_max && raw->y() <= v_max;
            if (seen) table.set(u, v, static_cast<float>(raw->x()), static_cast<float>(raw->y()));
        }
    }
    return table;
}

void copy_part(const GreyImage& image, const PixelBox& box, GreyImage& out) {
    out.resize(box.width, box.height);
    for (int v = 0; v < box.height; ++v)
        std::copy_n(image.row(box.v + v) + box.u, box.width, out.row(v));
}

}  // namespace

RectifiedRig part_of(const RectifiedRig& rig, const PixelBox& box) {
    RectifiedRig part = rig;
    part.width = box.width;
    part.height = box.height;
    part.cx_px -= box.u;
    part.cy_px -= box.v;
    return part;
}

struct Rectifier::Impl {
    Rectification plan;
    RemapTable left;
    RemapTable right;
    double readout_s = 0.0;

    [[nodiscard]] bool has_size_of(const StereoFrame& frame) const {
        const Camera& raw = plan.left.camera;
        return frame.left.width() == raw.width && frame.left.height() == raw.height &&
               (!plan.right ||
                (frame.right.width() == raw.width && frame.right.height() == raw.height));
    }
    [[nodiscard]] const RectifiedCamera& camera(Side side) const {
        SUREFOOT_ASSERT(side == Side::left || plan.right.has_value());
        return side == Side::left ? plan.left : *plan.right;
    }
};

Rectifier::Rectifier(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Rectifier::~Rectifier() = default;
Rectifier::Rectifier(Rectifier&&) noexcept = default;
Rectifier& Rectifier::operator=(Rectifier&&) noexcept = default;

Result<Rectifier> Rectifier::make(const StereoRig& rig, const RectificationConfig& config) {
    if (const auto problem = rig.problem()) {
        return input_error("rig " + (rig.name.empty() ? "" : "'" + rig.name + "'") + ": " +
                           *problem);
    }
    if (const auto problem = config.problem(rig.left.width, rig.left.height))
        return usage_error(*problem);
    auto impl = std::make_unique<Impl>();
    impl->plan = plan_rectification(rig, config, kVirtualBaseline_m);
    impl->readout_s = rig.readout_s;
    if (!impl->plan.identity) {
        impl->left = make_table(impl->plan.rig, impl->plan.left);
        if (impl->plan.right) impl->right = make_table(impl->plan.rig, *impl->plan.right);
    }
    return Rectifier(std::move(impl));
}

const RectifiedRig& Rectifier::rig() const noexcept {
    return impl_->plan.rig;
}

bool Rectifier::is_identity() const noexcept {
    return impl_->plan.identity;
}

double Rectifier::row_offset_s(double v_raw_px) const noexcept {
    return impl_->readout_s * ((v_raw_px + 0.5) / impl_->plan.left.camera.height - 0.5);
}

void Rectifier::rectify(const StereoFrame& frame, RectifiedPair& out) const {
    const bool stereo = impl_->plan.right.has_value();
    SUREFOOT_ASSERT(impl_->has_size_of(frame));
    if (!stereo) out.right = GreyImage();
    if (impl_->plan.identity) {
        out.left = frame.left;
        if (stereo) out.right = frame.right;
        return;
    }
    impl_->left.remap(frame.left.view(), out.left);
    if (stereo) impl_->right.remap(frame.right.view(), out.right);
}

void Rectifier::rectify_part(const StereoFrame& frame,
                             const PixelBox& box,
                             RectifiedPair& out) const {
    const RectifiedRig& rig = impl_->plan.rig;
    SUREFOOT_ASSERT(impl_->has_size_of(frame));
    SUREFOOT_ASSERT(box.u >= 0 && box.v >= 0 && box.width >= 0 && box.height >= 0 &&
                    box.u + box.width <= rig.width && box.v + box.height <= rig.height);
    const auto part = [&](const GreyImage& raw, const RemapTable& table, GreyImage& to) {
        if (impl_->plan.identity) return copy_part(raw, box, to);
        table.remap_part(raw.view(), box.u, box.v, box.width, box.height, to);
    };
    part(frame.left, impl_->left, out.left);
    if (impl_->plan.right) {
        part(frame.right, impl_->right, out.right);
    } else {
        out.right = GreyImage();
    }
}

void Rectifier::rectify_depth(const Image<float>& raw_depth_m, Image<float>& out) const {
    const RectifiedRig& rig = impl_->plan.rig;
    const Camera& camera = impl_->plan.left.camera;
    SUREFOOT_ASSERT(!impl_->plan.right);
    SUREFOOT_ASSERT(raw_depth_m.width() == camera.width && raw_depth_m.height() == camera.height);
    if (impl_->plan.identity) {
        out = raw_depth_m;
        return;
    }
    out.resize(rig.width, rig.height);
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const auto raw = raw_from_ray(impl_->plan.left, ray_of(rig, u, v));
            // Averaging across an edge would create a false surface: use the nearest pixel or no
            // pixel.
            const auto nearest =
                raw ? nearest_pixel(raw->x(), raw->y(), camera.width, camera.height) : std::nullopt;
            out.at(u, v) = nearest ? raw_depth_m.at(nearest->u, nearest->v)
                                   : std::numeric_limits<float>::quiet_NaN();
        }
    }
}

std::optional<Eigen::Vector2d> Rectifier::rectified_from_raw(Side side,
                                                             const Eigen::Vector2d& raw) const {
    if (impl_->plan.identity) return raw;
    const RectifiedCamera& this_camera = impl_->camera(side);
    const auto ray = unproject(this_camera.camera.model, raw);
    if (!ray) return std::nullopt;
    const Eigen::Vector3d p = this_camera.R_rectified_raw * *ray;
    if (!(p.z() > 0.0)) return std::nullopt;
    const RectifiedRig& rig = impl_->plan.rig;
    return Eigen::Vector2d(rig.fx_px * p.x() / p.z() + rig.cx_px,
                           rig.fy_px * p.y() / p.z() + rig.cy_px);
}

std::optional<Eigen::Vector2d> Rectifier::raw_from_point(Side side,
                                                         const Eigen::Vector3d& p_camera) const {
    const RectifiedCamera& this_camera = impl_->camera(side);
    return raw_from_ray(this_camera, p_camera - Eigen::Vector3d(this_camera.offset_x_m, 0.0, 0.0));
}

}  // namespace surefoot::camera
