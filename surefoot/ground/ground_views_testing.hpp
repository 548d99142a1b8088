// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/ground/sample_points.hpp"

/// Depth images of boxes on a floor for any camera mount, with the errors of a real matcher. Shared
/// by the unit tests and lab/ground_search/main.cpp.
namespace surefoot::ground::test {

/// Upright block, rotated about the vertical.
struct Block {
    Eigen::Vector3d middle_m;  ///< world, z up
    Eigen::Vector3d size_m;
    double yaw_rad = 0.0;
};

/// Smooth noise: normal random numbers on a lattice with bilinear interpolation.
class Lattice {
  public:
    explicit Lattice(std::uint64_t seed) : seed_(seed) {}
    [[nodiscard]] double at(double x, double y) const {
        const double fx = std::floor(x);
        const double fy = std::floor(y);
        const auto corner = [&](double dx, double dy) {
            const auto ix = static_cast<std::uint64_t>(static_cast<std::int64_t>(fx + dx));
            const auto iy = static_cast<std::uint64_t>(static_cast<std::int64_t>(fy + dy));
            Rng rng(mix_seed(mix_seed(seed_, ix), iy));
            return rng.normal();
        };
        const double u = x - fx;
        const double v = y - fy;
        return (1.0 - v) * ((1.0 - u) * corner(0, 0) + u * corner(1, 0)) +
               v * ((1.0 - u) * corner(0, 1) + u * corner(1, 1));
    }

  private:
    std::uint64_t seed_;
};

struct Camera {
    int width = 640;
    int height = 480;
    double focal_px = 400.0;
    double baseline_m = 0.1;
    double height_m = 1.0;    ///< above world z = 0
    double pitch_deg = 30.0;  ///< below the horizon
    double roll_deg = 0.0;
};

/// Errors of the simulated disparities.
struct Errors {
    double white_px = 0.15;        ///< independent for each pixel
    double together_px = 0.15;     ///< correlated over about 40 px
    double calibration_px = 0.05;  ///< constant, and growing toward the image border
    double matched_share = 0.8;    ///< share of the pixels with a match, in patches
    double wrong_share = 0.01;     ///< share of the matches with a random disparity
    double relief_m = 0.0;         ///< roughness of the floor, over about 0.15 m
};

struct View {
    FramePoints seen;
    double floor_share = 0.0;  ///< share of the image that shows the floor, matched or not
    Eigen::Vector3d up =
        Eigen::Vector3d::UnitZ();  ///< in camera body axes: x along the optical axis
};

/// Depth along the optical axis of the nearest block on a ray, or of the floor z = 0 if there is
/// one. Infinity if the ray hits nothing.
struct Hit {
    double depth_m = std::numeric_limits<double>::infinity();
    bool is_floor = false;
};

inline Hit cast(const std::vector<Block>& blocks,
                bool has_floor,
                const Eigen::Vector3d& from_m,
                const Eigen::Vector3d& ray) {
    Hit hit;
    if (has_floor && ray.z() < 0.0) hit = {-from_m.z() / ray.z(), true};
    for (const Block& block : blocks) {
        const Eigen::AngleAxisd back(-block.yaw_rad, Eigen::Vector3d::UnitZ());
        const Eigen::Vector3d p = back * (from_m - block.middle_m);
        const Eigen::Vector3d d = back * ray;
        double enter = 0.0;
        double leave = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 3; ++k) {
            const double half_m = 0.5 * block.size_m[k];
            const double a = (-half_m - p[k]) / d[k];
            const double b = (half_m - p[k]) / d[k];
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        if (enter > 1e-6 && enter < leave && enter < hit.depth_m) hit = {enter, false};
    }
    return hit;
}

/// View of a camera above the origin that looks along world x. `step_px`: spacing of the pixels.
inline View view_of(const std::vector<Block>& blocks,
                    bool has_floor,
                    const Camera& camera,
                    const Errors& errors,
                    std::uint64_t seed,
                    int step_px = 6) {
    constexpr double kTogether_px = 40.0;
    constexpr double kMatched_px = 30.0;
    constexpr double kRelief_m = 0.15;
    View view;
    Rng rng(mix_seed(seed, 1));
    const Lattice together(mix_seed(seed, 2));
    const Lattice matched(mix_seed(seed, 3));
    const Lattice relief(mix_seed(seed, 4));
    const Eigen::Vector3d calibration =
        errors.calibration_px * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
    const double fb = camera.focal_px * camera.baseline_m;
    const Eigen::Vector3d calibration_sigma =
        errors.calibration_px / fb *
        Eigen::Vector3d(
            1.0, 2.0 * camera.focal_px / camera.width, 2.0 * camera.focal_px / camera.height);
    view.seen.calibration_covariance = calibration_sigma.cwiseAbs2().asDiagonal();
    const Eigen::Matrix3d R_world_body =
        (Eigen::AngleAxisd(camera.pitch_deg * kRadPerDeg, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(camera.roll_deg * kRadPerDeg, Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    view.up = R_world_body.transpose() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d from_m(0.0, 0.0, camera.height_m);
    const double sigma_px = std::hypot(errors.white_px, errors.together_px);
    // The average variance of a bilinear lattice is 4 / 9.
    const double together_px = errors.together_px * 1.5;
    // Share of a normal distribution below the threshold, by bisection.
    double low = -4.0;
    double high = 4.0;
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (0.5 * std::erfc(-middle * 1.5 / std::numbers::sqrt2) < errors.matched_share ? low : high) =
            middle;
    }
    std::size_t floor = 0;
    for (int v = step_px / 2; v < camera.height; v += step_px) {
        for (int u = step_px / 2; u < camera.width; u += step_px) {
            ++view.seen.pixels;
            const double x = (0.5 * camera.width - u) / camera.focal_px;   // to the left
            const double y = (0.5 * camera.height - v) / camera.focal_px;  // up
            const Eigen::Vector3d ray_body(1.0, x, y);
            const Eigen::Vector3d ray = R_world_body * ray_body;
            Hit hit = cast(blocks, has_floor, from_m, ray);
            if (hit.is_floor) {
                ++floor;
                const Eigen::Vector3d p = from_m + hit.depth_m * ray;
                const double z_m =
                    1.5 * errors.relief_m * relief.at(p.x() / kRelief_m, p.y() / kRelief_m);
                hit.depth_m = (z_m - from_m.z()) / ray.z();
            }
            if (!(matched.at(u / kMatched_px, v / kMatched_px) < low)) continue;
            if (!std::isfinite(hit.depth_m)) continue;
            double d_px = fb / hit.depth_m + errors.white_px * rng.normal() +
                          together_px * together.at(u / kTogether_px, v / kTogether_px) +
                          calibration[0] +
                          calibration[1] * 2.0 * (u - 0.5 * camera.width) / camera.width +
                          calibration[2] * 2.0 * (v - 0.5 * camera.height) / camera.height;
            if (rng.uniform() < errors.wrong_share) d_px = rng.uniform(2.0, 0.3 * camera.width);
            if (!(d_px > 1.0 && d_px < 0.3 * camera.width)) continue;
            view.seen.points_body_m.emplace_back(fb / d_px * ray_body);
            view.seen.inverse_range_sigma.push_back(sigma_px / (fb * ray_body.norm()));
        }
    }
    view.floor_share = static_cast<double>(floor) / static_cast<double>(view.seen.pixels);
    return view;
}

/// Walls of a room around the origin, as thick blocks.
inline void add_room(double ahead_m, double side_m, std::vector<Block>& blocks) {
    blocks.push_back({{ahead_m + 0.5, 0.0, 1.3}, {1.0, 4.0 * side_m, 2.6}});
    blocks.push_back({{0.0, side_m + 0.5, 1.3}, {4.0 * ahead_m, 1.0, 2.6}});
    blocks.push_back({{0.0, -side_m - 0.5, 1.3}, {4.0 * ahead_m, 1.0, 2.6}});
}

}  // namespace surefoot::ground::test
