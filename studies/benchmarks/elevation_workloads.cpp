// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "studies/benchmarks/terrain_workloads.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/elevation/elevation_map.hpp"
#include "surefoot/elevation/fusion/height_bounds.hpp"

namespace surefoot::app {
namespace {

using elevation::ElevationConfig;
using elevation::ElevationMap;

constexpr int kRepeats = 60;
constexpr int kViews = 8;
constexpr int kSide = 240;
constexpr int kSides[] = {120, 480, 960, 1920};  ///< cells per side of the additional map sizes
constexpr double kResolution_m = 0.025;
constexpr std::int64_t kFrame_ns = 66'666'667;

/// Uses fewer repeats for large maps, so that a workload takes at most about two seconds.
int repeats_for(int side) {
    return std::clamp(kRepeats * kSide / side, 5, kRepeats);
}

/// Returns the rectified VGA rig of a ZED, pitched 32 deg down.
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

/// Simulates a depth image: each pixel below the horizon sees the floor or, in the middle columns,
/// a surface 0.2 m above it.
DepthImage look(const camera::RectifiedRig& rig, const Pose& T_odom_body, Rng& rng) {
    const Pose T_odom_camera = T_odom_body * rig.T_body_camera;
    DepthImage depth;
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

std::vector<DepthImage> looks(const camera::RectifiedRig& rig) {
    Rng rng(1);
    std::vector<DepthImage> views;
    views.reserve(kViews);
    for (int i = 0; i < kViews; ++i) views.push_back(look(rig, body_at(0.02 * i), rng));
    return views;
}

ElevationConfig window_of(int side) {
    ElevationConfig config;
    config.length_m = side * kResolution_m;
    config.resolution_m = kResolution_m;
    return config;
}

/// Fuses depth images one after the other, taken at positions 20 mm apart.
Workload fusing(std::string name, const ElevationConfig& config, int repeats, Executor& executor) {
    struct State {
        camera::RectifiedRig rig = zed();
        std::vector<DepthImage> views = looks(rig);
        ElevationMap map;
        int frame = 0;
    };
    const auto prepare = [config, &executor]() -> Result<Workload::Job> {
        const auto state = std::make_shared<State>(State{.map = ElevationMap(config)});
        return Workload::Job([state, &executor] {
            const int view = state->frame % kViews;
            const Pose T_odom_body = body_at(0.02 * view);
            state->map.follow(T_odom_body, 1e-8 * Matrix6::Identity());
            static_cast<void>(state->map.add(state->rig,
                                             T_odom_body,
                                             state->views[static_cast<std::size_t>(view)],
                                             kFrame_ns * state->frame,
                                             executor));
            ++state->frame;
        });
    };
    return {std::move(name), repeats, prepare};
}

/// Moves the map with a body that advances by `step_m` in each call.
Workload moving(std::string name, double step_m, const Matrix6& covariance, int repeats) {
    struct State {
        ElevationMap map{window_of(kSide)};
        int steps = 0;
    };
    const auto prepare = [step_m, covariance]() -> Result<Workload::Job> {
        const auto state = std::make_shared<State>();
        return Workload::Job(
            [=] { state->map.follow(body_at(step_m * ++state->steps), covariance); });
    };
    return {std::move(name), repeats, prepare};
}

grid::GridGeometry centred(int side) {
    const double half_m = 0.5 * side * kResolution_m;
    return {kResolution_m, side, side, {-half_m, -half_m}};
}

template <typename F>
void for_each_cell(const grid::GridGeometry& geometry, const F& f) {
    for (int iy = 0; iy < geometry.ny; ++iy) {
        for (int ix = 0; ix < geometry.nx; ++ix) f(grid::Cell{ix, iy});
    }
}

/// Adds one ray for each cell, which ends in this cell. Then queries the lowest ray over each cell.
Workload seeing_through(std::string name, int side) {
    const auto prepare = [side]() -> Result<Workload::Job> {
        const auto lines = std::make_shared<elevation::FreeSpaceRays>();
        return Workload::Job([lines, geometry = centred(side)] {
            lines->reset(geometry, {0.1, 0.0, 1.0});
            for_each_cell(geometry, [&](grid::Cell cell) { lines->add(cell, 0.0F); });
            lines->finish();
            volatile float lowest_m = 0.0F;
            for_each_cell(geometry, [&](grid::Cell cell) { lowest_m = lines->lowest_over(cell); });
            static_cast<void>(lowest_m);
        });
    };
    return {std::move(name), repeats_for(side), prepare};
}

/// Cleans a remembered map by a frame that sees the floor in every cell. The map holds the floor.
/// In its middle it holds a table top above the rays, whose cells support each other.
Workload checking_sight(std::string name, int side, Executor& executor) {
    struct State {
        ElevationConfig config;
        grid::GridGeometry geometry;
        elevation::ElevationCells cells{config, geometry.nx, geometry.ny};
        elevation::VisibilityCleanup check{config};
    };
    const auto prepare = [side, &executor]() -> Result<Workload::Job> {
        const auto state =
            std::make_shared<State>(State{.config = window_of(side), .geometry = centred(side)});
        elevation::ViewpointHistory views(state->config.viewpoint);
        const elevation::FrameObservation look{views, views.look_from(body_at(0.0)), kFrame_ns};
        FusionCounts counts;
        std::size_t index = 0;
        for_each_cell(state->geometry, [&](grid::Cell cell) {
            const bool table =
                std::abs(cell.ix - side / 2) < side / 8 && std::abs(cell.iy - side / 2) < side / 6;
            const float z_m = table ? 0.7F : 0.0F;
            state->cells.update(index++, {{z_m, 1e-5F, z_m, z_m, 9}, 1.0F, z_m}, look, counts);
        });
        return Workload::Job([state, &executor] {
            state->check.reset(state->geometry, {0.1, 0.0, 1.0});
            const auto cells = static_cast<std::size_t>(state->geometry.nx) *
                               static_cast<std::size_t>(state->geometry.ny);
            for (std::size_t cell = 0; cell < cells; ++cell)
                state->check.ended(cell, 0.0F, 1e-5F, 0.0F);
            static_cast<void>(state->check.apply(2 * kFrame_ns, executor, state->cells));
        });
    };
    return {std::move(name), repeats_for(side), prepare};
}

/// Computes the lower and upper bound of the height of every cell.
Workload bounding(std::string name, int side, double drift_m, Executor& executor) {
    struct State {
        grid::Layer height_m;
        grid::Layer var_m2;
        grid::Layer drift_m;
        elevation::HeightBounds bounds;
        grid::Layer lower_m;
        grid::Layer upper_m;
    };
    const auto prepare = [side, drift_m, &executor]() -> Result<Workload::Job> {
        const auto state = std::make_shared<State>();
        Rng rng(3);
        state->height_m = grid::Layer(side, side);
        for (std::size_t i = 0; i < state->height_m.size(); ++i)
            state->height_m.data()[i] = static_cast<float>(0.01 * rng.normal());
        state->var_m2 = grid::Layer(side, side, 1e-5F);
        state->drift_m = grid::Layer(side, side, static_cast<float>(drift_m));
        return Workload::Job([state, &executor] {
            state->bounds.compute(
                {state->height_m.view(), state->var_m2.view(), state->drift_m.view()},
                executor,
                state->lower_m,
                state->upper_m);
        });
    };
    return {std::move(name), repeats_for(side), prepare};
}

}  // namespace

std::vector<Workload> elevation_workloads(Executor& executor) {
    ElevationConfig without_lines = window_of(kSide);
    without_lines.visibility.drops = false;
    without_lines.visibility.cleanup = false;
    ElevationConfig with_alignment = window_of(kSide);
    with_alignment.height_drift.enabled = true;
    std::vector<Workload> all{
        fusing("terrain/fuse_672x376", without_lines, kRepeats, executor),
        fusing("terrain/fuse_with_lines_672x376", window_of(kSide), kRepeats, executor),
        fusing("terrain/fuse_with_height_drift_672x376", with_alignment, kRepeats, executor),
        moving("terrain/move_4_cells", 0.1, Matrix6::Zero(), 10 * kRepeats),
        moving("terrain/motion_1_cell", 0.025, 1e-8 * Matrix6::Identity(), kRepeats),
        seeing_through("terrain/clean_up_every_cell_a_line", kSide),
        checking_sight("terrain/sight_check_every_cell_an_end", kSide, executor),
        bounding("terrain/bounds_drift_12mm", kSide, 0.0125, executor),
        bounding("terrain/bounds_drift_100mm", kSide, 0.1, executor)};
    for (const int side : kSides) {
        const auto sized = [&](const char* job) {
            return fmt::format("terrain/{0}_{1}x{1}", job, side);
        };
        all.push_back(
            fusing(sized("fuse_with_lines_672x376"), window_of(side), repeats_for(side), executor));
        all.push_back(seeing_through(sized("clean_up_every_cell_a_line"), side));
        all.push_back(bounding(sized("bounds_drift_12mm"), side, 0.0125, executor));
        all.push_back(bounding(sized("bounds_drift_100mm"), side, 0.1, executor));
    }
    return all;
}

}  // namespace surefoot::app
