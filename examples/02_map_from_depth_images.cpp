// SPDX-License-Identifier: Apache-2.0
// Builds an elevation map from depth images and poses that another program measured, without the
// stereo and odometry of Surefoot. A computed view of a level floor replaces your camera.
#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <numbers>
#include <vector>

#include "surefoot/elevation/elevation_map.hpp"

using namespace surefoot;

/// One depth image as points of the camera's optical frame (z forward, x right, y down), with the
/// variance of your camera along the ray: here (1 mm + 0.5 % of the range)^2.
std::vector<elevation::MeasuredPoint> points_of(float floor_below_camera_m) {
    std::vector<elevation::MeasuredPoint> points;
    for (float v = 0.1F; v < 0.9F; v += 0.01F) {
        for (float u = -0.6F; u < 0.6F; u += 0.01F) {
            const float z_m = floor_below_camera_m / v;  // the pixel (u, v) at focal length 1
            const float sigma_m = 0.001F + 0.005F * z_m;
            points.push_back({{u * z_m, v * z_m, z_m}, sigma_m * sigma_m, 1e-6F});
        }
    }
    return points;
}

int main() {
    elevation::ElevationConfig config;  // cells of 25 mm
    elevation::ElevationMap map(config);

    // The camera looks ahead, 0.9 m above base_link's ground; base_link is on the ground here.
    Pose T_body_camera = T_body_optical();
    T_body_camera.translation_m = {0.0, 0.0, 0.9};
    for (int frame = 0; frame < 10; ++frame) {
        Pose T_odom_body;  // your pose: 2 cm of motion per frame
        T_odom_body.translation_m.x() = 0.02 * frame;
        const Matrix6 covariance = 1e-8 * Matrix6::Identity();  // motion since the last frame
        map.follow(T_odom_body, covariance);
        const std::int64_t time_ns = frame * 33'000'000LL;
        map.add_points(points_of(0.9F), T_body_camera, T_odom_body, time_ns);
    }
    const auto cell = map.geometry().cell_at(1.5, 0.0);
    if (!cell) return 1;
    std::cout << map.known_cells() << " cells known; the ground 1.5 m ahead is at "
              << map.layers().height_m.at(cell->ix, cell->iy) << " m, sigma "
              << std::sqrt(map.layers().height_var_m2.at(cell->ix, cell->iy)) << " m\n";
}
