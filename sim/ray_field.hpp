// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "surefoot/camera/camera_model.hpp"

namespace surefoot::sim {

/// The viewing ray of every pixel of a camera, computed once by its lens model, and the cone round
/// each block of pixels, with which whole primitives are skipped.
class RayField {
  public:
    static constexpr int kBlock = 16;  ///< pixels, both directions

    /// Cone in the optical frame that holds every ray of a block.
    struct Cone {
        Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
        double half_angle_rad = 0.0;
        bool empty = true;  ///< no pixel of the block has a ray
    };

    explicit RayField(const camera::Camera& camera);

    [[nodiscard]] int width() const noexcept { return width_; }
    [[nodiscard]] int height() const noexcept { return height_; }
    [[nodiscard]] int blocks_x() const noexcept { return (width_ + kBlock - 1) / kBlock; }
    [[nodiscard]] int blocks_y() const noexcept { return (height_ + kBlock - 1) / kBlock; }
    /// Unit ray in the optical frame; NaN where the lens has none.
    [[nodiscard]] const Eigen::Vector3d& ray(int u, int v) const noexcept {
        return rays_[index(u, v)];
    }
    /// Angle between the rays of neighbouring pixels.
    [[nodiscard]] double pixel_angle_rad(int u, int v) const noexcept {
        return static_cast<double>(pixel_angle_rad_[index(u, v)]);
    }
    /// Ray of a place inside a pixel, offsets in pixels; NaN where a neighbour has none.
    [[nodiscard]] Eigen::Vector3d ray_within(int u, int v, double du_px, double dv_px) const;
    [[nodiscard]] const Cone& cone(int block_x, int block_y) const noexcept {
        return cones_[static_cast<std::size_t>(block_y * blocks_x() + block_x)];
    }

  private:
    [[nodiscard]] std::size_t index(int u, int v) const noexcept {
        return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(u);
    }
    [[nodiscard]] Eigen::Vector3d step_u(int u, int v) const;
    [[nodiscard]] Eigen::Vector3d step_v(int u, int v) const;
    [[nodiscard]] Cone enclosing(int block_x, int block_y) const;

    int width_ = 0;
    int height_ = 0;
    std::vector<Eigen::Vector3d> rays_;
    std::vector<float> pixel_angle_rad_;
    std::vector<Cone> cones_;
};

}  // namespace surefoot::sim
