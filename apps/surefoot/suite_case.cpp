// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/suite_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "apps/surefoot/run_output.hpp"
#include "apps/surefoot/run_session.hpp"
#include "apps/surefoot/source.hpp"
#include "apps/surefoot/suite_verdicts.hpp"

namespace surefoot::app {
namespace {

/// The chain's settings. How high base_link is over its own ground is known of every carrier: it is
/// built so (the trolley is 4 cm lower than the walking machine).
pipeline::PipelineConfig config_on(const sim::SceneTruth& truth, const Settings& settings) {
    pipeline::PipelineConfig config = settings.pipeline;
    const Eigen::Vector3d& start_m = truth.trajectory.front().T_world_body.translation_m;
    const auto ground = truth.scene.height_at(start_m.x(), start_m.y());
    if (config.ground.expected_height_m == 0.0 && ground)
        config.ground.expected_height_m = start_m.z() - ground->z_m;
    return config;
}

double share(int part, int whole) {
    return whole > 0 ? static_cast<double>(part) / whole : std::nan("");
}

/// How far around the last pose the gate is asked.
constexpr double kVerdictReach_m = 0.8;

std::vector<double> figures_of(const RunRecord& record, const VerdictCounts& verdicts) {
    const TruthFigures& t = *record.truth;
    const auto healthy =
        std::count_if(record.frames.begin(), record.frames.end(), [](const FrameReport& frame) {
            return frame.motion.health == Health::ok;
        });
    return {static_cast<double>(record.frames.size()),
            static_cast<double>(healthy) / static_cast<double>(record.frames.size()),
            t.trajectory.ate_rmse_m,
            t.trajectory.drift_percent,
            t.maps.elevation.median_abs_m,
            t.maps.elevation.p90_abs_m,
            t.maps.elevation_away_from_edges.share_over_50mm,
            t.maps.sigma.within_1_sigma,
            t.maps.sigma.within_3_sigma,
            t.maps.edges.p99_abs,
            t.maps.floor.spread_m,
            t.coverage_within_2_5_m,
            t.traversability.false_safe,
            t.traversability.false_unsafe,
            t.depth.within_1_sigma,
            t.depth.within_3_sigma,
            t.depth.median_abs_error_px,
            static_cast<double>(verdicts.safe + verdicts.unsafe),
            static_cast<double>(verdicts.unsafe_ok),
            static_cast<double>(verdicts.borderline_missed),
            share(verdicts.safe_ok, verdicts.safe)};
}

}  // namespace

std::string SuiteCase::name() const {
    return fmt::format("{}/seed {}/noise {:g}", scene, seed, noise);
}

const std::vector<SuiteFigure>& suite_figures() {
    static const std::vector<SuiteFigure> all = {
        {"frames", "", false, "frames that were processed"},
        {"healthy", "", false, "share of frames with odometry OK"},
        {"ate_rmse_m", "m", true, "trajectory error, not aligned"},
        {"drift_percent", "%", true, "of the way"},
        {"height_median_m", "m", true, "median |height error|"},
        {"height_p90_m", "m", true, "90 % of |height error|"},
        {"share_over_50mm", "", true, "of the cells away from edges"},
        {"height_1_sigma", "", false, "heights within 1 sigma of the map"},
        {"height_3_sigma", "", false, "heights within 3 sigma of the map"},
        {"edges_p99_m", "m", true, "99 % of the jumps between neighbours on level floor"},
        {"floor_spread_m", "m", true, "scatter of level floor about its plane"},
        {"coverage", "", false, "known of what both eyes saw within 2.5 m"},
        {"false_safe", "", true, "truly unsafe cells called safe"},
        {"false_unsafe", "", true, "truly safe cells called unsafe"},
        {"depth_1_sigma", "", false, "depths within 1 sigma"},
        {"depth_3_sigma", "", false, "depths within 3 sigma"},
        {"disparity_error_px", "px", true, "median |disparity error|"},
        {"questions", "", false, "clear-cut questions that the gate was asked at the end"},
        {"missed_hazards", "", true, "clearly dangerous, and the gate said OK"},
        {"borderline_missed", "", true, "dangerous by less than the margin, and OK"},
        {"allowed", "", false, "share of the clearly safe movements that the gate allowed"},
    };
    return all;
}

Result<SuiteResult> run_suite_case(const SuiteCase& which,
                                   const Settings& settings,
                                   const io::MachineFile& machine,
                                   Executor& executor,
                                   const std::string& progress_label) {
    SourceRequest request{which.scene, "", 0.0, which.max_frames, which.seed, settings.sim};
    request.sim.noise *= which.noise;
    auto source = open_simulation(request, executor);
    if (!source) return source.error();
    auto pipeline = pipeline::Pipeline::make(
        config_on((*source)->truth(), settings), (*source)->rig(), executor, steady_now_ns);
    if (!pipeline) return pipeline.error();
    RunSession session(*pipeline, **source, (*source)->rig(), 1, settings.maps);
    session.drive(progress_label);
    const RunRecord& record = session.record();
    if (record.error) return *record.error;
    const auto snapshot = std::make_unique<grid::MapSnapshot>();
    if (auto status = pipeline->snapshot(hash_of(settings), *snapshot); !status)
        return status.error();
    const Pose T_world_body = (*source)->truth().trajectory[record.frames.size() - 1].T_world_body;
    const VerdictCounts verdicts = compare_verdicts(
        (*source)->truth(), T_world_body, machine.machine, *snapshot, kVerdictReach_m);
    return SuiteResult{which, figures_of(record, verdicts)};
}

}  // namespace surefoot::app
