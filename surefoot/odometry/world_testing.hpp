// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/odometry/synthetic_testing.hpp"
#include "surefoot/odometry/visual/pose_solver.hpp"

namespace surefoot::odometry::testing {

/// Points in view of a stereo camera. The camera measured them at the origin and then moved by
/// `T_world_camera`.
struct World {
    camera::RectifiedRig rig = rectified_rig();
    PoseSolverConfig config;
    Pose T_world_camera;
    std::vector<PointMatch> matches;

    World(std::uint64_t seed, int count, double noise_px) {
        Rng rng(seed);
        T_world_camera = {
            exp_so3({rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1)}),
            {rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1)}};
        while (static_cast<int>(matches.size()) < count) {
            const double z_m = rng.uniform(0.8, 5.0);
            const Eigen::Vector3d p(
                rng.uniform(-0.8, 0.8) * z_m, rng.uniform(-0.45, 0.45) * z_m, z_m);
            const Eigen::Vector3d now = T_world_camera.inverse() * p;
            if (now.z() < 0.3) continue;
            const auto noise = [&]() -> Eigen::Vector3d {
                return Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()) * noise_px;
            };
            const StereoPixel before = project_stereo(rig, p) + noise();
            PointMatch match;
            match.p_world_m = noise_px > 0.0 ? triangulate(rig, before) : p;
            if (noise_px > 0.0) match.covariance_m2 = point_covariance(rig, before, noise_px);
            match.pixel_px = project_stereo(rig, now) + noise();
            matches.push_back(match);
        }
        if (noise_px > 0.0) config.sigma_px = noise_px;
    }
};

}  // namespace surefoot::odometry::testing
