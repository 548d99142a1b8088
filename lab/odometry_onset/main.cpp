// SPDX-License-Identifier: Apache-2.0
// How soon does the odometry report that a standing machine begins to move? Does it report motion
// of a machine that stands?
// Usage: odometry_onset OUT.csv SCENES [FIRST_SEED [SEEDS [PROFILES [KEY=VALUE...]]]]
//   odometry_onset out/onset.csv walk_floor,room 71101 3 ideal,zed
//   SCENES to PROFILES: see scene_cases.hpp. KEY=VALUE: a setting of surefoot.
//
// Pairs are rendered at 10 Hz from the start of the scene's path; only the odometry runs, no IMU.
// The machine stands for 3 s, moves ahead by some millimetres within one frame or evenly over 0.5
// s, and stands again; or it stands for 10 s.
//
// Writes OUT.csv, one line per case:
//   shift_mm, spread_frames   size and duration of the motion; 0 = no motion
//   seen_after                frames from the first frame with the whole shift until T_odom_body
//                             has moved by half of it; 0 = in that frame, -1 = never
//   begun_after               frames from the first frame with a shift until T_odom_body has moved
//   end_mm                    motion of T_odom_body at the end, minus the shift
//   moved_before              standing frames (without the first three) whose T_previous_body has a
//                             translation
//   crept_mm                  largest distance from the start while the machine stands
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <string>
#include <vector>

#include "lab/scenes/scene_cases.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::app {
namespace {

constexpr int kStands = 30;  ///< number of standing frames before the motion
constexpr int kAfter = 15;   ///< number of frames after the begin of the motion
constexpr int kLongStand = 100;
constexpr int kSettled = 3;  ///< number of first frames that are not judged
constexpr double kPeriod_s = 0.1;

struct Onset {
    double shift_m = 0.0;
    int spread_frames = 1;
};

constexpr Onset kOnsets[] = {
    {0.0, 1}, {0.001, 1}, {0.003, 1}, {0.005, 1}, {0.001, 5}, {0.003, 5}, {0.005, 5}};

/// Returns the distance from the start [m] at a frame.
double shift_at_m(const Onset& onset, int frame) {
    const double part = static_cast<double>(frame - kStands + 1) / onset.spread_frames;
    return onset.shift_m * std::clamp(part, 0.0, 1.0);
}

/// A pose that stays the same during an exposure.
struct Held final : sim::Motion {
    explicit Held(const Pose& T) { state.T_world_body = T; }
    [[nodiscard]] sim::MotionState at(double) const override { return state; }
    [[nodiscard]] double duration_s() const override { return 0.0; }
    sim::MotionState state;
};

/// Camera, pose and images of one scene.
struct Stage {
    camera::StereoRig rig;  ///< rig that the odometry uses, with its calibration
    Pose T_world_body;
    sim::Renderer renderer;
    pipeline::PipelineConfig config;
    double exposure_s = 0.0;
};

Status measure(const Stage& stage, const Onset& onset, Executor& executor, fmt::ostream& out) {
    auto pipeline = pipeline::Pipeline::make(stage.config, stage.rig, executor);
    if (!pipeline) return pipeline.error();
    const int frames = onset.shift_m > 0.0 ? kStands + kAfter : kLongStand;
    const int whole = kStands + onset.spread_frames - 1;  // first frame with the whole shift
    sim::CleanPair clean;
    sim::RenderedPair images;
    Pose T_odom_start;
    int seen_after = -1;
    int begun_after = -1;
    int moved_before = 0;
    double crept_m = 0.0;
    double moved_m = 0.0;
    for (int i = 0; i < frames; ++i) {
        if (i == 0 || shift_at_m(onset, i) != shift_at_m(onset, i - 1)) {
            Pose T = stage.T_world_body;
            T.translation_m += T.rotation * Eigen::Vector3d(shift_at_m(onset, i), 0.0, 0.0);
            stage.renderer.collect(Held(T), 0.0, stage.exposure_s, executor, clean);
        }
        stage.renderer.expose(clean, {}, i, executor, images);
        StereoFrame frame;
        frame.index = i;
        frame.time_ns = ns_from_seconds(1.0 + kPeriod_s * i);
        frame.left = images.left;
        frame.right = images.right;
        if (i == 0) pipeline->align({&frame, 1}, stage.T_world_body);
        const MotionEstimate motion = pipeline->process(frame, Work::odometry).motion;
        if (i == kSettled - 1) T_odom_start = motion.T_odom_body;
        if (i < kSettled) continue;
        moved_m = (motion.T_odom_body.translation_m - T_odom_start.translation_m).norm();
        const bool stands = onset.shift_m == 0.0 || i < kStands;
        if (stands) {
            moved_before += motion.T_previous_body.translation_m.norm() > 0.0 ? 1 : 0;
            crept_m = std::max(crept_m, moved_m);
            continue;
        }
        if (begun_after < 0 && motion.T_previous_body.translation_m.norm() > 0.0)
            begun_after = i - kStands;
        if (seen_after < 0 && moved_m > 0.5 * onset.shift_m) seen_after = std::max(i - whole, 0);
    }
    out.print("{},{},{},{},{:.3f},{},{:.3f}\n",
              1e3 * onset.shift_m,
              onset.spread_frames,
              seen_after,
              begun_after,
              1e3 * (moved_m - onset.shift_m),
              moved_before,
              1e3 * crept_m);
    return {};
}

Status measure_scene(const experiments::SceneCase& now,
                     const SettingsRequest& common,
                     Executor& executor,
                     fmt::ostream& out) {
    auto settings = surefoot::load_settings(common);
    if (!settings) return settings.error();
    sim::SceneOptions& sim = settings->sim;
    if (Status seen = now.put_into(sim); !seen) return seen.error();
    sim.frames = 1;
    auto source = sim::open_scene(sim, &executor);
    if (!source) return source.error();
    const sim::SceneTruth& truth = (*source)->truth();
    const camera::StereoRig cameras = experiments::true_rig(truth.rig, sim);
    sim::CameraConfig camera = sim.camera;
    sim::apply_profile(sim.profile, sim.noise, camera);
    auto renderer = sim::Renderer::make(truth.scene, cameras, camera, sim.seed);
    if (!renderer) return renderer.error();
    const Stage stage{truth.rig,
                      truth.trajectory.front().T_world_body,
                      std::move(renderer).value(),
                      settings->pipeline,
                      camera.exposure.exposure_s};
    for (const Onset& onset : kOnsets) {
        out.print("{},{},{},", now.scene, now.seed, now.profile);
        if (Status done = measure(stage, onset, executor, out); !done) return done;
        out.flush();
    }
    return {};
}

int measure_all(const std::vector<std::string>& words) {
    if (words.size() < 2)
        return report(usage_error(
            "odometry_onset OUT.csv SCENES [FIRST_SEED [SEEDS [PROFILES [KEY=VALUE...]]]]"));
    SettingsRequest common;
    if (words.size() > 5) common.overrides.assign(words.begin() + 5, words.end());
    const auto executor = surefoot::make_executor();
    auto out = fmt::output_file(words[0]);
    out.print(
        "scene,seed,profile,shift_mm,spread_frames,seen_after,begun_after,end_mm,moved_before,"
        "crept_mm\n");
    for (const auto& now : experiments::scene_cases({words.begin() + 1, words.end()})) {
        const auto done = measure_scene(now, common, *executor, out);
        if (!done) return report(done.error());
    }
    return kExitOk;
}

}  // namespace
}  // namespace surefoot::app

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::app::measure_all({argv + 1, argv + argc});
}
