// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/core/pose.hpp"
#include "surefoot/odometry/visual/stereo_projection.hpp"

namespace surefoot::odometry {

/// One observation of a point from a pose.
struct BundleSight {
    int pose = 0;
    int point = 0;
    StereoPixel pixel_px;
    double noise_factor = 1.0;
};

/// Poses and points that are adjusted together to fit observations. `sights` is sorted by point.
struct BundleProblem {
    std::vector<Pose> T_world_camera;
    std::vector<std::uint8_t> fixed;  ///< one flag per pose; at least one must be 1
    std::vector<Eigen::Vector3d> p_world_m;
    std::vector<BundleSight> sights;

    void clear();
};

struct BundleConfig {
    double sigma_px = 0.3;
    double huber_sigmas = 1.0;
    int iterations = 4;
};

struct BundleResult {
    double cost_before = 0.0;  ///< robust cost [squared sigmas]
    double cost_after = 0.0;
    int steps = 0;                             ///< number of accepted steps
    std::vector<Eigen::Matrix3d> information;  ///< information of each point [1/m^2], poses fixed
    std::vector<double> residual_sigmas;       ///< residual of each sight; inf = behind the camera
};

/// Bundle adjustment by Levenberg-Marquardt with Huber weights on (u_left, v, u_right). The Schur
/// complement eliminates the points (Triggs et al. 2000). Serial and deterministic.
[[nodiscard]] BundleResult adjust_bundle(const camera::RectifiedRig& rig,
                                         const BundleConfig& config,
                                         BundleProblem& problem);

}  // namespace surefoot::odometry
