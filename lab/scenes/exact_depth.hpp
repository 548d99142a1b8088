// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/depth_image.hpp"
#include "surefoot/sim/rendering/renderer.hpp"

namespace surefoot::experiments {

/// Returns the depth image of a matcher without errors at a body pose: true disparities of the
/// scene, a stated sigma of 0.1 px, and outlier probability 0 everywhere.
[[nodiscard]] inline DepthImage exact_depth(const sim::Scene& scene,
                                            const camera::RectifiedRig& rig,
                                            const Pose& T_world_body,
                                            Executor& executor) {
    constexpr float kSigma_px = 0.1F;
    DepthImage depth;
    depth.disparity_px = sim::rectified_disparity_px(scene, rig, T_world_body, executor);
    depth.sigma_px = Image<float>(rig.width, rig.height, kSigma_px);
    depth.outlier_probability = Image<float>(rig.width, rig.height, 0.0F);
    return depth;
}

}  // namespace surefoot::experiments
