// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/rig_scaling.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace surefoot::camera {
namespace {

bool same_shape(const Camera& camera, int width, int height) noexcept {
    return std::int64_t{camera.width} * height == std::int64_t{camera.height} * width;
}

Camera scaled(Camera camera, int width, int height) {
    const double s = static_cast<double>(width) / camera.width;
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
    out.left = scaled(rig.left, width, height);
    if (rig.right) out.right = scaled(*rig.right, width, height);
    if (const auto problem = out.problem()) {
        return input_error(
            fmt::format("the calibration is not valid after scaling to {} x {} px: {}",
                        width,
                        height,
                        *problem));
    }
    return out;
}

bool is_binning(const Camera& camera, int width, int height) noexcept {
    if (width < 1 || height < 1 || camera.width < 1) return false;
    return same_shape(camera, width, height) &&
           (camera.width % width == 0 || width % camera.width == 0);
}

}  // namespace surefoot::camera
