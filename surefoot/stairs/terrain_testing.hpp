// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs::testing {

/// Height of the ground at a point of the world; NaN = no ground.
using Ground = std::function<double(double x_m, double y_m)>;

/// Steps along +x between y = -width/2 and width/2. The first edge is at x = 0, the floor before it
/// at z = 0. Beside the steps the ground stays at z = 0.
struct TestFlight {
    int steps = 4;
    double riser_m = 0.18;  ///< negative: steps down
    double going_m = 0.31;
    double width_m = 1.2;
    double first_riser_m = 0.0;  ///< 0 = like the other risers

    [[nodiscard]] double at(double x_m, double y_m) const {
        if (std::abs(y_m) > 0.5 * width_m || x_m < 0.0) return 0.0;
        const double first_m = first_riser_m != 0.0 ? first_riser_m : riser_m;
        const int step = std::min(steps - 1, static_cast<int>(std::floor(x_m / going_m)));
        return first_m + step * riser_m;
    }
};

/// A map of `ground`, rotated about (0, 0) by `yaw_rad` and moved by `shift_m`. Each cell holds the
/// highest point of its area.
class TestMap {
  public:
    TestMap(const Ground& ground,
            double yaw_rad,
            const Eigen::Vector2d& shift_m,
            double resolution_m = 0.025,
            double side_m = 5.0)
        : yaw_rad_(yaw_rad), shift_m_(shift_m) {
        const int cells = static_cast<int>(std::lround(side_m / resolution_m));
        geometry.resolution_m = resolution_m;
        geometry.nx = geometry.ny = cells;
        geometry.origin_m = Eigen::Vector2d::Constant(-0.5 * cells * resolution_m);
        height_m = grid::Layer(cells, cells, 0.0F);
        var_m2 = grid::Layer(cells, cells, 0.0F);
        constexpr int kSamples = 7;
        for (int iy = 0; iy < cells; ++iy) {
            for (int ix = 0; ix < cells; ++ix) {
                double highest_m = -std::numeric_limits<double>::infinity();
                for (int k = 0; k < kSamples * kSamples; ++k) {
                    const Eigen::Vector2d within(k % kSamples, k / kSamples);
                    const Eigen::Vector2d p_m =
                        geometry.origin_m +
                        resolution_m * (Eigen::Vector2d(ix, iy) + within / (kSamples - 1.0));
                    const Eigen::Vector2d q_m = to_world(p_m);
                    highest_m = std::max(highest_m, ground(q_m.x(), q_m.y()));
                }
                height_m.at(ix, iy) = static_cast<float>(highest_m);
            }
        }
    }

    void add_noise(double sigma_m, std::uint64_t seed) {
        Rng rng(seed);
        for (std::size_t i = 0; i < height_m.size(); ++i)
            height_m.data()[i] += static_cast<float>(sigma_m * rng.normal());
        var_m2.fill(static_cast<float>(sigma_m * sigma_m));
    }
    /// Makes cells unknown that the ground before them hides from a camera.
    void hide_from(const Eigen::Vector3d& camera_world_m) {
        const Eigen::Vector2d camera_m = to_map(camera_world_m.head<2>());
        const grid::Layer seen = height_m;
        for (int iy = 0; iy < geometry.ny; ++iy) {
            for (int ix = 0; ix < geometry.nx; ++ix) {
                const Eigen::Vector2d p_m = geometry.center_m({ix, iy});
                const double z_m = static_cast<double>(seen.at(ix, iy));
                const double distance_m = (p_m - camera_m).norm();
                for (double s_m = geometry.resolution_m; s_m < distance_m;
                     s_m += 0.5 * geometry.resolution_m) {
                    const double share = s_m / distance_m;
                    const Eigen::Vector2d q_m = p_m + share * (camera_m - p_m);
                    const auto cell = geometry.cell_at(q_m.x(), q_m.y());
                    if (!cell || *cell == grid::Cell{ix, iy}) continue;
                    const double line_m = z_m + share * (camera_world_m.z() - z_m);
                    if (static_cast<double>(seen.at(cell->ix, cell->iy)) > line_m + 1e-6) {
                        height_m.at(ix, iy) = std::numeric_limits<float>::quiet_NaN();
                        break;
                    }
                }
            }
        }
    }
    [[nodiscard]] Eigen::Vector2d to_map(const Eigen::Vector2d& world_m) const {
        return Eigen::Rotation2Dd(yaw_rad_) * world_m + shift_m_;
    }
    [[nodiscard]] Eigen::Vector2d to_world(const Eigen::Vector2d& map_m) const {
        return Eigen::Rotation2Dd(-yaw_rad_) * (map_m - shift_m_);
    }
    /// `stance_m` is in the world frame.
    [[nodiscard]] Terrain terrain(const Eigen::Vector2d& stance_m = {-1.0, 0.0}) const {
        Terrain terrain;
        terrain.geometry = geometry;
        terrain.height_m = height_m.view();
        terrain.height_var_m2 = var_m2.view();
        terrain.stance_m = to_map(stance_m);
        return terrain;
    }

    grid::GridGeometry geometry;
    grid::Layer height_m;
    grid::Layer var_m2;

  private:
    double yaw_rad_;
    Eigen::Vector2d shift_m_;
};

}  // namespace surefoot::stairs::testing
