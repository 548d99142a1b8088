// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/ground/sample_points.hpp"

/// Simulated points of a stereo camera over level surfaces.
namespace surefoot::ground::test {

/// Level rectangle in base_link, whose z axis is up; or a ramp that rises along x.
struct Surface {
    double z_m = 0.0;  ///< at x = 0 of a ramp
    double min_x_m = -10.0;
    double max_x_m = 10.0;
    double min_y_m = -10.0;
    double max_y_m = 10.0;
    double rise = 0.0;  ///< rise per metre of x
};

struct FrameOptions {
    double camera_height_m = 1.0;  ///< height of base_link and camera; they have the same origin
    double pitch_deg = 32.0;
    double noise_px = 0.4;  ///< 1 sigma of the disparity, as of the real ZED
    std::uint64_t seed = 1;
};

/// Every fourth pixel of a ZED at 672x376. base_link is level, at the camera.
inline FramePoints seen(const std::vector<Surface>& surfaces, const FrameOptions& options = {}) {
    constexpr double kFocal_px = 350.0;
    constexpr double kBaseline_m = 0.12;
    constexpr double kFarthest_m = 20.0;
    FramePoints frame;
    Rng rng(options.seed);
    const Eigen::Matrix3d R_body_camera =
        (exp_so3({0.0, options.pitch_deg * std::numbers::pi / 180.0, 0.0}) *
         T_body_optical().rotation)
            .toRotationMatrix();
    for (int v = 2; v < 376; v += 4) {
        for (int u = 2; u < 672; u += 4) {
            const Eigen::Vector3d ray_camera((u - 336) / kFocal_px, (v - 188) / kFocal_px, 1.0);
            const Eigen::Vector3d ray = R_body_camera * ray_camera;
            double nearest_m = std::numeric_limits<double>::infinity();  // along the optical axis
            for (const Surface& surface : surfaces) {
                const double z_m =
                    (surface.z_m - options.camera_height_m) / (ray.z() - surface.rise * ray.x());
                const Eigen::Vector3d p = z_m * ray;
                const bool hit = z_m > 0.0 && p.x() >= surface.min_x_m &&
                                 p.x() <= surface.max_x_m && p.y() >= surface.min_y_m &&
                                 p.y() <= surface.max_y_m;
                if (hit) nearest_m = std::min(nearest_m, z_m);
            }
            const double noise_px = options.noise_px * rng.normal();
            if (nearest_m > kFarthest_m) continue;
            const double d_px = kFocal_px * kBaseline_m / nearest_m + noise_px;
            if (d_px <= 0.5) continue;
            frame.points_body_m.emplace_back(kFocal_px * kBaseline_m / d_px * ray);
            frame.inverse_range_sigma.push_back(options.noise_px /
                                                (d_px * frame.points_body_m.back().norm()));
        }
    }
    return frame;
}

}  // namespace surefoot::ground::test
