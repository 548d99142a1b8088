// SPDX-License-Identifier: Apache-2.0
// How accurate is the ground plane that aligns odom at the start, and the plane of single frames?
// Usage: ground_truth OUT.csv SCENES [FIRST_SEED [SEEDS [PROFILES [FRAMES [KEY=VALUE...]]]]]
//   ground_truth out/ground.csv floor,demo_stairs 20001 3 ideal,zed
//   SCENES to PROFILES: see scene_cases.hpp. FRAMES: 0 (default) = to the end of the path.
//   KEY=VALUE: a setting of surefoot.
//
// Writes OUT.csv, one line per scene, seed and profile:
//   source                 source of odom's alignment: plane, imu or assumed
//   tilt_deg, height_mm    errors of odom's z axis and of the height of base_link above the ground,
//                          from the first ten frames
//   waited_s               time from the first frame of the scene to the first of these frames
//   frames, accepted       later frames, and those with an accepted plane
//   tilt_p50_deg, tilt_p90_deg, height_p50_mm, height_p90_mm   errors of the accepted planes
//                          against the ground under base_link
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "lab/scenes/scene_cases.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/pipeline/start.hpp"
#include "surefoot/sim/rendering/ray_caster.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {
namespace {

constexpr const char* kSources[] = {"assumed", "plane", "imu"};  // order of GravitySource

using experiments::SceneCase;

double between_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return std::nan("");
    const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(
        values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
    return values[at];
}

/// True up direction in base_link, and the true height [m] of base_link above the ground along
/// gravity.
struct Truth {
    Eigen::Vector3d up_body;
    double height_m = 0.0;
};

Truth truth_of(const sim::SceneTruth& truth, const Pose& T_world_body) {
    const sim::Lattice under{
        T_world_body.translation_m.head<2>() - Eigen::Vector2d::Constant(0.05), 3, 3, 0.1 / 3.0};
    const auto dem_m = sim::dem(truth.scene, under);
    return {T_world_body.rotation.conjugate() * Eigen::Vector3d::UnitZ(),
            T_world_body.translation_m.z() - static_cast<double>(dem_m.at(1, 1))};
}

Status measure(const SceneCase& now,
               int frames,
               const SettingsRequest& common,
               Executor& executor,
               fmt::ostream& out) {
    auto settings = surefoot::load_settings(common);
    if (!settings) return settings.error();
    sim::SceneOptions& sim = settings->sim;
    if (Status seen = now.put_into(sim); !seen) return seen.error();
    sim.frames = frames;
    auto source = sim::open_scene(sim, &executor);
    if (!source) return source.error();
    auto pipeline = pipeline::Pipeline::make(settings->pipeline, (*source)->rig(), executor);
    if (!pipeline) return pipeline.error();

    const sim::SceneTruth& truth = (*source)->truth();
    std::vector<double> tilts_deg;
    std::vector<double> heights_mm;
    int judged = 0;
    std::optional<Error> failed;
    const pipeline::NextFrame next = [&]() -> std::optional<StereoFrame> {
        auto frame = (*source)->next();
        if (!frame) failed = frame.error();
        return frame ? std::move(frame).value() : std::nullopt;
    };
    const pipeline::Start start = pipeline::align_when_ready(*pipeline, next);
    for (const StereoFrame& frame : start.frames)
        static_cast<void>(pipeline->process(frame, Work::full));
    while (const auto frame = next()) {
        const FrameReport report = pipeline->process(*frame, Work::full);
        const Truth here =
            truth_of(truth, experiments::true_pose(truth.trajectory, frame->time_ns));
        ++judged;
        if (!report.ground.accepted) continue;
        tilts_deg.push_back(between_deg(report.ground.normal, here.up_body));
        heights_mm.push_back(1e3 * std::abs(report.ground.height_m - here.height_m));
    }
    if (failed) return *failed;
    const pipeline::Alignment& alignment = pipeline->alignment();
    const std::int64_t placed_ns = start.frames.front().time_ns;
    const Truth first = truth_of(truth, experiments::true_pose(truth.trajectory, placed_ns));
    out.print("{},{},{},{},{:.3f},{:.2f},{:.1f},{},{},{:.3f},{:.3f},{:.2f},{:.2f}\n",
              now.scene,
              now.seed,
              now.profile,
              kSources[static_cast<int>(alignment.gravity_source)],
              between_deg(alignment.T_odom_body.rotation.conjugate() * Eigen::Vector3d::UnitZ(),
                          first.up_body),
              1e3 * (alignment.ground_height_m - first.height_m),
              seconds_from_ns(placed_ns - truth.trajectory.front().time_ns),
              judged,
              tilts_deg.size(),
              quantile(tilts_deg, 0.5),
              quantile(tilts_deg, 0.9),
              quantile(heights_mm, 0.5),
              quantile(heights_mm, 0.9));
    out.flush();
    return {};
}

int measure_all(const std::vector<std::string>& words) {
    if (words.size() < 2)
        return report(
            usage_error("ground_truth OUT.csv SCENES [FIRST_SEED [SEEDS [PROFILES [FRAMES "
                        "[KEY=VALUE...]]]]]"));
    const int frames = words.size() > 5 ? std::atoi(words[5].c_str()) : 0;
    SettingsRequest common;
    if (words.size() > 6) common.overrides.assign(words.begin() + 6, words.end());
    const auto executor = surefoot::make_executor();
    auto out = fmt::output_file(words[0]);
    out.print(
        "scene,seed,profile,source,tilt_deg,height_mm,waited_s,frames,accepted,tilt_p50_deg,tilt_"
        "p90_deg,"
        "height_p50_mm,height_p90_mm\n");
    for (const SceneCase& now : experiments::scene_cases({words.begin() + 1, words.end()})) {
        const auto done = measure(now, frames, common, *executor, out);
        if (!done) return report(done.error());
    }
    return kExitOk;
}

}  // namespace
}  // namespace surefoot::app

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::app::measure_all({argv + 1, argv + argc});
}
