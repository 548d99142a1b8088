// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstring>
#include <vector>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/sim/scenes/scene.hpp"

/// Small scenes and executors for the tests of the sensors.
namespace surefoot::sim::test {

/// Camera pose at (0, 0, height), level, facing world +x: optical x = -y of the world.
inline Pose level_camera(double height_m = 1.0) {
    Pose T = T_body_optical();
    T.translation_m = {0.0, 0.0, height_m};
    return T;
}

inline Scene floor_only(const Material& material = {}) {
    Scene scene;
    const int carpet = scene.add_material(material);
    scene.add_floor(Floor({{-50.0, -50.0}, {50.0, 50.0}}, 0.0), carpet, carpet);
    return scene;
}

/// Upright wall across +x, 20 m wide, from -5 to 7 m.
inline Scene wall_ahead(double distance_m, const Material& material = {}) {
    Scene scene;
    scene.add(make_box({distance_m + 0.5, 0.0}, {1.0, 20.0}, -5.0, 7.0),
              scene.add_material(material),
              Label::wall);
    return scene;
}

/// A thin plate `width_m` wide in front of a wall, its front face at `plate_m`.
inline Scene plate_before_wall(double plate_m, double wall_m, double width_m) {
    Scene scene = wall_ahead(wall_m);
    scene.add(make_box({plate_m + 0.001, 0.0}, {0.002, width_m}, 0.0, 3.0), 0, Label::object);
    return scene;
}

/// Floor with a drop: height 0 up to `edge_m`, lower beyond.
inline Scene drop_ahead(double edge_m, double drop_m) {
    Scene scene;
    const int carpet = scene.add_material({});
    scene.add_floor(Floor({{-50.0, -50.0}, {50.0, 50.0}}, -drop_m), carpet, carpet);
    scene.add(
        make_box({edge_m - 10.0, 0.0}, {20.0, 40.0}, -drop_m - 0.5, 0.0), carpet, Label::floor);
    return scene;
}

inline Scene scene_with_box() {
    Scene scene = floor_only();
    scene.add(make_box({1.6, 0.1}, {0.4, 0.5}, 0.0, 0.3, 0.4), 0, Label::object);
    return scene;
}

/// Whether both images are equal; two NaN values count as equal.
inline bool same_bytes(const Image<float>& a, const Image<float>& b) {
    return a.width() == b.width() && a.height() == b.height() &&
           std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

}  // namespace surefoot::sim::test
