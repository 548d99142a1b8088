// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "apps/surefoot/bench_result.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/elevation/elevation_map.hpp"
#include "surefoot/elevation/height_bounds.hpp"

namespace surefoot::app {
namespace {

constexpr int kRepeats = 60;
constexpr int kViews = 8;
constexpr std::int64_t kFrame_ns = 66'666'667;

/// A ZED's VGA image, 1 m above the floor and 32 deg down.
camera::RectifiedRig zed() {
    camera::RectifiedRig rig;
    rig.width = 672;
    rig.height = 376;
    rig.fx_px = 342.0;
    rig.fy_px = 342.0;
    rig.cx_px = 335.5;
    rig.cy_px = 187.5;
    rig.baseline_m = 0.12;
    rig.T_body_camera =
        Pose{exp_so3({0.0, 32.0 * std::numbers::pi / 180.0, 0.0}), Eigen::Vector3d::Zero()} *
        T_body_optical();
    return rig;
}

Pose body_at(double x_m) {
    return {Eigen::Quaterniond::Identity(), {x_m, 0.0, 1.0}};
}

/// Every pixel below the horizon sees the floor, or a step of 0.2 m in the middle.
camera::DepthImage look(const camera::RectifiedRig& rig, const Pose& T_odom_body, Rng& rng) {
    const Pose T_odom_camera = T_odom_body * rig.T_body_camera;
    camera::DepthImage depth;
    depth.resize(rig.width, rig.height);
    depth.sigma_px.fill(0.25F);
    depth.outlier_probability.fill(0.05F);
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const Eigen::Vector3d ray =
                T_odom_camera.R() *
                Eigen::Vector3d((u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0);
            const double step_m = std::abs(u - rig.cx_px) < 60.0 ? 0.2 : 0.0;
            const double z_m = -(T_odom_camera.translation_m.z() - step_m) / ray.z();
            depth.disparity_px.at(u, v) =
                z_m > 0.0
                    ? static_cast<float>(rig.depth_to_disparity_px_m() / z_m + 0.02 * rng.normal())
                    : std::numeric_limits<float>::quiet_NaN();
        }
    }
    return depth;
}

/// Lines of sight to every cell, and what they say of every cell.
void see_through_all(const grid::GridGeometry& geometry, elevation::LinesOfSight& lines) {
    lines.reset(geometry, {0.1, 0.0, 1.0});
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) lines.add({ix, iy}, 0.0F);
    }
    lines.finish();
    volatile float lowest_m = 0.0F;
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) lowest_m = lines.lowest_over({ix, iy});
    }
    static_cast<void>(lowest_m);
}

Timing time_bounds(double drift_m, Executor& executor) {
    constexpr int kSide = 240;
    Rng rng(3);
    grid::Layer height_m(kSide, kSide);
    for (std::size_t i = 0; i < height_m.size(); ++i)
        height_m.data()[i] = static_cast<float>(0.01 * rng.normal());
    const grid::Layer var_m2(kSide, kSide, 1e-5F);
    const grid::Layer drift(kSide, kSide, static_cast<float>(drift_m));
    elevation::HeightBounds bounds;
    grid::Layer lower_m;
    grid::Layer upper_m;
    return timed(kRepeats, [&] {
        bounds.compute({height_m.view(), var_m2.view(), drift.view()}, executor, lower_m, upper_m);
    });
}

}  // namespace

std::vector<BenchResult> bench_elevation(Executor& executor) {
    const camera::RectifiedRig rig = zed();
    Rng rng(1);
    std::vector<camera::DepthImage> views;
    views.reserve(kViews);
    for (int i = 0; i < kViews; ++i) views.push_back(look(rig, body_at(0.02 * i), rng));
    int frame = 0;
    const auto add_to = [&](elevation::ElevationMap& map) {
        const int view = frame % kViews;
        map.follow(body_at(0.02 * view), 1e-8 * Matrix6::Identity());
        static_cast<void>(map.add(rig,
                                  body_at(0.02 * view),
                                  views[static_cast<std::size_t>(view)],
                                  kFrame_ns * frame,
                                  executor));
        ++frame;
    };
    elevation::ElevationConfig without_lines;
    without_lines.visibility.drops = false;
    without_lines.visibility.cleanup = false;
    elevation::ElevationMap plain(without_lines);
    elevation::ElevationConfig with_alignment;
    with_alignment.height_drift.enabled = true;
    elevation::ElevationMap aligned(with_alignment);
    elevation::ElevationMap map({});
    std::vector<BenchResult> results{
        {"terrain/fuse_672x376", timed(kRepeats, [&] { add_to(plain); })},
        {"terrain/fuse_with_lines_672x376", timed(kRepeats, [&] { add_to(map); })},
        {"terrain/fuse_with_height_drift_672x376", timed(kRepeats, [&] { add_to(aligned); })}};
    int moves = 0;
    results.push_back({"terrain/move_4_cells", timed(10 * kRepeats, [&] {
                           map.follow(body_at(0.1 * ++moves), Matrix6::Zero());
                       })});
    results.push_back({"terrain/motion_1_cell", timed(kRepeats, [&] {
                           map.follow(body_at(0.025 * ++moves), 1e-8 * Matrix6::Identity());
                       })});
    elevation::LinesOfSight lines;
    grid::GridGeometry geometry = map.geometry();
    geometry.origin_m = {-3.0, -3.0};
    results.push_back({"terrain/clean_up_every_cell_a_line",
                       timed(kRepeats, [&] { see_through_all(geometry, lines); })});
    results.push_back({"terrain/bounds_drift_12mm", time_bounds(0.0125, executor)});
    results.push_back({"terrain/bounds_drift_100mm", time_bounds(0.1, executor)});
    return results;
}

}  // namespace surefoot::app
