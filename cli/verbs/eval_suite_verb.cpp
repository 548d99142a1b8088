// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>

#include "cli/verbs/verbs.hpp"
#include "service/console/interrupt.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "service/console/writes.hpp"
#include "studies/lange2016/eval_thesis.hpp"
#include "studies/suite/suite_json.hpp"
#include "studies/suite/suite_options.hpp"
#include "studies/suite/suite_plan.hpp"
#include "studies/suite/suite_progress.hpp"
#include "studies/suite/suite_report.hpp"
#include "studies/suite/suite_rows.hpp"
#include "studies/suite/suite_table.hpp"
#include "surefoot/core/fnv1a.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

/// Largest distance from the last pose at which the quick suite queries the gate. These queries
/// take half of the run time of the quick suite.
constexpr double kQuickReach_m = 0.6;

sim::CameraProfile profile_of(const std::string& name) {
    const auto at =
        std::find(std::begin(sim::kCameraProfileNames), std::end(sim::kCameraProfileNames), name);
    return static_cast<sim::CameraProfile>(at - std::begin(sim::kCameraProfileNames));
}

Result<SuiteConditions> conditions_of(const EvalSuiteOptions& options) {
    auto settings = load_settings(options.common);
    if (!settings) return settings.error();
    settings->sim.profile = profile_of(options.camera);
    const auto machine = load_machine(options.machine);
    if (!machine) return machine.error();
    if (!*machine)
        return usage_error(
            "--machine is empty: give a machine file, or the name of a built-in machine, for "
            "example rex");
    const double reach_m =
        options.quick ? std::min(options.reach_m, kQuickReach_m) : options.reach_m;
    return SuiteConditions{std::move(*settings), machine->value().machine, reach_m, options.rig};
}

/// Returns the hash of all conditions that determine the figures of a case, without the case
/// itself.
std::uint64_t conditions_hash(const EvalSuiteOptions& options, const SuiteConditions& conditions) {
    return fnv1a(fmt::format("{} {} {}", options.machine, conditions.reach_m, options.rig),
                 hash_of(conditions.settings));
}

/// Runs the cases that the table lacks, one case per thread of the executor. A case that fails is
/// logged and left out, and the other cases continue. After a failed write or an interrupt by the
/// user no further case starts.
class SuiteRun {
  public:
    SuiteRun(const SuiteConditions& conditions, SuiteTable& table)
        : conditions_(conditions), table_(table) {}

    [[nodiscard]] Status run(const std::vector<PlannedCase>& all, Executor& executor) {
        std::vector<PlannedCase> missing;
        std::int64_t frames = 0;
        for (const PlannedCase& planned : all) {
            if (table_.holds(planned.which)) continue;
            missing.push_back(planned);
            frames += planned.frames;
        }
        progress_.emplace(missing.size(), frames);
        executor.parallel_for(static_cast<int>(missing.size()), [&](int index) {
            run_one(missing[static_cast<std::size_t>(index)]);
        });
        progress_.reset();
        return first_error_ ? Status(*first_error_) : Status();
    }

  private:
    void run_one(const PlannedCase& planned) {
        if (stopped_ || interrupted()) return;
        const std::string name = planned.which.name();
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            progress_->started(name);
        }
        auto result = run_suite_case(planned.which, conditions_);
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!result) {
            fail(name, result.error());
            return;
        }
        if (auto status = table_.add(std::move(*result)); !status) {
            stopped_ = true;
            fail(name, status.error());
            return;
        }
        progress_->finished(name, planned.frames);
    }

    void fail(const std::string& name, const Error& error) {
        if (error.code == ErrorCode::interrupted) {
            stopped_ = true;
            first_error_ =
                Error{error.code, "interrupted by the user; repeat the same call to continue"};
            return;
        }
        const Error named{error.code, fmt::format("{}: {}", name, error.message)};
        if (first_error_) log_error(first_error_->message);  // the caller logs the last error
        first_error_ = named;
    }

    const SuiteConditions& conditions_;
    SuiteTable& table_;
    std::mutex mutex_;
    std::optional<SuiteProgress> progress_;
    std::optional<Error> first_error_;
    std::atomic<bool> stopped_{false};
};

void print_summary(std::span<const SuiteRow> rows) {
    fmt::print("{:<24}{:>8}{:>6}{:>6}{:>10}{:>11}{:>9}{:>12}{:>8}{:>9}\n",
               "scene",
               "motion model",
               "noise",
               "cases",
               "ATE mm",
               "median mm",
               "90 % mm",
               "false safe",
               "missed",
               "allowed");
    const auto& all = suite_figures();
    for (const SuiteRow& row : rows) {
        const auto worst = [&](std::string_view name) {
            const auto at = std::find_if(
                all.begin(), all.end(), [&](const SuiteFigure& f) { return name == f.name; });
            return row.worst[static_cast<std::size_t>(at - all.begin())];
        };
        fmt::print("{:<24}{:>8}{:>6g}{:>6}{:>10.2f}{:>11.2f}{:>9.2f}{:>12.4f}{:>8g}{:>8.0f}%\n",
                   row.scene,
                   row.motion_model,
                   row.noise,
                   row.cases,
                   1e3 * worst("ate_rmse_m"),
                   1e3 * worst("height_median_m"),
                   1e3 * worst("height_p90_m"),
                   worst("false_safe"),
                   worst("missed_hazards"),
                   100.0 * worst("allowed"));
    }
    fmt::print("(each figure is the worst value of the cases in its row)\n");
}

/// `surefoot eval suite`: runs the pipeline on each combination of scene, motion model, seed and
/// noise level, and compares the results with the truth.
int eval_suite(const EvalSuiteOptions& options) {
    if (options.thesis) return eval_thesis(options);
    const auto conditions = conditions_of(options);
    if (!conditions) return report(conditions.error());
    const auto cases = plan_suite(options, conditions->settings);
    if (!cases) return report(cases.error());
    if (auto status = io::make_folder(options.out_dir); !status) return report(status.error());
    auto table = SuiteTable::open(options.out_dir, conditions_hash(options, *conditions));
    if (!table) return report(table.error());

    watch_for_interrupts();
    const auto executor = make_executor(options.common);
    const Status done = SuiteRun(*conditions, *table).run(*cases, *executor);
    const std::vector<SuiteResult> results = sorted(table->results());
    Writes writes;
    writes += io::write_file(options.out_dir + "/suite.json", suite_json(results) + "\n");
    writes += io::write_file(options.out_dir + "/suite.html", suite_html(results, options.out_dir));
    if (options.common.json) {
        print_answer(suite_json(results));
    } else {
        print_summary(summarise(results));
        if (writes.first())
            fmt::print("report of {} cases: {}/suite.html\n", results.size(), options.out_dir);
    }
    if (!writes.first()) log_error(writes.first().error().message);
    if (!done) return report(done.error());
    return writes.first() ? kExitOk : kExitFailed;
}

}  // namespace

void add_eval_suite(VerbGroup verbs) {
    auto [suite, s] = verbs.add<EvalSuiteOptions>(
        "suite",
        "run the whole chain on each combination of simulated scene, motion model, seed and noise, "
        "and compare the results with the truth; --threads sets how many cases run at the same "
        "time",
        "surefoot eval suite --quick --scenes floor --noise 1 --out out/suite",
        eval_suite);
    suite
        .option("--out",
                s.out_dir,
                "folder for the results suite.html, suite.json and cases.csv; to continue an "
                "interrupted suite, repeat the call")
        .required()
        .value("DIR");
    suite.flag("--quick",
               s.quick,
               "run only a few short scenes, for a quick check after a change of the code");
    const Option thesis =
        suite.flag("--lange2016",
                   s.thesis,
                   "run the experiments of the reference thesis (Lange 2016) on rebuilt scenes "
                   "instead of the suite, and compare the values of the thesis with the values of "
                   "Surefoot; writes thesis.html, thesis.json and thesis.csv");
    suite
        .option(
            "--runs",
            s.runs,
            "with --lange2016: names of the experiments to run, separated by commas (default: all)")
        .separated_by_commas()
        .value("NAMES")
        .needs(thesis);
    suite
        .option("--scenes",
                s.scenes,
                "scenes to run: names of scenes or scene files, separated by commas (default: all "
                "scenes)")
        .separated_by_commas()
        .value("NAMES");
    suite
        .option("--motion-models",
                s.motion_models,
                "motion models that move the camera through each scene, separated by commas; scene "
                "= the motion model in the scene file (default). The verb leaves out impossible "
                "combinations and names them")
        .separated_by_commas()
        .one_of({"scene", "trolley", "rex", "hand"})
        .value("NAMES");
    suite
        .option("--camera",
                s.camera,
                "noise profile of the simulated camera (default zed: noise of a real ZED camera)")
        .one_of({"ideal", "zed", "euroc"});
    suite
        .option("--rig",
                s.rig,
                "rig of the simulated camera: a rig file, or the name of a built-in rig (default "
                "zed_vga)")
        .value("FILE|NAME");
    suite
        .option("--seeds",
                s.seeds,
                "number of variants of each scene (default 1); the first variant has the seed of "
                "--seed")
        .in(1, 100000);
    suite
        .option("--noise",
                s.noise,
                "factors by which the camera noise is multiplied, separated by commas (default "
                "1,2); each factor gives a case of its own")
        .separated_by_commas()
        .in(0.0, 10.0)
        .value("FACTORS");
    suite
        .option("--frames",
                s.frames,
                "stop each case after this number of frames (default: at the end of the path)")
        .positive();
    suite
        .option("--reach",
                s.reach_m,
                "radius of the circle around the last pose in which the suite asks the gate about "
                "steps, in m (default 0.8); 0 = only at the last pose")
        .value("M")
        .in(0.0, 2.0);
    suite
        .option("--machine",
                s.machine,
                "machine that the gate judges for: a machine file, or the name of a built-in "
                "machine (default rex)")
        .value("FILE|NAME");
}

}  // namespace surefoot::app
