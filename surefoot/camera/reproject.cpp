// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/reproject.hpp"

#include "surefoot/camera/reproject_simd.hpp"

namespace surefoot::camera {

Reprojector::Reprojector(const RectifiedRig& rig)
    : depth_to_disparity_px_m_(static_cast<float>(rig.depth_to_disparity_px_m())) {
    for (int u = 0; u < rig.width; ++u)
        ray_x_.push_back(static_cast<float>((u - rig.cx_px) / rig.fx_px));
    for (int v = 0; v < rig.height; ++v)
        ray_y_.push_back(static_cast<float>((v - rig.cy_px) / rig.fy_px));
}

void Reprojector::points(ImageView<const float> disparity_px, Image<Eigen::Vector3f>& out) const {
    SUREFOOT_ASSERT(disparity_px.width == static_cast<int>(ray_x_.size()) &&
                    disparity_px.height == static_cast<int>(ray_y_.size()));
    out.resize(disparity_px.width, disparity_px.height);
    for (int v = 0; v < disparity_px.height; ++v) {
        reproject_row({disparity_px.row(v),
                       ray_x_.data(),
                       ray_y_[static_cast<std::size_t>(v)],
                       depth_to_disparity_px_m_,
                       disparity_px.width},
                      out.row(v));
    }
}

}  // namespace surefoot::camera
