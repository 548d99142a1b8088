// SPDX-License-Identifier: Apache-2.0
// How long is the occluded region behind a kerb of 75 mm, and which depth does a matcher report in
// it?
// Usage: drop_shadow OUT_DIR [FIRST_SEED [SEEDS [NOISE [KEY=VALUE...]]]]
//   FIRST_SEED: default 1. SEEDS: number of seeds, default 4. NOISE: factor on the image noise,
//   default 1.0. KEY=VALUE: a setting of the matcher.
//
// The camera is 0.95 m above the upper level and looks straight over the edge. One frame is
// rendered per seed and distance from the camera to the edge.
//
// Writes into OUT_DIR:
//   shadow.csv  one line per distance, seed, rule (every match, or the default rules for points)
//               and fifth of the region:
//                 geometry_m  length of the region by similar triangles
//                 rays_m      its length by rays of both cameras through the scene
//                 rendered_m  its length to the first rendered pixel that shows ground again
//                 pieces      number of pieces of the fifth, each 25 mm wide across
//                 filled      number of pieces that contain a point
//                 height_m    median height of the points
//   cut.csv     points of the first seed within 12 mm of the camera's axis: distance behind the
//               edge and height [m]
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "lab/drop_edges/drop_scene.hpp"
#include "surefoot/elevation/sampling/depth_points.hpp"
#include "surefoot/geometry/statistics.hpp"

namespace surefoot {
namespace {

using Eigen::Vector3d;

constexpr Drop kKerb = {"kerb 75 mm", 0.075, 1};
constexpr int kFifths = 5;
constexpr double kHalfWidth_m = 0.3;  ///< width of the strip on each side of the camera [m]
constexpr int kPieces = 24;           ///< pieces of 25 mm across the strip

struct Rule {
    const char* name;
    elevation::ElevationConfig config;
};

std::vector<Rule> rules() {
    Rule every{"every match", {}};
    every.config.pixels.surface_check = false;
    every.config.pixels.max_outlier_probability = 1.0;
    return {every, {"default", {}}};
}

struct Lengths {
    double geometry_m = 0.0;
    double rays_m = 0.0;
    double rendered_m = 0.0;
};

/// Returns the distance behind the edge [m] from which both cameras see the lower ground again.
/// Follows rays through the scene.
double length_by_rays(const sim::Scene& scene,
                      const camera::StereoRig& rig,
                      const Pose& T_world_body,
                      const Vector3d& edge_m) {
    constexpr double kStep_m = 0.0005;
    Vector3d ground_m = edge_m - Vector3d(0.0, 0.0, kKerb.rise_m);
    do ground_m.x() += kStep_m;
    while (sight_of(scene, rig, T_world_body, ground_m) == Sight::hidden);
    return ground_m.x() - edge_m.x();
}

/// Returns the distance behind the edge [m] of the nearest pixel that shows lower ground in the
/// rendered depth image.
double length_in_image(const ZedBench& bench, const Pose& T_world_body, const Vector3d& edge_m) {
    const camera::RectifiedRig& rig = bench.rectified();
    const Pose T_world_camera = T_world_body * rig.T_body_camera;
    const Image<float>& depth_m = bench.true_depth_m();
    double nearest_m = 1e9;
    for (int v = 0; v < depth_m.height(); ++v) {
        for (int u = 0; u < depth_m.width(); ++u) {
            const auto z_m = static_cast<double>(depth_m.at(u, v));
            if (std::isnan(z_m)) continue;
            const Vector3d point =
                T_world_camera *
                (z_m * Vector3d((u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0));
            if (std::abs(point.y() - edge_m.y()) > kHalfWidth_m) continue;
            if (point.z() < -kKerb.rise_m + 0.001) nearest_m = std::min(nearest_m, point.x());
        }
    }
    return nearest_m - edge_m.x();
}

/// The points in one fifth of the strip behind the edge.
struct Fill {
    std::vector<bool> pieces = std::vector<bool>(kPieces, false);
    std::vector<double> heights_m;

    [[nodiscard]] auto filled() const { return std::count(pieces.begin(), pieces.end(), true); }
    [[nodiscard]] double median_m() const {
        if (heights_m.empty()) return std::nan("");
        std::vector<double> sorted = heights_m;
        return upper_median_in_place(sorted);
    }
};

std::vector<Fill> fill_of(const std::vector<elevation::GridPoint>& points,
                          const Vector3d& edge_m,
                          double length_m) {
    std::vector<Fill> fills(kFifths);
    for (const elevation::GridPoint& point : points) {
        const double behind = (static_cast<double>(point.x_m) - edge_m.x()) / length_m;
        const double across =
            0.5 * (1.0 + (static_cast<double>(point.y_m) - edge_m.y()) / kHalfWidth_m);
        if (behind < 0.0 || behind >= 1.0 || across < 0.0 || across >= 1.0) continue;
        Fill& fill = fills[static_cast<std::size_t>(kFifths * behind)];
        fill.pieces[static_cast<std::size_t>(kPieces * across)] = true;
        fill.heights_m.push_back(static_cast<double>(point.z_m));
    }
    return fills;
}

void print_cut(fmt::ostream& file,
               double distance_m,
               const char* rule,
               const std::vector<elevation::GridPoint>& points,
               const Vector3d& edge_m) {
    constexpr double kAxis_m = 0.012;
    constexpr double kReach_m = 0.35;
    for (const elevation::GridPoint& point : points) {
        const double behind_m = static_cast<double>(point.x_m) - edge_m.x();
        if (std::abs(static_cast<double>(point.y_m) - edge_m.y()) > kAxis_m) continue;
        if (std::abs(behind_m) > kReach_m) continue;
        file.print("{:.2f},\"{}\",{:.4f},{:.4f}\n", distance_m, rule, behind_m, point.z_m);
    }
}

struct Tables {
    fmt::ostream shadow;
    fmt::ostream cut;
};

void measure(ZedBench& bench, double distance_m, int seed, bool draws_cut, Tables& out) {
    Rng rng(mix_seed(static_cast<std::uint64_t>(seed),
                     static_cast<std::uint64_t>(1000.0 * distance_m)));
    const Pose T_world_body = bench.pose_over(0.0);
    const Vector3d camera_m = (T_world_body * bench.rectified().T_body_camera).translation_m;
    const Vector3d edge_m(camera_m.x() + distance_m, camera_m.y(), 0.0);
    const sim::Scene scene = drop_scene(kKerb, edge_m.x(), 0.0, rng);
    bench.see(scene, T_world_body, 0, rng.next_u64());
    const Lengths lengths{kKerb.rise_m * distance_m / camera_m.z(),
                          length_by_rays(scene, bench.rig(), T_world_body, edge_m),
                          length_in_image(bench, T_world_body, edge_m)};
    std::vector<elevation::GridPoint> points;
    for (const Rule& rule : rules()) {
        FusionCounts counts;
        elevation::points_from_depth(rule.config,
                                     bench.rectified(),
                                     T_world_body,
                                     bench.depth(),
                                     Eigen::Vector2d::Zero(),
                                     points,
                                     counts);
        const std::vector<Fill> fills = fill_of(points, edge_m, lengths.geometry_m);
        for (int fifth = 0; fifth < kFifths; ++fifth) {
            const Fill& fill = fills[static_cast<std::size_t>(fifth)];
            out.shadow.print("{:.2f},{},{:.5f},{:.5f},{:.5f},\"{}\",{},{},{},{:.5f}\n",
                             distance_m,
                             seed,
                             lengths.geometry_m,
                             lengths.rays_m,
                             lengths.rendered_m,
                             rule.name,
                             fifth,
                             kPieces,
                             fill.filled(),
                             fill.median_m());
        }
        if (draws_cut) print_cut(out.cut, distance_m, rule.name, points, edge_m);
    }
}

}  // namespace
}  // namespace surefoot

// An uncaught exception ends the experiment and prints its message. This is intended.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    using namespace surefoot;
    const auto arguments = bench_arguments(argc, argv);
    if (!arguments) {
        fmt::print(stderr, "{}\n", arguments.error().message);
        return 2;
    }
    Serial executor;
    ZedBench bench(arguments->noise, arguments->matcher, executor);
    Tables out{fmt::output_file(arguments->out_dir + "/shadow.csv"),
               fmt::output_file(arguments->out_dir + "/cut.csv")};
    out.shadow.print(
        "distance_m,seed,geometry_m,rays_m,rendered_m,rule,fifth,pieces,filled,height_m\n");
    out.cut.print("distance_m,rule,behind_m,height_m\n");
    for (const double distance_m : kEdgeDistances_m) {
        for (int i = 0; i < arguments->seeds; ++i)
            measure(bench, distance_m, arguments->first_seed + i, i == 0, out);
    }
    return 0;
}
