// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/rig_scaling.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "surefoot/core/assert.hpp"

namespace surefoot::camera {
namespace {

bool same_shape(const Camera& camera, int width, int height) noexcept {
    return std::int64_t{camera.width} * height == std::int64_t{camera.height} * width;
}

Camera scaled(Camera camera, double s, int width, int height) {
    std::visit(
        [s](auto& m) {
            m.fx_px *= s;
            m.fy_px *= s;
            m.cx_px = (m.cx_px + 0.5) * s - 0.5;
            m.cy_px = (m.cy_px + 0.5) * s - 0.5;
        },
        camera.model);
    camera.width = width;
    camera.height = height;
    return camera;
}

}  // namespace

Result<StereoRig> scaled_to(const StereoRig& rig, int width, int height) {
    if (rig.left.width == width && rig.left.height == height) return rig;
    if (const auto problem = rig.problem()) return input_error(*problem);
    if (width < 1 || height < 1 || !same_shape(rig.left, width, height)) {
        return input_error(fmt::format(
            "a calibration for {} x {} px cannot be scaled to {} x {} px: the width "
            "changes by the factor {:.4f}, the height by {:.4f}; calibrate at the new resolution",
            rig.left.width,
            rig.left.height,
            width,
            height,
            static_cast<double>(width) / rig.left.width,
            static_cast<double>(height) / rig.left.height));
    }
    StereoRig out = rig;
    const double s = static_cast<double>(width) / rig.left.width;
    out.left = scaled(rig.left, s, width, height);
    if (rig.right) out.right = scaled(*rig.right, s, width, height);
    if (const auto problem = out.problem()) {
        return input_error(
            fmt::format("the calibration is not valid after scaling to {} x {} px: {}",
                        width,
                        height,
                        *problem));
    }
    return out;
}

StereoRig shrunk(const StereoRig& rig, int factor) {
    SUREFOOT_ASSERT(factor >= 1);
    StereoRig out = rig;
    const int width = rig.left.width / factor;
    const int height = rig.left.height / factor;
    out.left = scaled(rig.left, 1.0 / factor, width, height);
    if (rig.right) out.right = scaled(*rig.right, 1.0 / factor, width, height);
    return out;
}

void shrink(ImageView<const std::uint8_t> in, int factor, GreyImage& out) {
    SUREFOOT_ASSERT(factor >= 1 && factor <= in.width && factor <= in.height);
    const int width = in.width / factor;
    const int height = in.height / factor;
    const auto area = static_cast<std::uint32_t>(factor * factor);
    out.resize(width, height);
    for (int v = 0; v < height; ++v) {
        std::uint8_t* const to = out.row(v);
        for (int u = 0; u < width; ++u) {
            std::uint32_t sum = area / 2;
            for (int y = 0; y < factor; ++y) {
                const std::uint8_t* const from = in.row(v * factor + y) + u * factor;
                for (int x = 0; x < factor; ++x) sum += from[x];
            }
            to[u] = static_cast<std::uint8_t>(sum / area);
        }
    }
}

bool is_binning(const Camera& camera, int width, int height) noexcept {
    if (width < 1 || height < 1 || camera.width < 1) return false;
    return same_shape(camera, width, height) &&
           (camera.width % width == 0 || width % camera.width == 0);
}

}  // namespace surefoot::camera
