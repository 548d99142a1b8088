// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "studies/benchmarks/bench_result.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/eval/clouds/cloud_distance.hpp"
#include "surefoot/eval/clouds/cloud_outliers.hpp"
#include "surefoot/eval/clouds/m3c2.hpp"
#include "surefoot/eval/clouds/voxels.hpp"
#include "surefoot/eval/maps/dem.hpp"
#include "surefoot/geometry/cloud_alignment.hpp"

namespace surefoot::app {
namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr std::size_t kPoints = 1'000'000;
constexpr int kRepeats = 3;

/// Synthetic scan of stairs, the same scene on which other tools were measured: a floor of 3 m by 3
/// m, 20 steps (riser 0.17 m, going 0.285 m, width 1.25 m), a landing and a wall beside the steps.
/// The points are spread evenly over the area, in random order, with 2 mm noise.
Points scanned_stairs(std::size_t count, std::uint64_t seed) {
    constexpr double kRiser_m = 0.17;
    constexpr double kGoing_m = 0.285;
    constexpr double kWidth_m = 1.25;
    constexpr int kSteps = 20;
    constexpr double kNoise_m = 0.002;
    constexpr double kFloor_m2 = 9.0;
    constexpr double kSteps_m2 = kSteps * kWidth_m * (kRiser_m + kGoing_m);
    constexpr double kLanding_m2 = kWidth_m * 1.5;
    constexpr double kWall_m2 = (kSteps * kGoing_m + 1.5) * kSteps * kRiser_m;
    Rng rng(seed);
    const auto place = [&]() -> Eigen::Vector3d {
        const double which_m2 = rng.uniform(0.0, kFloor_m2 + kSteps_m2 + kLanding_m2 + kWall_m2);
        if (which_m2 < kFloor_m2) return {rng.uniform(-3.0, 0.0), rng.uniform(0.0, 3.0), 0.0};
        if (which_m2 < kFloor_m2 + kSteps_m2) {
            const auto step = static_cast<double>(rng.below(kSteps));
            const double y_m = rng.uniform(0.0, kWidth_m);
            if (rng.uniform() < kRiser_m / (kRiser_m + kGoing_m))
                return {kGoing_m * step, y_m, kRiser_m * (step + rng.uniform())};
            return {kGoing_m * (step + rng.uniform()), y_m, kRiser_m * (step + 1.0)};
        }
        if (which_m2 < kFloor_m2 + kSteps_m2 + kLanding_m2) {
            return {kGoing_m * kSteps + rng.uniform(0.0, 1.5),
                    rng.uniform(0.0, kWidth_m),
                    kRiser_m * kSteps};
        }
        return {
            rng.uniform(0.0, kGoing_m * kSteps + 1.5), 0.0, rng.uniform(0.0, kRiser_m * kSteps)};
    };
    Points points_m(count);
    for (Eigen::Vector3f& p_m : points_m) {
        const Eigen::Vector3d noise_m(rng.normal(), rng.normal(), rng.normal());
        p_m = (place() + kNoise_m * noise_m).cast<float>();
    }
    return points_m;
}

}  // namespace

Result<std::vector<BenchResult>> bench_clouds(const CommonOptions& common, Executor& executor) {
    const Points reference_m = scanned_stairs(kPoints, common.seed);
    const Points compared_m = scanned_stairs(kPoints, common.seed + 1);
    std::vector<BenchResult> results;
    const auto time = [&](const std::string& name, const std::function<void()>& work) {
        results.push_back({"clouds/" + name, timed(kRepeats, work)});
    };
    std::size_t kept = 0;  // uses the results, so that the compiler does not remove the work
    for (const int size_mm : {5, 10, 25}) {
        time(fmt::format("voxel_{}mm", size_mm),
             [&] { kept += eval::voxel_means_m(reference_m, 1e-3 * size_mm, executor).size(); });
    }
    time("tree", [&] { kept += geometry::KdTree(reference_m, executor).points_m().size(); });
    time("c2c", [&] {
        const geometry::KdTree tree(reference_m, executor);
        kept += eval::cloud_distances_m(tree, compared_m, executor).size();
    });
    time("sor_7_4", [&] {
        const eval::OutlierFilter filter(geometry::KdTree(reference_m, executor), {}, executor);
        kept += filter.keeps(reference_m.front()) ? 1U : 0U;
    });
    Points cores_m;
    for (std::size_t i = 0; i < reference_m.size(); i += 16) cores_m.push_back(reference_m[i]);
    eval::M3c2Config config;
    config.normals = eval::M3c2Normals::pca;
    time(fmt::format("m3c2_{}_cores", cores_m.size()), [&] {
        const geometry::KdTree first(reference_m, executor);
        const geometry::KdTree second(compared_m, executor);
        kept += eval::m3c2(first, second, cores_m, config, executor).size();
    });
    time("icp_100000_points", [&] {
        const geometry::KdTree tree(reference_m, executor);
        const Pose guess{exp_so3({0.0, 0.0, 0.017}), {0.03, 0.02, 0.02}};
        kept += geometry::align_clouds(tree, compared_m, guess, {}, executor).steps.size();
    });
    std::vector<Eigen::Vector3d> wide_m;
    for (const Eigen::Vector3f& p_m : reference_m) wide_m.push_back(p_m.cast<double>());
    time("dem_25mm_max", [&] {
        eval::CloudBounds bounds;
        bounds.add(wide_m, executor);
        const auto grid = bounds.grid(0.025, eval::Lattice::cell);
        eval::DemBuilder builder(*grid, eval::Reduce::max);
        builder.add(wide_m, executor);
        kept += static_cast<std::size_t>(grid->geometry.nx) + builder.heights_m().size();
    });
    if (kept == 0)
        return input_error("bench clouds: no point was kept, so the timing means nothing");
    return results;
}

}  // namespace surefoot::app
