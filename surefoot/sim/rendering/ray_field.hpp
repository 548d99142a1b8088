// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "surefoot/camera/camera_model.hpp"

namespace surefoot::sim {

/// The viewing ray of every pixel of a camera, computed once from its lens model. A bounding cone
/// of each pixel block lets the caster skip whole primitives.
class RayField {
  public:
    static constexpr int kBlock = 16;  ///< side of a square block [px]

    /// Cone in the optical frame that contains every ray of a block.
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
    /// Unit ray in the optical frame; NaN if the lens model has no ray there.
    [[nodiscard]] Eigen::Vector3d ray(int u, int v) const noexcept {
        const std::size_t i = index(u, v);
        return {x_[i], y_[i], z_[i]};
    }
    /// Rays of all pixels of a block, row by row; a row has as many rays as the block is wide.
    struct BlockRays {
        const double* x;
        const double* y;
        const double* z;
        const float* pixel_angle_rad;
    };
    [[nodiscard]] BlockRays block(int block_x, int block_y) const noexcept {
        const std::size_t i = index(block_x * kBlock, block_y * kBlock);
        return {&x_[i], &y_[i], &z_[i], &pixel_angle_rad_[i]};
    }
    /// Angle between the rays of neighbouring pixels.
    [[nodiscard]] double pixel_angle_rad(int u, int v) const noexcept {
        return static_cast<double>(pixel_angle_rad_[index(u, v)]);
    }
    /// Ray of a sub-pixel position, offsets in px; may be NaN if a neighbouring pixel has no ray.
    [[nodiscard]] Eigen::Vector3d ray_within(int u, int v, double du_px, double dv_px) const;
    [[nodiscard]] const Cone& cone(int block_x, int block_y) const noexcept {
        return cones_[static_cast<std::size_t>(block_y * blocks_x() + block_x)];
    }

  private:
    /// Index of a pixel; the blocks are stored one after another.
    [[nodiscard]] std::size_t index(int u, int v) const noexcept {
        const int u0 = u / kBlock * kBlock;
        const int v0 = v / kBlock * kBlock;
        const int block_width = std::min(kBlock, width_ - u0);
        const int block_height = std::min(kBlock, height_ - v0);
        return static_cast<std::size_t>(v0) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(u0 * block_height + (v - v0) * block_width + (u - u0));
    }
    [[nodiscard]] Eigen::Vector3d step_u(int u, int v) const;
    [[nodiscard]] Eigen::Vector3d step_v(int u, int v) const;
    [[nodiscard]] Cone enclosing(int block_x, int block_y) const;

    int width_ = 0;
    int height_ = 0;
    std::vector<double> x_;
    std::vector<double> y_;
    std::vector<double> z_;
    std::vector<float> pixel_angle_rad_;
    std::vector<Cone> cones_;
};

}  // namespace surefoot::sim
