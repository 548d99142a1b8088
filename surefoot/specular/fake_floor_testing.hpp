// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::specular::testing {

/// Grey value of a level floor at a position in odom [m].
using FakeFloor = std::function<double(double x_m, double y_m)>;

/// A number between 0 and 1 for each lattice point, the same for the same seed.
inline double lattice_value(std::int64_t i, std::int64_t j, std::uint64_t seed) {
    const std::uint64_t mixed =
        mix_seed(mix_seed(seed, static_cast<std::uint64_t>(i)), static_cast<std::uint64_t>(j));
    return static_cast<double>(mixed >> 11U) * 0x1p-53;
}

/// Irregular blotches of two sizes, between grey 60 and 180.
inline FakeFloor carpet(std::uint64_t seed) {
    return [seed](double x_m, double y_m) {
        double grey = 60.0;
        for (const double size_m : {0.012, 0.05}) {
            const double x = x_m / size_m;
            const double y = y_m / size_m;
            const auto i = static_cast<std::int64_t>(std::floor(x));
            const auto j = static_cast<std::int64_t>(std::floor(y));
            const double a = x - std::floor(x);
            const double b = y - std::floor(y);
            const double low =
                lattice_value(i, j, seed) * (1.0 - a) + lattice_value(i + 1, j, seed) * a;
            const double high =
                lattice_value(i, j + 1, seed) * (1.0 - a) + lattice_value(i + 1, j + 1, seed) * a;
            grey += 60.0 * (low * (1.0 - b) + high * b);
        }
        return grey;
    };
}

/// A carpet in square tiles with dark joints; all tiles are equal or each has its own pattern.
inline FakeFloor tiles(std::uint64_t seed, double side_m, bool alike) {
    return [seed, side_m, alike, one = carpet(seed)](double x_m, double y_m) {
        const double i = std::floor(x_m / side_m);
        const double j = std::floor(y_m / side_m);
        const double x = x_m - i * side_m;
        const double y = y_m - j * side_m;
        if (x < 0.006 || y < 0.006) return 30.0;
        return alike ? one(x, y) : one(x_m, y_m);
    };
}

/// Bright and dark stripes across the walking direction, over a carpet.
inline FakeFloor stripes(std::uint64_t seed, double width_m) {
    return [width_m, floor = carpet(seed)](double x_m, double y_m) {
        const double x = x_m / (2.0 * width_m);
        return floor(x_m, y_m) * (x - std::floor(x) < 0.5 ? 1.0 : 0.5);
    };
}

/// An upright mirror on a floor: normal (cos, sin) . p = offset. Its reflection appears behind the
/// line. `share`: reflected part of the light; the rest comes from the floor behind, as in glass.
inline FakeFloor with_mirror(FakeFloor floor, double angle_rad, double offset_m, double share) {
    const double nx = std::cos(angle_rad);
    const double ny = std::sin(angle_rad);
    return [=](double x_m, double y_m) {
        const double behind_m = nx * x_m + ny * y_m - offset_m;
        if (behind_m <= 0.0) return floor(x_m, y_m);
        const double reflected = floor(x_m - 2.0 * behind_m * nx, y_m - 2.0 * behind_m * ny);
        return share * reflected + (1.0 - share) * floor(x_m, y_m);
    };
}

/// A camera at base_link that looks 32 deg down; `fake_body` is 1 m above the floor.
inline camera::RectifiedRig fake_rig() {
    camera::RectifiedRig rig{480, 300, 260.0, 260.0, 240.0, 150.0, 0.12, {}};
    rig.T_body_camera = T_body_optical();
    const Eigen::Quaterniond down(
        Eigen::AngleAxisd(32.0 * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY()));
    rig.T_body_camera.rotation = down * rig.T_body_camera.rotation;
    return rig;
}

/// base_link 1 m above the floor z = 0, level.
inline Pose fake_body(double x_m, double y_m, double yaw_rad = 0.0) {
    Pose T_odom_body;
    T_odom_body.rotation = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
    T_odom_body.translation_m = {x_m, y_m, 1.0};
    return T_odom_body;
}

struct FakeView {
    GreyImage left;
    Image<float> disparity_px;
};

/// Image of the floor z = 0 with a few grey values of noise, and its disparity. No disparity above
/// the horizon.
inline FakeView look_at(const FakeFloor& floor,
                        const camera::RectifiedRig& rig,
                        const Pose& T_odom_body,
                        Rng& rng,
                        double noise = 2.0) {
    FakeView view{GreyImage(rig.width, rig.height),
                  Image<float>(rig.width, rig.height, std::nanf(""))};
    const Pose T_odom_camera = T_odom_body * rig.T_body_camera;
    const Eigen::Vector3d& from_m = T_odom_camera.translation_m;
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const Eigen::Vector3d ray =
                T_odom_camera.rotation *
                Eigen::Vector3d((u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0);
            if (!(ray.z() < -0.05)) continue;
            const double depth_m = -from_m.z() / ray.z();
            const Eigen::Vector3d at_m = from_m + depth_m * ray;
            const double grey = floor(at_m.x(), at_m.y()) + noise * rng.normal();
            view.left.at(u, v) = static_cast<std::uint8_t>(std::clamp(grey, 0.0, 255.0));
            view.disparity_px.at(u, v) =
                static_cast<float>(rig.depth_to_disparity_px_m() / depth_m);
        }
    }
    return view;
}

}  // namespace surefoot::specular::testing
