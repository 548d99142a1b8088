// SPDX-License-Identifier: Apache-2.0
// Builds an elevation map from depth images and poses that another program measured. Surefoot then
// needs no stereo and no odometry. Replace `image_of_floor` by your camera, and the pose in `main`
// by yours.
#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <limits>
#include <vector>

#include "surefoot/core/angles.hpp"
#include "surefoot/elevation/elevation_map.hpp"

using namespace surefoot;

/// Row by row from the top left pixel: metres along the optical axis, NaN = unknown.
struct MetricImage {
    int width = 320;
    int height = 240;
    float fx_px = 260.0F, fy_px = 260.0F, cx_px = 159.5F, cy_px = 119.5F;  // your calibration
    std::vector<float> depth_m;
};

/// Each known pixel as a point of the optical frame (x right, y down, z forward). The variances are
/// those of the sensor: `along_var_m2` along the ray, `lateral_var_m2` across the ray.
std::vector<elevation::MeasuredPoint> points_of(const MetricImage& image) {
    std::vector<elevation::MeasuredPoint> points;
    for (int v = 0; v < image.height; ++v) {
        for (int u = 0; u < image.width; ++u) {
            const float z_m = image.depth_m[static_cast<std::size_t>(v * image.width + u)];
            if (!std::isfinite(z_m)) continue;
            const float x_m = (static_cast<float>(u) - image.cx_px) / image.fx_px * z_m;
            const float y_m = (static_cast<float>(v) - image.cy_px) / image.fy_px * z_m;
            const float along_m = 0.001F + 0.005F * z_m;       // your sensor: 1 mm + 0.5 %
            const float lateral_m = 0.3F * z_m / image.fx_px;  // 0.3 px: rounding to a pixel
            points.push_back({{x_m, y_m, z_m}, along_m * along_m, lateral_m * lateral_m});
        }
    }
    return points;
}

/// Stands for your camera: what it sees of a level floor at z = 0 of base_link.
MetricImage image_of_floor(const Pose& T_body_camera) {
    MetricImage image;
    for (int v = 0; v < image.height; ++v)
        for (int u = 0; u < image.width; ++u) {
            const Eigen::Vector3d ray((u - double{image.cx_px}) / double{image.fx_px},
                                      (v - double{image.cy_px}) / double{image.fy_px},
                                      1.0);
            const double z_m =
                -T_body_camera.translation_m.z() / (T_body_camera.rotation * ray).z();
            image.depth_m.push_back(z_m > 0.0 ? static_cast<float>(z_m)
                                              : std::numeric_limits<float>::quiet_NaN());
        }
    return image;
}

int main() {
    elevation::ElevationMap map(elevation::ElevationConfig{});  // cells of 25 mm

    // The camera sits 0.9 m above base_link and looks 30 deg down. T_body_optical() turns the axes
    // of an image (z forward) into the axes of base_link (x forward, z up).
    Pose T_body_camera = T_body_optical();
    T_body_camera.rotation =
        Eigen::AngleAxisd(30.0 * kRadPerDeg, Eigen::Vector3d::UnitY()) * T_body_camera.rotation;
    T_body_camera.translation_m.z() = 0.9;
    for (int frame = 0; frame < 10; ++frame) {
        Pose T_odom_body;  // your pose: 2 cm of motion per frame
        T_odom_body.translation_m.x() = 0.02 * frame;
        const Matrix6 covariance = 1e-8 * Matrix6::Identity();  // motion since the last frame
        map.follow(T_odom_body, covariance);
        const std::int64_t time_ns = frame * 33'000'000LL;
        map.add_points(
            points_of(image_of_floor(T_body_camera)), T_body_camera, T_odom_body, time_ns);
    }
    const auto cell = map.geometry().cell_at(1.5, 0.0);
    if (!cell) return 1;
    std::cout << map.known_cells() << " cells known; the ground 1.5 m ahead is at "
              << map.layers().height_m.at(cell->ix, cell->iy) << " m, sigma "
              << std::sqrt(map.layers().height_var_m2.at(cell->ix, cell->iy)) << " m\n";
}
