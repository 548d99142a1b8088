// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/rgbd_depth.hpp"

#include <cmath>
#include <limits>

namespace surefoot::pipeline {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Depth of the raw pixel nearest to where a rectified pixel looks, NaN outside the image.
float raw_depth_m(const camera::Rectifier& rectifier,
                  ImageView<const float> depth_m,
                  int u,
                  int v) {
    const camera::RectifiedRig& rig = rectifier.rig();
    const Eigen::Vector3d ray((u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0);
    const auto raw = rectifier.raw_from_point(camera::Side::left, ray);
    if (!raw) return kNaN;
    const long column = std::lround(raw->x());
    const long row = std::lround(raw->y());
    if (column < 0 || row < 0 || column >= depth_m.width || row >= depth_m.height) return kNaN;
    return depth_m.at(static_cast<int>(column), static_cast<int>(row));
}

}  // namespace

void depth_from_rgbd(const camera::Rectifier& rectifier,
                     const elevation::SensorConfig& sensor,
                     ImageView<const float> depth_m,
                     camera::DepthImage& out) {
    const camera::RectifiedRig& rig = rectifier.rig();
    elevation::SensorConfig kinect = sensor;
    kinect.model = elevation::SensorModel::kinect;
    out.resize(rig.width, rig.height);
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const double z_m = raw_depth_m(rectifier, depth_m, u, v);
            const bool known = z_m > 0.0 && std::isfinite(z_m);
            const double disparity_px = rig.depth_to_disparity_px_m() / z_m;
            const auto variance = elevation::ray_variance(kinect, {.depth_m = z_m, .range_m = z_m});
            out.disparity_px.at(u, v) = known ? static_cast<float>(disparity_px) : kNaN;
            out.sigma_px.at(u, v) =
                known ? static_cast<float>(disparity_px * std::sqrt(variance.along_m2) / z_m)
                      : kNaN;
            out.outlier_probability.at(u, v) = known ? 0.0F : 1.0F;
        }
    }
}

}  // namespace surefoot::pipeline
