// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/rectifier.hpp"

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "surefoot/camera/rectification.hpp"

namespace surefoot::camera {
namespace {

/// Where each rectified pixel comes from, in cv::remap's fixed point (1/32 px).
struct RemapTable {
    cv::Mat position;  ///< CV_16SC2, whole pixels
    cv::Mat fraction;  ///< CV_16UC1, index of the bilinear weights
};

/// Far enough outside that bilinear interpolation reads the constant border alone.
constexpr float kNowhere_px = -100.0F;

RemapTable make_table(const RectifiedRig& rig, const RectifiedEye& eye) {
    cv::Mat source(rig.height, rig.width, CV_32FC2);
    const double u_max = eye.camera.width - 1;
    const double v_max = eye.camera.height - 1;
    for (int v = 0; v < rig.height; ++v) {
        auto* row = source.ptr<cv::Vec2f>(v);
        for (int u = 0; u < rig.width; ++u) {
            const Eigen::Vector3d ray(
                (u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0);
            const auto raw = raw_from_ray(eye, ray);
            const bool seen =
                raw && raw->x() >= 0.0 && raw->y() >= 0.0 && raw->x() <= u_max && raw->y() <= v_max;
            row[u] = seen ? cv::Vec2f(static_cast<float>(raw->x()), static_cast<float>(raw->y()))
                          : cv::Vec2f(kNowhere_px, kNowhere_px);
        }
    }
    RemapTable table;
    cv::convertMaps(source, cv::noArray(), table.position, table.fraction, CV_16SC2);
    return table;
}

void remap(const RemapTable& table, const GreyImage& raw, GreyImage& out) {
    out.resize(table.position.cols, table.position.rows);
    // cv::Mat has no view of const pixels; remap only reads them.
    const cv::Mat source(raw.height(), raw.width(), CV_8UC1, const_cast<std::uint8_t*>(raw.data()));
    cv::Mat target(out.height(), out.width(), CV_8UC1, out.data());
    cv::remap(
        source, target, table.position, table.fraction, cv::INTER_LINEAR, cv::BORDER_CONSTANT, 0);
}

}  // namespace

struct Rectifier::Impl {
    Rectification plan;
    RemapTable left;
    RemapTable right;

    [[nodiscard]] const RectifiedEye& eye(Side side) const {
        SUREFOOT_ASSERT(side == Side::left || plan.right.has_value());
        return side == Side::left ? plan.left : *plan.right;
    }
};

Rectifier::Rectifier(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Rectifier::~Rectifier() = default;
Rectifier::Rectifier(Rectifier&&) noexcept = default;
Rectifier& Rectifier::operator=(Rectifier&&) noexcept = default;

Result<Rectifier> Rectifier::make(const StereoRig& rig) {
    if (const auto problem = rig.problem()) {
        return input_error("rig " + (rig.name.empty() ? "" : "'" + rig.name + "'") + ": " +
                           *problem);
    }
    auto impl = std::make_unique<Impl>();
    impl->plan = plan_rectification(rig, kMaxFieldOfView_deg, kVirtualBaseline_m);
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

void Rectifier::rectify(const StereoFrame& frame, RectifiedPair& out) const {
    const RectifiedRig& rig = impl_->plan.rig;
    const bool stereo = impl_->plan.right.has_value();
    SUREFOOT_ASSERT(frame.left.width() == rig.width && frame.left.height() == rig.height);
    SUREFOOT_ASSERT(!stereo ||
                    (frame.right.width() == rig.width && frame.right.height() == rig.height));
    if (!stereo) out.right = GreyImage();
    if (impl_->plan.identity) {
        out.left = frame.left;
        if (stereo) out.right = frame.right;
        return;
    }
    remap(impl_->left, frame.left, out.left);
    if (stereo) remap(impl_->right, frame.right, out.right);
}

void Rectifier::rectify_depth(const Image<float>& raw_depth_m, Image<float>& out) const {
    const RectifiedRig& rig = impl_->plan.rig;
    SUREFOOT_ASSERT(!impl_->plan.right);
    SUREFOOT_ASSERT(raw_depth_m.width() == rig.width && raw_depth_m.height() == rig.height);
    if (impl_->plan.identity) {
        out = raw_depth_m;
        return;
    }
    out.resize(rig.width, rig.height);
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const Eigen::Vector3d ray(
                (u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0);
            const auto raw = raw_from_ray(impl_->plan.left, ray);
            // Averaging across an edge would invent a surface: the nearest pixel, or none.
            const bool seen = raw && raw->x() > -0.5 && raw->y() > -0.5 &&
                              raw->x() < rig.width - 0.5 && raw->y() < rig.height - 0.5;
            out.at(u, v) = seen ? raw_depth_m.at(static_cast<int>(std::lround(raw->x())),
                                                 static_cast<int>(std::lround(raw->y())))
                                : std::numeric_limits<float>::quiet_NaN();
        }
    }
}

std::optional<Eigen::Vector2d> Rectifier::rectified_from_raw(Side side,
                                                             const Eigen::Vector2d& raw) const {
    if (impl_->plan.identity) return raw;
    const RectifiedEye& eye = impl_->eye(side);
    const auto ray = unproject(eye.camera.model, raw);
    if (!ray) return std::nullopt;
    const Eigen::Vector3d p = eye.R_rectified_raw * *ray;
    if (!(p.z() > 0.0)) return std::nullopt;
    const RectifiedRig& rig = impl_->plan.rig;
    return Eigen::Vector2d(rig.fx_px * p.x() / p.z() + rig.cx_px,
                           rig.fy_px * p.y() / p.z() + rig.cy_px);
}

std::optional<Eigen::Vector2d> Rectifier::raw_from_point(Side side,
                                                         const Eigen::Vector3d& p_camera) const {
    const RectifiedEye& eye = impl_->eye(side);
    return raw_from_ray(eye, p_camera - Eigen::Vector3d(eye.offset_x_m, 0.0, 0.0));
}

}  // namespace surefoot::camera
