// SPDX-License-Identifier: Apache-2.0
// What does the gate answer about maps of earlier runs, and which test refuses?
// Usage: gate_answers ask RUN SCENE MOTION_MODEL SEED [RIG]
//        gate_answers judge MACHINE RUN...
// RUN: folder of `surefoot run sim:SCENE`, with map.snapshot
//
// `ask` writes RUN/questions.csv: every movement at poses around the last pose, with its true
// answer.
//
// `judge` asks the present gate these questions, writes RUN/answers.csv and prints one line per
// RUN. So a change of the gate or of its limits needs no new run and no new true answers.
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "service/console/source.hpp"
#include "service/live/ground_box.hpp"
#include "studies/runs/offline_map.hpp"
#include "studies/suite/suite_case.hpp"
#include "studies/suite/suite_verdicts.hpp"
#include "surefoot/gate/verdict_text.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot {
namespace {

constexpr double kReach_m = 0.8;
constexpr const char* kHead =
    "command,x_tenth_mm,y_tenth_mm,cos_yaw,sin_yaw,attested_radius_tenth_mm,"
    "attested_height_tenth_mm,safe,clear_cut,in_view,dangers\n";
constexpr std::size_t kColumns = 11;

/// The dangers with value, limit and place: "step_up 0.031 of 0.020 at 1.13 -0.24 0.00".
std::string joined(const sim::SafetyAnswer& answer) {
    std::string text;
    for (const sim::Finding& f : answer.dangers) {
        text += fmt::format("{}{} {:.3f} of {:.3f} at {:.2f} {:.2f} {:.2f}",
                            text.empty() ? "" : "|",
                            sim::to_string(f.danger),
                            f.value,
                            f.limit,
                            f.where_m.x(),
                            f.where_m.y(),
                            f.where_m.z());
    }
    return text.empty() ? "-" : text;
}

std::string joined(const std::vector<std::string_view>& names) {
    return names.empty() ? "-" : fmt::format("{}", fmt::join(names, "|"));
}

Status write_questions(const std::string& run,
                       const std::string& scene,
                       const std::string& motion_model,
                       std::uint64_t seed,
                       const std::string& rig) {
    const auto machine = app::load_machine("rex");
    if (!machine) return machine.error();
    const auto map = app::load_offline_map(run);
    if (!map) return map.error();
    app::SourceRequest request{scene, rig, 0.0, 0, seed};
    request.sim.motion_model = app::motion_model_choice(motion_model);
    Serial serial;
    const auto source = app::open_simulation(request, serial);
    if (!source) return source.error();
    const sim::SceneTruth& truth = (*source)->truth();
    std::string text = kHead;
    for (const app::GateQuestion& q : app::questions_around(
             truth, truth.trajectory.back(), machine->value().machine, *map->snapshot, kReach_m)) {
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n",
                            q.query.command,
                            q.query.x_tenth_mm,
                            q.query.y_tenth_mm,
                            q.query.cos_yaw,
                            q.query.sin_yaw,
                            q.query.attested.radius_tenth_mm,
                            q.query.attested.height_tenth_mm,
                            q.truth.safe ? 1 : 0,
                            q.truth.clear_cut ? 1 : 0,
                            static_cast<int>(q.in_view),
                            joined(q.truth));
    }
    return io::write_file(run + "/questions.csv", text);
}

/// A line of questions.csv.
struct Asked {
    gate::Query query;
    bool safe = false;
    bool clear_cut = false;
    app::InView in_view = app::InView::none;
    std::string dangers;
};

std::optional<Asked> parse(std::string_view line) {
    const std::vector<std::string_view> words = io::split(line, ",");
    if (words.size() != kColumns) return std::nullopt;
    std::vector<double> numbers;
    for (std::size_t i = 0; i + 1 < kColumns; ++i) {
        const auto number = io::parse_double(words[i]);
        if (!number) return std::nullopt;
        numbers.push_back(*number);
    }
    const auto whole = [&](std::size_t i) { return std::llround(numbers[i]); };
    Asked asked;
    asked.query.command = static_cast<std::uint8_t>(whole(0));
    asked.query.x_tenth_mm = whole(1);
    asked.query.y_tenth_mm = whole(2);
    asked.query.cos_yaw = numbers[3];
    asked.query.sin_yaw = numbers[4];
    asked.query.attested = {true,
                            whole(1),
                            whole(2),
                            static_cast<std::int32_t>(whole(5)),
                            static_cast<std::int32_t>(whole(6))};
    asked.safe = whole(7) == 1;
    asked.clear_cut = whole(8) == 1;
    asked.in_view = static_cast<app::InView>(whole(9));
    asked.dangers = words[10];
    return asked;
}

Status judge_run(const Machine& machine, const std::string& run) {
    const auto map = app::load_offline_map(run);
    if (!map) return map.error();
    const auto text = io::read_file(run + "/questions.csv");
    if (!text) return text.error();
    app::VerdictCounts counts;
    std::string answers =
        "command,x_m,y_m,safe,clear_cut,in_view,dangers,decision,primary,reasons,unproven,"
        "worst_x_m,worst_y_m,foot,value_tenth_mm,limit_tenth_mm\n";
    for (const std::string_view line :
         io::split(std::string_view(*text).substr(std::strlen(kHead)), "\n")) {
        const auto asked = parse(line);
        if (!asked) return input_error(fmt::format("{}/questions.csv: bad line: {}", run, line));
        const gate::Verdict verdict = app::decide_offline(machine, asked->query, *map->snapshot);
        counts.add(
            asked->safe, asked->clear_cut, asked->in_view, verdict.decision == gate::Decision::ok);
        const gate::Evidence& e = verdict.evidence;
        answers += fmt::format("{},{:.3f},{:.3f},{},{},{},{},{},{},{},{},{:.3f},{:.3f},{},{},{}\n",
                               asked->query.command,
                               app::kTenthMm_m * static_cast<double>(asked->query.x_tenth_mm),
                               app::kTenthMm_m * static_cast<double>(asked->query.y_tenth_mm),
                               asked->safe ? 1 : 0,
                               asked->clear_cut ? 1 : 0,
                               static_cast<int>(asked->in_view),
                               asked->dangers,
                               gate::to_string(verdict.decision),
                               gate::to_string(verdict.primary),
                               joined(gate::names_of(verdict.reasons)),
                               joined(gate::unproven_names(verdict.evidence)),
                               app::kTenthMm_m * static_cast<double>(e.worst_x_tenth_mm),
                               app::kTenthMm_m * static_cast<double>(e.worst_y_tenth_mm),
                               static_cast<int>(e.foot),
                               e.value_tenth_mm,
                               e.limit_tenth_mm);
    }
    fmt::print("{},{},{},{},{},{},{},{},{},{}\n",
               run,
               counts.unsafe,
               counts.unsafe_ok,
               counts.borderline_missed,
               counts.safe,
               counts.safe_ok,
               counts.seen,
               counts.seen_ok,
               counts.body_seen,
               counts.body_seen_ok);
    return io::write_file(run + "/answers.csv", answers);
}

int usage() {
    fmt::print(stderr,
               "usage: gate_answers ask RUN SCENE MOTION_MODEL SEED [RIG]\n"
               "       gate_answers judge MACHINE RUN...\n");
    return 2;
}

int run(const std::vector<std::string>& words) {
    const auto report = [](const Error& error) {
        fmt::print(stderr, "{}\n", error.message);
        return 1;
    };
    if (words.size() >= 5 && words[0] == "ask") {
        const auto seed = io::parse_int64(words[4]);
        if (!seed) return usage();
        const Status done = write_questions(words[1],
                                            words[2],
                                            words[3],
                                            static_cast<std::uint64_t>(*seed),
                                            words.size() > 5 ? words[5] : "");
        return done ? 0 : report(done.error());
    }
    if (words.size() < 3 || words[0] != "judge") return usage();
    const auto machine = app::load_machine(words[1]);
    if (!machine) return report(machine.error());
    fmt::print(
        "run,unsafe,missed,borderline_missed,safe,allowed,seen,allowed_of_seen,body_seen,"
        "allowed_of_body_seen\n");
    for (std::size_t i = 2; i < words.size(); ++i) {
        const Status done = judge_run(machine->value().machine, words[i]);
        if (!done) return report(done.error());
    }
    return 0;
}

}  // namespace
}  // namespace surefoot

int main(int argc, char** argv) {
    return surefoot::run({argv + 1, argv + argc});
}
