// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>

#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "studies/runs/run_session.hpp"
#include "studies/suite/suite_depth.hpp"
#include "studies/suite/suite_verdicts.hpp"
#include "surefoot/core/assert.hpp"
#include "surefoot/eval/report/picture.hpp"

namespace surefoot::app {
namespace {

double share(int part, int whole) {
    return whole > 0 ? static_cast<double>(part) / whole : std::nan("");
}

/// Returns a count, or NaN if no question was asked.
double among(int part, std::size_t whole) {
    return whole > 0 ? static_cast<double>(part) : std::nan("");
}

std::vector<double> figures_of(const RunRecord& record,
                               double depth_auc,
                               const VerdictCounts& around,
                               std::span<const SuiteStep> asked) {
    const TruthFigures& t = *record.truth;
    const auto healthy =
        std::count_if(record.frames.begin(), record.frames.end(), [](const FrameReport& frame) {
            return frame.motion.health == Health::ok;
        });
    const VerdictCounts steps = count_verdicts(asked);
    return {static_cast<double>(record.frames.size()),
            static_cast<double>(healthy) / static_cast<double>(record.frames.size()),
            t.trajectory.ate_rmse_m,
            t.trajectory.drift_percent,
            t.maps.elevation.median_abs_m,
            t.maps.elevation.p90_abs_m,
            t.maps.elevation_away_from_edges.share_over_50mm,
            t.maps.sigma.within_1_sigma,
            t.maps.sigma.within_2_sigma,
            t.maps.sigma.within_3_sigma,
            t.maps.edges.p99_abs,
            t.maps.floor.spread_m,
            t.coverage_within_2_5_m,
            t.traversability.false_safe,
            t.traversability.false_unsafe,
            t.depth.within_1_sigma,
            t.depth.within_3_sigma,
            t.depth.median_abs_error_px,
            depth_auc,
            static_cast<double>(around.safe + around.unsafe),
            static_cast<double>(around.safe),
            static_cast<double>(around.unsafe_ok),
            static_cast<double>(around.borderline_missed),
            share(around.safe_ok, around.safe),
            static_cast<double>(around.seen),
            share(around.seen_ok, around.seen),
            static_cast<double>(around.body_seen),
            share(around.body_seen_ok, around.body_seen),
            static_cast<double>(asked.size()),
            among(steps.unsafe_ok, asked.size()),
            among(steps.borderline_missed, asked.size()),
            share(steps.safe_ok, steps.safe),
            among(steps.seen, asked.size()),
            share(steps.seen_ok, steps.seen)};
}

std::vector<std::uint8_t> thumbnail_of(const RunRecord& record,
                                       const pipeline::Pipeline& pipeline) {
    eval::Overlays overlays;
    overlays.scale_bar = true;
    for (const FrameReport& frame : record.frames)
        overlays.trajectory_m.emplace_back(frame.motion.T_odom_body.translation_m.head<2>());
    overlays.T_odom_body = record.frames.back().motion.T_odom_body;
    return eval::encode_png(eval::render_confusion_thumbnail(
        pipeline.map().geometry(), record.truth->maps.calls, overlays));
}

/// A simulated run of the pipeline that asks the gate along the path.
class CaseRun {
  public:
    CaseRun(const SuiteConditions& conditions,
            pipeline::Pipeline& pipeline,
            sim::SceneSource& source)
        : conditions_(conditions),
          pipeline_(pipeline),
          source_(source),
          steps_(source.truth(), conditions.machine) {}

    [[nodiscard]] Result<SuiteResult> finish(const SuiteCase& which) {
        RunSession session(pipeline_, source_, source_.rig(), 1, conditions_.settings.maps);
        session.drive("", [&](const FrameReport& frame) { after(frame); });
        const RunRecord& record = session.record();
        if (record.error) return *record.error;
        if (!record.truth) {
            return input_error(
                which.name() +
                ": the machine moved before the odom frame was set; start the run at standstill");
        }
        if (auto status = take_snapshot(); !status) return status.error();
        const StampedPose& here = source_.truth().trajectory[record.frames.size() - 1];
        const AroundAnswers around = compare_verdicts(
            source_.truth(), here, conditions_.machine, *snapshot_, conditions_.reach_m);
        for (const std::string& sentence : around.missed)
            log_warning(fmt::format("{}: {}", which.name(), sentence));
        return SuiteResult{which,
                           figures_of(record, depth_.auc(), around.counts, steps_.steps()),
                           bins_of(record.truth->maps),
                           steps_.steps(),
                           around.tallies,
                           thumbnail_of(record, pipeline_)};
    }

  private:
    void after(const FrameReport& frame) {
        depth_.after_frame(frame, source_, pipeline_);
        while (steps_.due(frame.time_ns)) {
            // If the snapshot fails, it is not intact and the gate refuses it.
            [[maybe_unused]] const Status taken = take_snapshot();
            steps_.ask(*snapshot_);
        }
    }
    [[nodiscard]] Status take_snapshot() {
        return pipeline_.snapshot(hash_of(conditions_.settings), *snapshot_);
    }

    const SuiteConditions& conditions_;
    pipeline::Pipeline& pipeline_;
    sim::SceneSource& source_;
    StepQuestions steps_;
    DepthOrder depth_;
    std::unique_ptr<grid::MapSnapshot> snapshot_ = std::make_unique<grid::MapSnapshot>();
};

}  // namespace

pipeline::PipelineConfig config_on(const sim::SceneTruth& truth, const Settings& settings) {
    pipeline::PipelineConfig config = settings.pipeline;
    const Eigen::Vector3d& start_m = truth.trajectory.front().T_world_body.translation_m;
    const auto ground = truth.scene.height_at(start_m.x(), start_m.y());
    if (config.ground.expected_height_m == 0.0 && ground)
        config.ground.expected_height_m = start_m.z() - ground->z_m;
    return config;
}

sim::MotionModelChoice motion_model_choice(const std::string& name) {
    const auto at = std::find(
        std::begin(sim::kMotionModelChoiceNames), std::end(sim::kMotionModelChoiceNames), name);
    SUREFOOT_ASSERT(at != std::end(sim::kMotionModelChoiceNames));
    return static_cast<sim::MotionModelChoice>(at - std::begin(sim::kMotionModelChoiceNames));
}

std::string SuiteCase::name() const {
    return fmt::format("{}/{}/seed {}/noise {:g}", scene, motion_model, seed, noise);
}

const std::vector<SuiteFigure>& suite_figures() {
    using enum FigureKind;
    static const std::vector<SuiteFigure> all = {
        {"frames", "Motion", count, false, "number of processed frames"},
        {"healthy", "Motion", share, false, "share of the frames with odometry OK"},
        {"ate_rmse_m", "Motion", length_m, true, "trajectory error (rmse) without alignment"},
        {"drift_percent", "Motion", percent, true, "drift in percent of the path length"},
        {"height_median_m", "Heights", length_m, true, "median |height error|"},
        {"height_p90_m", "Heights", length_m, true, "90th percentile of |height error|"},
        {"share_over_50mm",
         "Heights",
         share,
         true,
         "share of the heights away from edges with an error above 50 mm"},
        {"height_1_sigma",
         "Heights",
         share,
         false,
         "share of the height errors away from edges within 1 sigma of the map"},
        {"height_2_sigma",
         "Heights",
         share,
         false,
         "share of the height errors away from edges within 2 sigma"},
        {"height_3_sigma",
         "Heights",
         share,
         false,
         "share of the height errors away from edges within 3 sigma"},
        {"edges_p99_m",
         "Ground",
         length_m,
         true,
         "99th percentile of the height steps between neighbouring cells of level floor"},
        {"floor_spread_m", "Ground", length_m, true, "scatter of level floor about its plane"},
        {"coverage",
         "Ground",
         share,
         false,
         "known share of the ground that both cameras saw within 2.5 m"},
        {"false_safe", "Ground", share, true, "share of the truly unsafe cells called safe"},
        {"false_unsafe", "Ground", share, true, "share of the truly safe cells called unsafe"},
        {"depth_1_sigma", "Depth", share, false, "share of the depths within 1 sigma"},
        {"depth_3_sigma", "Depth", share, false, "share of the depths within 3 sigma"},
        {"disparity_error_px", "Depth", pixels, true, "median |disparity error|"},
        {"depth_auc",
         "Depth",
         number,
         true,
         "sparsification of sigma (0 = perfect order, 1 = chance)"},
        {"questions", "Gate", count, false, "clear-cut questions at the end of the path"},
        {"safe_questions", "Gate", count, false, "truly safe movements among these questions"},
        {"missed_hazards",
         "Gate",
         count,
         true,
         "clearly dangerous movements that the gate allowed"},
        {"borderline_missed",
         "Gate",
         count,
         true,
         "allowed movements that are dangerous by less than the margin of the oracle"},
        {"allowed", "Gate", share, false, "allowed share of the clearly safe movements"},
        {"seen_questions",
         "Gate",
         count,
         false,
         "clearly safe movements whose feet, ways and drop bands both cameras saw on the way"},
        {"allowed_of_seen", "Gate", share, false, "allowed share of these movements"},
        {"body_seen_questions",
         "Gate",
         count,
         false,
         "movements of which the ground below the body was in view too"},
        {"allowed_of_body_seen", "Gate", share, false, "allowed share of these movements"},
        {"steps", "Gate", count, false, "steps that the walking user requested"},
        {"steps_missed", "Gate", count, true, "clearly dangerous steps that the gate allowed"},
        {"steps_borderline_missed",
         "Gate",
         count,
         true,
         "allowed steps that are dangerous by less than the margin of the oracle"},
        {"steps_allowed", "Gate", share, false, "allowed share of the clearly safe steps"},
        {"steps_seen",
         "Gate",
         count,
         false,
         "clearly safe steps whose feet, ways and drop bands both cameras saw on the way"},
        {"steps_allowed_of_seen", "Gate", share, false, "allowed share of these steps"},
    };
    return all;
}

double SuiteResult::figure(std::string_view name) const {
    const auto& all = suite_figures();
    const auto at =
        std::find_if(all.begin(), all.end(), [&](const SuiteFigure& f) { return name == f.name; });
    SUREFOOT_ASSERT(at != all.end());
    return figures[static_cast<std::size_t>(at - all.begin())];
}

bool is_worse(const SuiteResult& a, const SuiteResult& b) {
    const auto badness = [](const SuiteResult& result) {
        const auto of = [&](std::string_view name) {
            const double value = result.figure(name);
            return std::isnan(value) ? 0.0 : value;
        };
        return std::make_tuple(of("missed_hazards") + of("steps_missed"),
                               of("false_safe"),
                               of("height_p90_m"),
                               result.which.name(),
                               result.which.max_frames);
    };
    return badness(a) > badness(b);
}

Result<SuiteResult> run_suite_case(const SuiteCase& which, const SuiteConditions& conditions) {
    const Settings& settings = conditions.settings;
    SourceRequest request{
        which.scene, conditions.rig, which.rate_hz, which.max_frames, which.seed, settings.sim};
    request.sim.noise *= which.noise;
    request.sim.motion_model = motion_model_choice(which.motion_model);
    Serial serial;
    auto source = open_simulation(request, serial);
    if (!source) return source.error();
    auto pipeline = pipeline::Pipeline::make(
        config_on((*source)->truth(), settings), (*source)->rig(), serial, steady_now_ns);
    if (!pipeline) return pipeline.error();
    return CaseRun(conditions, *pipeline, **source).finish(which);
}

}  // namespace surefoot::app
