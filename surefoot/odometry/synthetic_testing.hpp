// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::odometry::testing {

/// A rectified ZED at 672x376; the camera frame is the body frame.
inline camera::RectifiedRig rectified_rig() {
    camera::RectifiedRig rig;
    rig.width = 672;
    rig.height = 376;
    rig.fx_px = rig.fy_px = 350.0;
    rig.cx_px = 336.0;
    rig.cy_px = 188.0;
    rig.baseline_m = 0.12;
    return rig;
}

/// Random numbers in [0, 1) on a lattice that repeats every 256 steps.
class Lattice {
  public:
    explicit Lattice(std::uint64_t seed) {
        Rng rng(seed);
        for (float& value : values_) value = static_cast<float>(rng.uniform());
    }
    [[nodiscard]] double at(int i, int j) const {
        return static_cast<double>(values_[static_cast<std::size_t>((i & 255) * 256 + (j & 255))]);
    }

  private:
    std::vector<float> values_ = std::vector<float>(256 * 256);
};

/// Smooth random grey value of a surface: three octaves of value noise.
inline double texture_grey(int surface, double a, double b) {
    static const std::array<Lattice, 3> lattices{Lattice(1), Lattice(2), Lattice(3)};
    const Lattice& lattice = lattices[static_cast<std::size_t>(surface)];
    double grey = 0.0;
    double amplitude = 120.0;
    for (double scale = 12.0; scale < 100.0; scale *= 2.5, amplitude *= 0.6) {
        const double x = a * scale;
        const double y = b * scale;
        const int i = static_cast<int>(std::floor(x));
        const int j = static_cast<int>(std::floor(y));
        const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
        const double s = smooth(x - i);
        const double t = smooth(y - j);
        grey += amplitude * ((lattice.at(i, j) * (1.0 - s) + lattice.at(i + 1, j) * s) * (1.0 - t) +
                             (lattice.at(i, j + 1) * (1.0 - s) + lattice.at(i + 1, j + 1) * s) * t);
    }
    return std::clamp(grey, 0.0, 255.0);
}

/// A wall 3 m ahead, a floor 0.8 m below and a side wall 1.2 m to the right of the start pose, in
/// optical axes (x right, y down, z forward). Returns the depth along the ray, or infinity.
inline double cast_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, double& grey) {
    const Eigen::Vector3d limit(1.2, 0.8, 3.0);
    double best = std::numeric_limits<double>::infinity();
    int axis_hit = -1;
    for (int axis = 0; axis < 3; ++axis) {
        const double along = (limit[axis] - origin[axis]) / ray[axis];
        if (ray[axis] > 0.0 && along < best) {
            best = along;
            axis_hit = axis;
        }
    }
    grey = 0.0;
    if (axis_hit < 0) return best;
    const Eigen::Vector3d hit = origin + best * ray;
    grey = texture_grey(axis_hit, hit[(axis_hit + 1) % 3], hit[(axis_hit + 2) % 3]);
    return best;
}

inline camera::StereoRig small_rig() {
    camera::PinholeRadTan lens;
    lens.fx_px = lens.fy_px = 220.0;
    lens.cx_px = 175.0;
    lens.cy_px = 110.0;
    lens.k1 = -0.12;
    lens.k2 = 0.02;
    camera::StereoRig rig;
    rig.left = {lens, 352, 224};
    lens.cx_px = 178.0;
    rig.right = camera::Camera{lens, 352, 224};
    rig.T_left_right = {exp_so3({0.002, -0.004, 0.003}), {0.12, 0.001, -0.002}};
    return rig;
}

inline camera::StereoRig small_depth_rig() {
    camera::StereoRig rig = small_rig();
    rig.right.reset();
    return rig;
}

/// Unit rays of all pixels, row by row; computed once per lens.
inline const std::vector<Eigen::Vector3d>& rays_of(const camera::Camera& camera) {
    static std::vector<std::pair<double, std::vector<Eigen::Vector3d>>> cache;  // by cx
    const double key = std::get<camera::PinholeRadTan>(camera.model).cx_px;
    for (const auto& [cx, rays] : cache)
        if (cx == key) return rays;
    std::vector<Eigen::Vector3d> rays;
    for (int v = 0; v < camera.height; ++v)
        for (int u = 0; u < camera.width; ++u)
            rays.push_back(*camera::unproject(camera.model, Eigen::Vector2d(u, v)));
    cache.emplace_back(key, std::move(rays));
    return cache.back().second;
}

/// Renders an image with one camera pose per row; fills `depth_m` (along z), if given.
template <typename PoseOfRow>
GreyImage render_rows(const camera::Camera& camera,
                      const PoseOfRow& T_world_camera_at_row,
                      double noise_grey,
                      Rng& rng,
                      Image<float>* depth_m = nullptr) {
    const auto& rays = rays_of(camera);
    GreyImage image(camera.width, camera.height);
    if (depth_m != nullptr) *depth_m = Image<float>(camera.width, camera.height);
    for (int v = 0; v < camera.height; ++v) {
        const Pose T_world_camera = T_world_camera_at_row(v);
        const Eigen::Matrix3d R = T_world_camera.R();
        for (int u = 0; u < camera.width; ++u) {
            const Eigen::Vector3d& ray = rays[static_cast<std::size_t>(v * camera.width + u)];
            double grey = 0.0;
            const double along = cast_ray(T_world_camera.translation_m, R * ray, grey);
            if (noise_grey > 0.0) grey += noise_grey * rng.normal();
            image.at(u, v) = static_cast<std::uint8_t>(std::clamp(grey + 0.5, 0.0, 255.0));
            if (depth_m != nullptr)
                depth_m->at(u, v) = std::isfinite(along) ? static_cast<float>(along * ray.z())
                                                         : std::numeric_limits<float>::quiet_NaN();
        }
    }
    return image;
}

inline GreyImage render_camera(const camera::Camera& camera,
                               const Pose& T_world_camera,
                               double noise_grey,
                               Rng& rng,
                               Image<float>* depth_m = nullptr) {
    return render_rows(
        camera, [&](int) { return T_world_camera; }, noise_grey, rng, depth_m);
}

/// Frame of the rig at a pose of its left camera.
inline StereoFrame render_frame(const camera::StereoRig& rig,
                                const Pose& T_world_left,
                                int index,
                                double noise_grey) {
    Rng rng(mix_seed(99, static_cast<std::uint64_t>(index)));
    StereoFrame frame;
    frame.index = index;
    frame.time_ns = 1'000'000'000LL + index * 50'000'000LL;
    if (rig.right) {
        frame.left = render_camera(rig.left, T_world_left, noise_grey, rng);
        frame.right = render_camera(*rig.right, T_world_left * rig.T_left_right, noise_grey, rng);
    } else {
        frame.left = render_camera(rig.left, T_world_left, noise_grey, rng, &frame.depth_m);
    }
    return frame;
}

/// Frame of a rig with a rolling shutter. `T_world_left_at` gives the pose for a time [s] after the
/// stamp. The middle row is exposed at the stamp.
template <typename PoseAt>
StereoFrame render_rolling_frame(const camera::StereoRig& rig,
                                 const PoseAt& T_world_left_at,
                                 int index,
                                 double noise_grey) {
    const auto at_row = [&](int v) {
        return T_world_left_at(rig.readout_s * (v + 0.5 - 0.5 * rig.left.height) / rig.left.height);
    };
    Rng rng(mix_seed(99, static_cast<std::uint64_t>(index)));
    StereoFrame frame;
    frame.index = index;
    frame.time_ns = 1'000'000'000LL + index * 50'000'000LL;
    frame.left = render_rows(rig.left, at_row, noise_grey, rng);
    frame.right = render_rows(
        *rig.right, [&](int v) { return at_row(v) * rig.T_left_right; }, noise_grey, rng);
    return frame;
}

}  // namespace surefoot::odometry::testing
