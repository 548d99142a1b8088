// SPDX-License-Identifier: Apache-2.0
#include "surefoot/ground/sample_points.hpp"

#include <cmath>

#include "surefoot/core/assert.hpp"

namespace surefoot::ground {

void sample_points(const camera::RectifiedRig& rig,
                   const camera::DepthImage& depth,
                   int step_px,
                   std::vector<Eigen::Vector3d>& points_body,
                   float max_outlier_probability) {
    SUREFOOT_ASSERT(step_px > 0);
    points_body.clear();
    const Eigen::Matrix3d R_body_camera = rig.T_body_camera.R();
    for (int v = step_px / 2; v < depth.disparity_px.height(); v += step_px) {
        const float* disparity = depth.disparity_px.row(v);
        const float* outlier = depth.outlier_probability.row(v);
        for (int u = step_px / 2; u < depth.disparity_px.width(); u += step_px) {
            const float d_px = disparity[u];
            if (!(d_px > 0.0F && std::isfinite(d_px))) continue;
            if (!(outlier[u] <= max_outlier_probability)) continue;
            points_body.emplace_back(R_body_camera * rig.point(u, v, static_cast<double>(d_px)) +
                                     rig.T_body_camera.translation_m);
        }
    }
}

}  // namespace surefoot::ground
