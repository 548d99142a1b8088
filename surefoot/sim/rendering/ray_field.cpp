// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/ray_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::sim {

using Eigen::Vector3d;

RayField::RayField(const camera::Camera& camera) : width_(camera.width), height_(camera.height) {
    const Vector3d none = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    for (auto* coordinate : {&x_, &y_, &z_}) coordinate->resize(pixels);
    for (int v = 0; v < height_; ++v) {
        for (int u = 0; u < width_; ++u) {
            const Vector3d ray = camera::unproject(camera.model, {u, v}).value_or(none);
            x_[index(u, v)] = ray.x();
            y_[index(u, v)] = ray.y();
            z_[index(u, v)] = ray.z();
        }
    }
    pixel_angle_rad_.resize(pixels);
    for (int v = 0; v < height_; ++v) {
        for (int u = 0; u < width_; ++u) {
            const double angle_rad = std::sqrt(step_u(u, v).norm() * step_v(u, v).norm());
            // Next to the rim of a fisheye image a neighbouring pixel has no ray.
            pixel_angle_rad_[index(u, v)] =
                static_cast<float>(std::isfinite(angle_rad) ? angle_rad : 1.0 / width_);
        }
    }
    for (int y = 0; y < blocks_y(); ++y) {
        for (int x = 0; x < blocks_x(); ++x) cones_.push_back(enclosing(x, y));
    }
}

Vector3d RayField::step_u(int u, int v) const {
    const int last = width_ - 1;
    return u < last ? Vector3d(ray(u + 1, v) - ray(u, v))
                    : Vector3d(ray(u, v) - ray(std::max(u - 1, 0), v));
}

Vector3d RayField::step_v(int u, int v) const {
    const int last = height_ - 1;
    return v < last ? Vector3d(ray(u, v + 1) - ray(u, v))
                    : Vector3d(ray(u, v) - ray(u, std::max(v - 1, 0)));
}

Vector3d RayField::ray_within(int u, int v, double du_px, double dv_px) const {
    return (ray(u, v) + du_px * step_u(u, v) + dv_px * step_v(u, v)).normalized();
}

RayField::Cone RayField::enclosing(int block_x, int block_y) const {
    const int u_end = std::min((block_x + 1) * kBlock, width_);
    const int v_end = std::min((block_y + 1) * kBlock, height_);
    Cone cone;
    Vector3d sum = Vector3d::Zero();
    for (int v = block_y * kBlock; v < v_end; ++v) {
        for (int u = block_x * kBlock; u < u_end; ++u) {
            if (ray(u, v).allFinite()) sum += ray(u, v);
        }
    }
    if (!(sum.norm() > 0.0)) return cone;
    cone.axis = sum.normalized();
    double smallest_cos = 1.0;
    for (int v = block_y * kBlock; v < v_end; ++v) {
        for (int u = block_x * kBlock; u < u_end; ++u) {
            if (ray(u, v).allFinite())
                smallest_cos = std::min(smallest_cos, cone.axis.dot(ray(u, v)));
        }
    }
    constexpr double kMargin_rad = 1e-6;  // margin for the rounding of the cosine near 1
    cone.half_angle_rad = std::acos(std::clamp(smallest_cos, -1.0, 1.0)) + kMargin_rad;
    cone.empty = false;
    return cone;
}

}  // namespace surefoot::sim
