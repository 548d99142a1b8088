// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/terrain_testing.hpp"

namespace surefoot::stairs::testing {

using Eigen::Vector3d;

/// Ground behind an edge at the origin, along +x: beyond `behind_m` the ground lies `depth_m` lower
/// than before the edge.
struct Tread {
    double behind_m = 0.0;
    double depth_m = 0.0;
};

inline std::vector<Tread> flight(int steps, double riser_m, double going_m) {
    std::vector<Tread> treads;
    for (int k = 0; k < steps; ++k) treads.push_back({k * going_m, (k + 1) * riser_m});
    return treads;
}

/// A camera 1 m above the ground before the edge, pitched 30 deg down, and its disparities.
class RayScene {
  public:
    RayScene(const std::vector<Tread>& treads,
             double distance_m,
             double yaw_rad,
             double roll_rad = 0.0,
             bool open = false)
        : open_(open) {
        view_.width_px = 672;
        view_.height_px = 376;
        view_.fx_px = view_.fy_px = 343.0;
        view_.cx_px = 336.0;
        view_.cy_px = 188.0;
        view_.baseline_m = 0.12;
        view_.T_map_camera.translation_m = {-distance_m, 0.0, kCamera_m};
        Eigen::Matrix3d axes;  // x right, y down, z forward
        axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
        view_.T_map_camera.rotation = Eigen::Quaterniond(
            Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()) *
            Eigen::AngleAxisd(30.0 * kRadPerDeg, Vector3d::UnitY()) *
            Eigen::AngleAxisd(roll_rad, Vector3d::UnitX()) * Eigen::Quaterniond(axes));
        edge_.from_m = {0.0, -0.6};
        edge_.to_m = {0.0, 0.6};
        edge_.upper_m = 0.0;
        edge_.lower_m = -0.1;
        disparity_px_.resize(672, 376);
        for (int v = 0; v < 376; ++v)
            for (int u = 0; u < 672; ++u) disparity_px_.at(u, v) = seen(treads, u, v);
    }
    void add_noise(double sigma_px, std::uint64_t seed) {
        Rng rng(seed);
        for (std::size_t i = 0; i < disparity_px_.size(); ++i)
            disparity_px_.data()[i] += static_cast<float>(sigma_px * rng.normal());
    }
    [[nodiscard]] Terrain terrain() const {
        Terrain terrain;
        terrain.view = view_;
        terrain.disparity_px = disparity_px_.view();
        return terrain;
    }
    static constexpr double kCamera_m = 1.0;
    static constexpr double kBoard_m = 0.04;
    Edge edge_;
    View view_;
    Image<float> disparity_px_;

  private:
    bool open_;  ///< steps up are boards: the floor is visible below them

    [[nodiscard]] float seen(const std::vector<Tread>& treads, int u, int v) const {
        const Vector3d ray =
            view_.T_map_camera.rotation *
            Vector3d((u - view_.cx_px) / view_.fx_px, (v - view_.cy_px) / view_.fy_px, 1.0);
        if (!(ray.z() < 0.0)) return std::numeric_limits<float>::quiet_NaN();
        const double camera_x_m = view_.T_map_camera.translation_m.x();
        double depth_m = 0.0;
        double z_m = 0.0;
        for (std::size_t k = 0; k <= treads.size(); ++k) {
            z_m = (kCamera_m + depth_m) / -ray.z();
            if (k == treads.size() || camera_x_m + z_m * ray.x() < treads[k].behind_m) break;
            depth_m = treads[k].depth_m;
            const double face_m = (treads[k].behind_m - camera_x_m) / ray.x();
            const double below_m = -face_m * ray.z() - kCamera_m - depth_m;
            if (below_m > 0.0) {  // the step leads up, and its face hides the ground behind
                z_m = open_ && below_m > kBoard_m ? kCamera_m / -ray.z() : face_m;
                break;
            }
        }
        return static_cast<float>(view_.fx_px * view_.baseline_m / z_m);
    }
};

}  // namespace surefoot::stairs::testing
