// SPDX-License-Identifier: Apache-2.0
// How do the errors of the odometry's poses affect the map?
// Usage: own_poses OUT.csv SCENES [FIRST_SEED [SEEDS [PROFILES [FRAMES [MOTION_MODELS [RIGS
//        [KEY=VALUE...]]]]]]]
//   own_poses out/poses.csv demo_stairs,floor 20001 3 zed 160 trolley,rex,hand
//   zed_vga,zed_vga_rolling odometry.imu.enabled=false     (same command)
//   SCENES to PROFILES: see scene_cases.hpp. FRAMES: 0 (default) = to the end of the path.
//   MOTION_MODELS: motion models, default: scene. RIGS: rig presets, default: zed_vga. KEY=VALUE: a
//   setting of surefoot.
//
// The whole pipeline runs on rendered images and starts at the true pose. The program makes three
// other maps of the same frames: the depth of the pipeline at the true poses, exact depth at the
// poses of the pipeline, and exact depth at the true poses. If a motion model cannot follow the
// path of a scene, the program prints a message and skips the case.
//
// Writes OUT.csv, one line per scene, seed, profile, motion model and rig:
//   path_m, end_mm, end_deg     length of the true path; error at its end
//   ate_mm                      rms error of all positions after SE3 alignment
//   lost                        number of LOST frames
//   ..._jump_mm, ..._spread_mm  of each map's level floor: 99 % quantile of the jumps between
//                               neighbouring cells; spread about its plane
//                               (surefoot/eval/maps/map_edges.hpp). Prefixes: exact or matched
//                               depth; true or own poses
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "lab/scenes/exact_depth.hpp"
#include "lab/scenes/scene_cases.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/eval/maps/map_comparison.hpp"
#include "surefoot/eval/trajectory/trajectory.hpp"
#include "surefoot/io/text.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/sim/scene_source.hpp"
#include "surefoot/sim/scenes/truth.hpp"

namespace surefoot::app {
namespace {

using experiments::SceneCase;

struct Case {
    SceneCase seen;
    sim::MotionModelChoice motion_model = sim::MotionModelChoice::scene;
    std::string rig;
};

/// The additional maps of a run, besides the map of the pipeline.
class Maps {
  public:
    explicit Maps(const elevation::ElevationConfig& config)
        : exact_true(config), exact_own(config), matched_true(config) {}

    void add(const sim::Scene& scene,
             const pipeline::Pipeline& pipeline,
             const FrameReport& report,
             const Pose& T_world_body,
             Executor& executor) {
        const Pose& T_odom_body = report.motion.T_odom_body;
        exact_own.follow(T_odom_body, report.motion.relative_covariance);
        for (auto* map : {&exact_true, &matched_true}) map->follow(T_world_body, Matrix6::Zero());
        if (report.motion.health == Health::lost) return;
        const std::int64_t time_ns = report.motion.time_ns;
        const camera::RectifiedRig& rig = pipeline.rig();
        const DepthImage exact = experiments::exact_depth(scene, rig, T_world_body, executor);
        exact_own.add(rig, T_odom_body, exact, time_ns, executor);
        exact_true.add(rig, T_world_body, exact, time_ns, executor);
        matched_true.add(rig, T_world_body, pipeline.depth(), time_ns, executor);
    }

    elevation::ElevationMap exact_true;
    elevation::ElevationMap exact_own;
    elevation::ElevationMap matched_true;
};

/// Returns the columns ",jump_mm,spread_mm" of the level floor of a map in the world frame.
std::string floor_figures(const sim::Scene& scene, const elevation::ElevationMap& map) {
    eval::MapPair maps;
    maps.geometry = map.geometry();
    maps.live_m = map.layers().height_m.copy();
    maps.truth_m = sim::dem(
        scene,
        {maps.geometry.origin_m, maps.geometry.nx, maps.geometry.ny, maps.geometry.resolution_m});
    const eval::MapComparison found = eval::compare_maps(maps, {});
    return fmt::format(",{:.2f},{:.2f}", 1e3 * found.edges.p99_abs, 1e3 * found.floor.spread_m);
}

std::string motion_figures(const Trajectory& truth, const Trajectory& found, int lost) {
    double path_m = 0.0;
    for (std::size_t i = 1; i < truth.size(); ++i)
        path_m +=
            (truth[i].T_world_body.translation_m - truth[i - 1].T_world_body.translation_m).norm();
    const Vector6 end = difference(truth.back().T_world_body, found.back().T_world_body);
    const auto errors = eval::evaluate_trajectory(found, truth, {});
    return fmt::format("{:.3f},{:.2f},{:.3f},{:.3f},{}",
                       path_m,
                       1e3 * end.head<3>().norm(),
                       kDegPerRad * end.tail<3>().norm(),
                       errors ? 1e3 * errors->ate_rmse_m : std::nan(""),
                       lost);
}

/// Returns nullopt if the motion model cannot follow the scene's path.
Result<std::optional<std::string>> measure(const Case& now,
                                           int frames,
                                           const SettingsRequest& common,
                                           Executor& executor) {
    auto settings = surefoot::load_settings(common);
    if (!settings) return settings.error();
    sim::SceneOptions& sim = settings->sim;
    if (Status seen = now.seen.put_into(sim); !seen) return seen.error();
    sim.frames = frames;
    sim.motion_model = now.motion_model;
    sim.rig_preset = now.rig;
    auto source = sim::open_scene(sim, &executor);
    if (!source && now.motion_model != sim::MotionModelChoice::scene) {
        log_warning(source.error().message);
        return std::optional<std::string>{};
    }
    if (!source) return source.error();
    auto pipeline = pipeline::Pipeline::make(settings->pipeline, (*source)->rig(), executor);
    if (!pipeline) return pipeline.error();

    const sim::SceneTruth& truth = (*source)->truth();
    Maps maps(settings->pipeline.elevation);
    std::vector<StereoFrame> first_frames;
    Trajectory true_bodies;
    Trajectory found_bodies;
    int lost = 0;
    const auto follow = [&](const StereoFrame& frame) {
        const Pose T_world_body = experiments::true_pose(truth.trajectory, frame.time_ns);
        const FrameReport report = pipeline->process(frame, Work::full);
        maps.add(truth.scene, *pipeline, report, T_world_body, executor);
        true_bodies.push_back({frame.time_ns, T_world_body});
        found_bodies.push_back({frame.time_ns, report.motion.T_odom_body});
        lost += report.motion.health == Health::lost ? 1 : 0;
    };
    const auto start = [&] {
        pipeline->align(first_frames, truth.trajectory.front().T_world_body);
        for (const StereoFrame& frame : first_frames) follow(frame);
        first_frames.clear();
    };
    while (true) {
        auto frame = (*source)->next();
        if (!frame) return frame.error();
        if (!*frame) break;
        if (found_bodies.empty()) {
            first_frames.push_back(std::move(**frame));
            if (first_frames.size() == pipeline::Pipeline::kAlignmentFrames) start();
        } else {
            follow(**frame);
        }
    }
    if (!first_frames.empty()) start();
    return std::optional(motion_figures(true_bodies, found_bodies, lost) +
                         floor_figures(truth.scene, maps.exact_true) +
                         floor_figures(truth.scene, maps.exact_own) +
                         floor_figures(truth.scene, maps.matched_true) +
                         floor_figures(truth.scene, pipeline->map()));
}

Result<sim::MotionModelChoice> motion_model_named(std::string_view name) {
    const auto* const found = std::find(
        std::begin(sim::kMotionModelChoiceNames), std::end(sim::kMotionModelChoiceNames), name);
    if (found == std::end(sim::kMotionModelChoiceNames))
        return usage_error(
            fmt::format("unknown motion model '{}'; use scene, trolley, rex or hand", name));
    return static_cast<sim::MotionModelChoice>(found - std::begin(sim::kMotionModelChoiceNames));
}

int measure_all(const std::vector<std::string>& words) {
    if (words.size() < 2)
        return report(usage_error(
            "own_poses OUT.csv SCENES [FIRST_SEED [SEEDS [PROFILES [FRAMES [MOTION_MODELS [RIGS "
            "[KEY=VALUE...]]]]]]]"));
    const int frames = words.size() > 5 ? std::atoi(words[5].c_str()) : 0;
    const std::string motion_models = words.size() > 6 ? words[6] : "scene";
    const std::string rigs = words.size() > 7 ? words[7] : "zed_vga";
    SettingsRequest common;
    if (words.size() > 8) common.overrides.assign(words.begin() + 8, words.end());
    const auto executor = surefoot::make_executor();
    auto out = fmt::output_file(words[0]);
    out.print(
        "scene,seed,profile,motion_model,rig,path_m,end_mm,end_deg,ate_mm,lost,"
        "exact_true_jump_mm,exact_true_spread_mm,exact_own_jump_mm,exact_own_spread_mm,"
        "matched_true_jump_mm,matched_true_spread_mm,matched_own_jump_mm,matched_own_spread_mm\n");
    for (const SceneCase& seen : experiments::scene_cases({words.begin() + 1, words.end()})) {
        for (const std::string_view motion_model : io::split(motion_models, ",")) {
            for (const std::string_view rig : io::split(rigs, ",")) {
                const auto carried = motion_model_named(motion_model);
                if (!carried) return report(carried.error());
                const auto done =
                    measure({seen, *carried, std::string(rig)}, frames, common, *executor);
                if (!done) return report(done.error());
                if (!*done) continue;
                out.print("{},{},{},{},{},{}\n",
                          seen.scene,
                          seen.seed,
                          seen.profile,
                          motion_model,
                          rig,
                          **done);
                out.flush();
            }
        }
    }
    return kExitOk;
}

}  // namespace
}  // namespace surefoot::app

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::app::measure_all({argv + 1, argv + argc});
}
