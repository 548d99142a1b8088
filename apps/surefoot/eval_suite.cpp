// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "apps/surefoot/interrupt.hpp"
#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/source.hpp"
#include "apps/surefoot/suite_report.hpp"
#include "apps/surefoot/suite_table.hpp"
#include "apps/surefoot/verbs.hpp"
#include "apps/surefoot/writes.hpp"
#include "io/file.hpp"
#include "sim/scenes.hpp"

namespace surefoot::app {
namespace {

/// Few, short, and of every kind: for every change of the code.
constexpr int kQuickFrames = 30;
constexpr const char* kQuickScenes[] = {"demo_stairs",
                                        "platform_edge",
                                        "table",
                                        "kerb_down_100",
                                        "kerb_up_75",
                                        "door_810",
                                        "ramp_1_12_up",
                                        "hole"};

sim::CameraProfile profile_of(const std::string& name) {
    const auto at =
        std::find(std::begin(sim::kCameraProfileNames), std::end(sim::kCameraProfileNames), name);
    return static_cast<sim::CameraProfile>(at - std::begin(sim::kCameraProfileNames));
}

Result<std::vector<std::string>> chosen_scenes(const EvalSuiteOptions& options) {
    std::vector<std::string> known;
    for (const auto& scene : sim::list_scenes()) known.push_back(scene.name);
    if (options.scenes.empty() && options.quick)
        return std::vector<std::string>(std::begin(kQuickScenes), std::end(kQuickScenes));
    if (options.scenes.empty()) return known;
    for (const std::string& scene : options.scenes) {
        if (std::find(known.begin(), known.end(), scene) == known.end()) {
            return usage_error(fmt::format(
                "--scenes {}: there is no such scene; 'surefoot sim --list' shows them", scene));
        }
    }
    return options.scenes;
}

std::vector<SuiteCase> cases_of(const EvalSuiteOptions& options,
                                const std::vector<std::string>& scenes) {
    std::vector<SuiteCase> cases;
    for (const std::string& scene : scenes) {
        for (int i = 0; i < options.seeds; ++i) {
            for (const double noise : options.noise) {
                cases.push_back({scene,
                                 options.common.seed + static_cast<std::uint64_t>(i),
                                 noise,
                                 options.quick ? kQuickFrames : 0});
            }
        }
    }
    return cases;
}

/// Runs what is not there yet; an error or an interrupt ends it, with everything before kept.
Status run_missing(const std::vector<SuiteCase>& cases,
                   const Settings& settings,
                   const io::MachineFile& machine,
                   Executor& executor,
                   SuiteTable& table) {
    for (std::size_t i = 0; i < cases.size(); ++i) {
        if (table.holds(cases[i])) continue;
        const std::string label =
            fmt::format("case {}/{} {}", i + 1, cases.size(), cases[i].name());
        const auto result = run_suite_case(cases[i], settings, machine, executor, label);
        if (!result) {
            const Error& error = result.error();
            return Error{error.code, fmt::format("{}: {}", cases[i].name(), error.message)};
        }
        if (auto status = table.add(*result); !status) return status;
    }
    return {};
}

void print_summary(const std::vector<SuiteRow>& rows) {
    fmt::print("{:<24}{:>6}{:>6}{:>12}{:>12}{:>12}{:>12}\n",
               "scene",
               "noise",
               "cases",
               "ATE mm",
               "median mm",
               "90 % mm",
               "false safe");
    const auto figure = [](const SuiteRow& row, std::string_view name) {
        const auto& all = suite_figures();
        const auto at = std::find_if(
            all.begin(), all.end(), [&](const SuiteFigure& f) { return name == f.name; });
        return row.worst[static_cast<std::size_t>(at - all.begin())];
    };
    for (const SuiteRow& row : rows) {
        fmt::print("{:<24}{:>6g}{:>6}{:>12.2f}{:>12.2f}{:>12.2f}{:>12.4f}\n",
                   row.scene,
                   row.noise,
                   row.cases,
                   1e3 * figure(row, "ate_rmse_m"),
                   1e3 * figure(row, "height_median_m"),
                   1e3 * figure(row, "height_p90_m"),
                   figure(row, "false_safe"));
    }
    fmt::print("(worst case of each row)\n");
}

}  // namespace

int eval_suite(const EvalSuiteOptions& options) {
    auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    settings->sim.profile = profile_of(options.camera);
    const auto machine = load_machine(options.machine);
    if (!machine) return report(machine.error());
    if (!*machine) return report(usage_error("--machine: a machine file or name is needed"));
    const auto scenes = chosen_scenes(options);
    if (!scenes) return report(scenes.error());
    if (auto status = io::make_folder(options.out_dir); !status) return report(status.error());
    auto table = SuiteTable::open(options.out_dir + "/cases.csv", hash_of(*settings));
    if (!table) return report(table.error());

    const auto executor = make_executor(options.common);
    const Status done =
        run_missing(cases_of(options, *scenes), *settings, machine->value(), *executor, *table);
    const std::vector<SuiteRow> rows = summarise(table->results());
    Writes writes;
    writes += io::write_file(options.out_dir + "/suite.json", suite_json(table->results()) + "\n");
    writes += io::write_file(options.out_dir + "/suite.html", suite_html(table->results()));
    if (options.common.json) {
        fmt::print("{}\n", suite_json(table->results()));
    } else {
        print_summary(rows);
        fmt::print("{} cases in {}/suite.html\n", table->results().size(), options.out_dir);
    }
    if (!writes.first()) log_error(writes.first().error().message);
    if (!done) return report(done.error());
    return writes.first() ? kExitOk : kExitFailed;
}

}  // namespace surefoot::app
