// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/rgbd_depth.hpp"

#include <cmath>

#include "surefoot/core/unknown.hpp"

namespace surefoot::pipeline {

void depth_from_rgbd(const camera::Rectifier& rectifier,
                     const elevation::SensorConfig& sensor,
                     const Image<float>& depth_m,
                     DepthImage& out) {
    elevation::SensorConfig kinect = sensor;
    kinect.model = elevation::SensorModel::kinect;
    const double fb_px_m = rectifier.rig().depth_to_disparity_px_m();
    out.resize(rectifier.rig().width, rectifier.rig().height);
    rectifier.rectify_depth(depth_m,
                            out.disparity_px);  // holds depths here; converted to disparities below
    for (std::size_t i = 0; i < out.disparity_px.size(); ++i) {
        const auto z_m = static_cast<double>(out.disparity_px.data()[i]);
        const bool known = z_m > 0.0 && std::isfinite(z_m);
        const double disparity_px = fb_px_m / z_m;
        const auto variance = elevation::ray_variance(kinect, {.depth_m = z_m, .range_m = z_m});
        const double sigma_px = disparity_px * std::sqrt(variance.along_m2) / z_m;
        out.disparity_px.data()[i] = known ? static_cast<float>(disparity_px) : kNanF;
        out.sigma_px.data()[i] = known ? static_cast<float>(sigma_px) : kNanF;
        out.outlier_probability.data()[i] = known ? 0.0F : 1.0F;
    }
}

}  // namespace surefoot::pipeline
