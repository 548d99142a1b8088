// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/shutter.hpp"

#include <algorithm>

namespace surefoot::sim {
namespace {

CameraView view_from(const Pose& T_world_camera) {
    return {T_world_camera.R(), T_world_camera.translation_m};
}

}  // namespace

void ShutterConfig::describe(ConfigVisitor& visitor) {
    visitor.integer(
        "blur_samples",
        blur_samples,
        0,
        64,
        "number of images, taken during one exposure, that are averaged; 0 or 1 = a sharp image");
    visitor.boolean(
        "rolling",
        rolling,
        "true: the rows of an image are exposed one after another if the rig has a read-out time");
}

double row_offset_s(int row, int height, double readout_s) noexcept {
    return readout_s * ((row + 0.5) / height - 0.5);
}

ImageViews::ImageViews(const Pose& T_world_camera) : views_{view_from(T_world_camera)} {}

ImageViews::ImageViews(const Motion& motion,
                       const Pose& T_body_camera,
                       double instant_s,
                       double readout_s,
                       int height) {
    const int rows = readout_s > 0.0 ? height : 1;
    views_.reserve(static_cast<std::size_t>(rows));
    for (int row = 0; row < rows; ++row) {
        const double offset_s = rows == 1 ? 0.0 : row_offset_s(row, height, readout_s);
        views_.push_back(view_from(motion.at(instant_s + offset_s).T_world_body * T_body_camera));
    }
    // A camera at rest has one view, which is faster to render.
    const bool at_rest = std::all_of(
        views_.begin(), views_.end(), [&](const CameraView& v) { return v == views_.front(); });
    if (at_rest) views_.resize(1);
}

std::vector<double> blur_offsets_s(double exposure_s, int samples) {
    std::vector<double> offsets_s;
    offsets_s.reserve(static_cast<std::size_t>(std::max(samples, 0)));
    for (int k = 0; k < samples; ++k) {
        offsets_s.push_back(exposure_s * ((k + 0.5) / samples - 0.5));
    }
    return offsets_s;
}

}  // namespace surefoot::sim
