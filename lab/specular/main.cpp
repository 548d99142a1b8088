// SPDX-License-Identifier: Apache-2.0
// Does the gate stop before mirrors and glass, and does it wrongly stop where there are none? Each
// case is a simulated run of the whole pipeline with images of the fitted ZED profile. Two
// pipelines process the same frames, one with and one without the search for mirrors. With the map
// of each, the gate is asked for every movement at the last pose and at positions up to 0.6 m
// around it.
// Usage: specular OUT.csv SCENES FIRST_SEED SEEDS [FRAMES]
//   SCENES: names with commas between them. FRAMES: 0 (default) = to the end of the path.
//
// Writes OUT.csv, one line per case: scene, seed; then for the last pose (here_) and the positions
// around it (around_):
//   unsafe                          clearly dangerous movements
//   missed_before, missed_after     unsafe movements allowed without and with the search
//   safe                            clearly safe movements
//   allowed_before, allowed_after   safe movements allowed without and with the search
// and for the case:
//   panes                           number of suspected panes
//   score, correlation, ahead_m     values of the nearest pane; 0 = no pane
//   search_ms                       mean additional time per frame with the search
#include <fmt/format.h>
#include <fmt/os.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "service/console/source.hpp"
#include "studies/suite/suite_case.hpp"
#include "studies/suite/suite_verdicts.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/io/text.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/pipeline/start.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::experiments {
namespace {

constexpr double kAround_m = 0.6;

/// The pipeline of a case and its time.
struct Chain {
    std::optional<pipeline::Pipeline> pipeline;
    double ground_ms = 0.0;  ///< sum of the times of ground plane and search for mirrors

    void process(const StereoFrame& frame) {
        const FrameReport report = pipeline->process(frame, Work::full);
        ground_ms += report.stage_ms[static_cast<std::size_t>(Stage::ground)];
    }
    [[nodiscard]] app::VerdictCounts ask(const sim::SceneSource& source,
                                         const Machine& machine,
                                         const StampedPose& here,
                                         double reach_m) const {
        const auto map = std::make_unique<grid::MapSnapshot>();
        // If the snapshot fails, it is not intact and the gate refuses it.
        [[maybe_unused]] const Status taken = pipeline->snapshot(0, *map);
        return app::compare_verdicts(source.truth(), here, machine, *map, reach_m).counts;
    }
};

struct CaseResult {
    app::VerdictCounts before[2];  ///< counts at the last pose, and around it
    app::VerdictCounts after[2];
    std::vector<specular::SuspectedPane> panes;
    Eigen::Vector2d body_m = Eigen::Vector2d::Zero();
    double search_ms = 0.0;
};

Result<Chain> make_chain(const Settings& settings,
                         const sim::SceneSource& source,
                         bool search,
                         Executor& executor) {
    pipeline::PipelineConfig config = app::config_on(source.truth(), settings);
    config.specular.enabled = search;
    auto pipeline = pipeline::Pipeline::make(config, source.rig(), executor, steady_now_ns);
    if (!pipeline) return pipeline.error();
    return Chain{std::move(*pipeline), 0.0};
}

Result<CaseResult> run_case(const std::string& scene,
                            std::uint64_t seed,
                            int most_frames,
                            const Settings& settings,
                            const Machine& machine) {
    Serial serial;
    sim::SceneOptions sim = settings.sim;
    sim.scene = scene;
    sim.seed = seed;
    sim.frames = most_frames;
    sim.profile = sim::CameraProfile::zed;
    auto source = sim::open_scene(sim, &serial);
    if (!source) return source.error();
    auto without = make_chain(settings, **source, false, serial);
    if (!without) return without.error();
    auto with = make_chain(settings, **source, true, serial);
    if (!with) return with.error();

    std::optional<Error> failed;
    std::vector<StereoFrame> first;  // The second chain starts with the same frames.
    const pipeline::NextFrame next = [&]() -> std::optional<StereoFrame> {
        auto frame = (*source)->next();
        if (!frame) failed = frame.error();
        return frame ? std::move(*frame) : std::nullopt;
    };
    const auto& begin = (*source)->info().T_odom_first_body;
    const pipeline::Start start = align_when_ready(*without->pipeline, next, begin);
    with->pipeline->align(start.frames, begin);
    int frames = 0;
    std::int64_t last_ns = 0;
    const auto process = [&](const StereoFrame& frame) {
        without->process(frame);
        with->process(frame);
        ++frames;
        last_ns = frame.time_ns;
    };
    for (const StereoFrame& frame : start.frames) process(frame);
    for (auto frame = next(); frame; frame = next()) process(*frame);
    if (failed) return *failed;
    if (frames == 0)
        return input_error(scene + ": no frame was processed; check the scene's motion");

    CaseResult result;
    StampedPose here;
    for (const StampedPose& pose : (*source)->truth().trajectory)
        if (pose.time_ns <= last_ns) here = pose;
    for (int i = 0; i < 2; ++i) {
        const double reach_m = i == 0 ? 0.0 : kAround_m;
        result.before[i] = without->ask(**source, machine, here, reach_m);
        result.after[i] = with->ask(**source, machine, here, reach_m);
    }
    const auto panes = with->pipeline->panes();
    result.panes.assign(panes.begin(), panes.end());
    result.body_m = with->pipeline->T_odom_body().translation_m.head<2>();
    result.search_ms = (with->ground_ms - without->ground_ms) / frames;
    return result;
}

void print_counts(fmt::ostream& out,
                  const app::VerdictCounts& before,
                  const app::VerdictCounts& after) {
    out.print(",{},{},{},{},{},{}",
              before.unsafe,
              before.unsafe_ok,
              after.unsafe_ok,
              before.safe,
              before.safe_ok,
              after.safe_ok);
}

void print_case(fmt::ostream& out,
                const std::string& scene,
                std::uint64_t seed,
                const CaseResult& result) {
    out.print("{},{}", scene, seed);
    for (int i = 0; i < 2; ++i) print_counts(out, result.before[i], result.after[i]);
    specular::SuspectedPane nearest;
    double ahead_m = 0.0;
    for (const specular::SuspectedPane& pane : result.panes) {
        const double here_m = pane.offset_m - pane.normal.dot(result.body_m);
        if (nearest.score > 0.0 && here_m > ahead_m) continue;
        nearest = pane;
        ahead_m = here_m;
    }
    out.print(",{},{:.1f},{:.3f},{:.2f},{:.2f}\n",
              result.panes.size(),
              nearest.score,
              nearest.correlation,
              ahead_m,
              result.search_ms);
    out.flush();
}

int measure(const std::vector<std::string>& words) {
    if (words.size() != 4 && words.size() != 5) {
        fmt::print(stderr, "usage: specular OUT.csv SCENES FIRST_SEED SEEDS [FRAMES]\n");
        return 2;
    }
    const auto settings = surefoot::load_settings();
    const auto machine = app::load_machine("rex");
    if (!settings || !machine || !*machine) return 1;
    const std::uint64_t first = std::strtoull(words[2].c_str(), nullptr, 10);
    const std::uint64_t seeds = std::strtoull(words[3].c_str(), nullptr, 10);
    const int frames = words.size() == 5 ? std::atoi(words[4].c_str()) : 0;
    auto out = fmt::output_file(words[0]);
    out.print("scene,seed");
    for (const char* place : {"here", "around"})
        for (const char* name :
             {"unsafe", "missed_before", "missed_after", "safe", "allowed_before", "allowed_after"})
            out.print(",{}_{}", place, name);
    out.print(",panes,score,correlation,ahead_m,search_ms\n");
    for (const std::string_view scene : io::split(words[1], ",")) {
        for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
            const auto result =
                run_case(std::string(scene), seed, frames, *settings, (*machine)->machine);
            if (!result) {
                fmt::print(stderr, "{} {}: {}\n", scene, seed, result.error().message);
                return 1;
            }
            print_case(out, std::string(scene), seed, *result);
        }
    }
    return 0;
}

}  // namespace
}  // namespace surefoot::experiments

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::experiments::measure({argv + 1, argv + argc});
}
