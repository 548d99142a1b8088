// SPDX-License-Identifier: Apache-2.0
#include "studies/lange2016/eval_thesis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <mutex>
#include <optional>
#include <set>

#include "service/console/interrupt.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "service/console/writes.hpp"
#include "studies/lange2016/thesis_case.hpp"
#include "studies/lange2016/thesis_report.hpp"
#include "studies/simulation/scan.hpp"
#include "studies/suite/suite_options.hpp"
#include "studies/suite/suite_progress.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/fnv1a.hpp"
#include "surefoot/core/nearest_names.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/sim/scenes/scenes.hpp"

namespace surefoot::app {
namespace {

/// A part of the report. It is computed once, and its figures are stored in its folder.
struct Part {
    std::string name;
    std::string folder;
    std::uint64_t conditions = 0;
    int weight = 1;  ///< relative duration of the part, for the progress display
    std::function<Result<ThesisFigures>()> work;
    std::function<void(const ThesisFigures&)> keep;
};

Result<std::vector<ThesisRun>> chosen_runs(const EvalSuiteOptions& options) {
    const auto all = thesis_runs();
    if (options.runs.empty()) return std::vector<ThesisRun>(all.begin(), all.end());
    std::vector<std::string> names;
    for (const ThesisRun& run : all) names.emplace_back(run.name);
    std::vector<ThesisRun> runs;
    for (const std::string& name : options.runs) {
        const auto at = std::find(names.begin(), names.end(), name);
        if (at == names.end()) {
            return usage_error(
                fmt::format("--runs {}: there is no such experiment{} (choose from: {})",
                            name,
                            did_you_mean(name, names),
                            fmt::join(names, ", ")));
        }
        runs.push_back(all[static_cast<std::size_t>(at - names.begin())]);
    }
    return runs;
}

Result<ThesisConditions> conditions_of(const EvalSuiteOptions& options) {
    auto settings = load_settings(options.common);
    if (!settings) return settings.error();
    const auto profile = std::find(
        std::begin(sim::kCameraProfileNames), std::end(sim::kCameraProfileNames), options.camera);
    settings->sim.profile =
        static_cast<sim::CameraProfile>(profile - std::begin(sim::kCameraProfileNames));
    const auto machine = load_machine(options.machine);
    if (!machine) return machine.error();
    if (!*machine)
        return usage_error(
            "--machine is empty: give a machine file, or the name of a built-in machine, for "
            "example rex");
    // Doubles the angle between beams in both directions, so the scan takes a quarter of the time.
    // There is still a point every 5 mm within 4 m of a station. `sim --scan` uses all beams.
    settings->laser.step_deg *= 2.0;
    return ThesisConditions{std::move(*settings),
                            machine->value().machine,
                            options.common.seed,
                            options.frames,
                            options.out_dir};
}

/// Computes the parts that are not stored yet. `executor` determines how many parts run at a time.
/// All errors except an interrupt by the user are logged and added to the results. The first error
/// is returned.
class Parts {
  public:
    Parts(ThesisResults& results, Executor& executor) : results_(results), executor_(executor) {}

    [[nodiscard]] Status run(const std::vector<Part>& parts) {
        std::vector<const Part*> missing;
        std::int64_t weight = 0;
        for (const Part& part : parts) {
            const auto known = read_figures(part.folder, part.conditions);
            if (!known) return known.error();
            if (*known) {
                part.keep(**known);
                continue;
            }
            missing.push_back(&part);
            weight += part.weight;
        }
        progress_.emplace(missing.size(), weight);
        executor_.parallel_for(static_cast<int>(missing.size()),
                               [&](int i) { do_one(*missing[static_cast<std::size_t>(i)]); });
        progress_.reset();
        return first_error_ ? Status(*first_error_) : Status();
    }

  private:
    void do_one(const Part& part) {
        if (interrupted()) return;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            progress_->started(part.name);
        }
        auto figures = part.work();
        if (figures) {
            if (auto status = write_figures(part.folder, part.conditions, *figures); !status)
                figures = status.error();
        }
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!figures) return fail(part.name, figures.error());
        part.keep(*figures);
        progress_->finished(part.name, part.weight);
    }

    void fail(const std::string& name, const Error& error) {
        const bool stopped = error.code == ErrorCode::interrupted;
        const Error named{error.code,
                          stopped ? "interrupted by the user; repeat the same call to continue"
                                  : fmt::format("{}: {}", name, error.message)};
        if (!stopped) {
            log_error(named.message);
            results_.failures.push_back(named.message);
        }
        if (!first_error_) first_error_ = named;
    }

    ThesisResults& results_;
    Executor& executor_;
    std::mutex mutex_;
    std::optional<SuiteProgress> progress_;
    std::optional<Error> first_error_;
};

/// Returns a hash of the objects and the lighting of a simulated scene. The hash shows whether
/// another version of the program makes another scene from the same seed.
std::uint64_t hash_of_place(const std::string& scene, const ThesisConditions& conditions) {
    const auto script = sim::make_scene(scene, conditions.seed);
    if (!script) return 0;
    const sim::Scene& place = script->scene;
    const sim::Lighting& light = place.lighting();
    std::uint64_t hash = fnv1a(fmt::format("{} {} {} {} {} {} {}",
                                           light.ambient,
                                           light.lamp,
                                           light.lamp_azimuth_deg,
                                           light.lamp_elevation_deg,
                                           light.stripe_width_m,
                                           light.stripe_gap_m,
                                           light.stripe_yaw_deg));
    for (int i = 0; i < place.primitives(); ++i) {
        for (const Eigen::Vector3d& p_m : place.hull(i))
            hash = fnv1a(fmt::format("{} {} {}", p_m.x(), p_m.y(), p_m.z()), hash);
    }
    for (const sim::Material& material : place.materials()) {
        hash = fnv1a(fmt::format("{} {} {} {}",
                                 static_cast<int>(material.pattern),
                                 material.albedo,
                                 material.contrast,
                                 static_cast<int>(material.finish)),
                     hash);
    }
    for (const Eigen::Vector3d& p_m : script->stations_m)
        hash = fnv1a(fmt::format("{} {} {}", p_m.x(), p_m.y(), p_m.z()), hash);
    return hash;
}

/// Returns a hash of all conditions that affect the figures of a part.
std::uint64_t hash_for(const ThesisConditions& conditions,
                       const std::string& part,
                       std::uint64_t place) {
    return fnv1a(fmt::format("{} {} {} {}", part, conditions.seed, conditions.max_frames, place),
                 hash_of(conditions.settings));
}

std::vector<Part> scans_of(const std::vector<ThesisRun>& runs,
                           bool courtyard,
                           const ThesisConditions& conditions,
                           ThesisResults& results) {
    // Each scan uses one thread; the scans of different scenes run in parallel.
    constexpr int kScan = 100;
    std::vector<Part> parts;
    std::set<std::string> scenes;
    for (const ThesisRun& run : runs) {
        if (!scenes.insert(run.scene).second) continue;
        parts.push_back({fmt::format("laser scan of {}", run.scene),
                         conditions.scan_folder(run.scene),
                         hash_for(conditions, run.scene, hash_of_place(run.scene, conditions)),
                         kScan,
                         [&, run] { return scan_of_run(run, conditions, serial()); },
                         [&, run](const ThesisFigures& f) { results.scans[run.scene] = f; }});
    }
    if (courtyard) {
        parts.push_back(
            {"laser scan of the courtyard",
             conditions.scan_folder(kThesisCourtyard),
             hash_for(conditions, kThesisCourtyard, hash_of_place(kThesisCourtyard, conditions)),
             3 * kScan,
             [&] { return scan_of_courtyard(conditions, serial()); },
             [&](const ThesisFigures& f) { results.courtyard = f; }});
    }
    return parts;
}

int frames_of(const ThesisRun& run, const ThesisConditions& conditions) {
    const auto script = sim::make_scene(
        run.scene, conditions.seed, sim::motion_model_of(motion_model_choice(run.motion_model)));
    if (!script) return 1;
    const double last = std::floor(script->motion->duration_s() * run.rate_hz);
    const int all = saturated_integer<int>(last + 1.0);
    return conditions.max_frames > 0 ? std::min(all, conditions.max_frames) : all;
}

std::vector<Part> recordings_of(const std::vector<ThesisRun>& runs,
                                const ThesisConditions& conditions,
                                ThesisResults& results) {
    std::vector<Part> parts;
    for (const ThesisRun& run : runs) {
        const std::uint64_t place = hash_of_place(run.scene, conditions);
        const int frames = frames_of(run, conditions);
        for (const ThesisColumn column : {ThesisColumn::ours, ThesisColumn::thesis}) {
            const auto i = static_cast<std::size_t>(column);
            parts.push_back(
                {fmt::format("{}, {}", run.name, kThesisColumnNames[i]),
                 conditions.run_folder(run, column),
                 hash_for(conditions, fmt::format("{}/{}", run.name, kThesisColumnNames[i]), place),
                 frames,
                 [&, run, column] { return live_run(run, column, conditions); },
                 [&, run, i](const ThesisFigures& f) { results.runs[run.name][i] = f; }});
        }
    }
    std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
        return a.weight > b.weight;
    });
    return parts;
}

/// Returns the extent of all objects of a scene, ground included, along x and y [m].
Eigen::Vector2d size_of(const sim::Scene& scene) {
    Eigen::Vector2d low_m = Eigen::Vector2d::Constant(1e9);
    Eigen::Vector2d high_m = -low_m;
    for (int i = 0; i < scene.primitives(); ++i) {
        for (const Eigen::Vector3d& p_m : scene.hull(i)) {
            low_m = low_m.cwiseMin(p_m.head<2>());
            high_m = high_m.cwiseMax(p_m.head<2>());
        }
    }
    return high_m - low_m;
}

Status describe_datasets(const ThesisConditions& conditions,
                         Executor& executor,
                         ThesisResults& results) {
    for (const ThesisDataset& dataset : thesis_datasets()) {
        const auto script = sim::make_scene(dataset.scene, conditions.seed);
        if (!script) return script.error();
        const auto stations_m = stations_of(*script);
        const sim::LaserScannerConfig full;  // full resolution; the scans of the report are coarser
        const auto points = expected_points(script->scene, full, stations_m, executor);
        if (!points) return points.error();
        const Eigen::Vector2d size_m = size_of(script->scene);
        results.datasets.push_back({dataset,
                                    size_m.x(),
                                    size_m.y(),
                                    script->solids,
                                    static_cast<int>(stations_m.size()),
                                    *points});
    }
    return {};
}

}  // namespace

int eval_thesis(const EvalSuiteOptions& options) {
    const auto conditions = conditions_of(options);
    if (!conditions) return report(conditions.error());
    const auto runs = chosen_runs(options);
    if (!runs) return report(runs.error());
    if (auto status = io::make_folder(options.out_dir); !status) return report(status.error());

    watch_for_interrupts();
    const auto executor = make_executor(options.common);
    ThesisResults results;
    if (auto status = describe_datasets(*conditions, *executor, results); !status)
        return report(status.error());
    Parts parts(results, *executor);
    const bool all = options.runs.empty();
    Status done = parts.run(scans_of(*runs, all, *conditions, results));
    if (done.ok()) done = parts.run(recordings_of(*runs, *conditions, results));

    Writes writes;
    const auto write = [&](const char* name, const std::string& text) {
        writes += io::write_file(fmt::format("{}/thesis.{}", options.out_dir, name), text);
    };
    write("html", thesis_html(results, *conditions));
    write("json", thesis_json(results, *conditions) + "\n");
    write("csv", thesis_csv(results, *conditions));
    if (options.common.json) {
        print_answer(thesis_json(results, *conditions));
    } else {
        print_thesis(results, *conditions);
        if (writes.first())
            fmt::print("{} recordings evaluated; open {}/thesis.html\n",
                       results.runs.size(),
                       options.out_dir);
    }
    if (!writes.first()) log_error(writes.first().error().message);
    if (!done) return report(done.error());
    return writes.first() ? kExitOk : kExitFailed;
}

}  // namespace surefoot::app
