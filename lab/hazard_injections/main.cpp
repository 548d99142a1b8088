// SPDX-License-Identifier: Apache-2.0
// How long does it take from a fault to the first answer that is not OK, and does an OK follow it?
// The program injects each hazard of docs/reference/hazards.md that can be injected, at the
// interface where it occurs in reality. Time is simulated: frames at 15 Hz, a query every 10 ms.
// Usage: hazard_injections OUT.csv FIRST_SEED COUNT [HAZARDS]
//   hazard_injections out/injections.csv 21 10 H1,H2
//   COUNT    injections of each kind. The number of control runs without a fault is a tenth of
//            COUNT, at least two.
//   HAZARDS  hazard ids with commas between them; default: all
//
// An injection counts if every answer before its fault is OK, or if its fault exists from the
// start. Every answer of a control run must be OK. The exit status is 1 if an OK comes too late, if
// the first inhibit comes later than 250 ms after a fault that must give ERROR, if a control run
// has an answer other than OK, or if fewer than nine of ten injections of a kind count.
//
// Writes OUT.csv, one line per run; the columns that need an explanation:
//   faulty                         0 = control run
//   asked_before, allowed_before   queries before the fault, and those answered OK; in a control
//                                  run all queries
//   asked_after                    queries after the fault began
//   allowed_late                   number of OKs after the deadline or after the first inhibit
//   latency_ms                     time from the fault to the first answer that is not OK; empty =
//                                  there is no such answer
//   last_allowed_ms                time from the fault to the last OK; -1 = no OK
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "lab/hazard_injections/fault_bench.hpp"
#include "service/console/log.hpp"
#include "surefoot/io/text.hpp"
#include "surefoot/machines/built_in_machines.hpp"

namespace surefoot::experiments {
namespace {

constexpr std::int64_t kDemanded_ns = 250 * kMs;

struct Tally {
    int injected = 0;
    int counted = 0;
    int controls = 0;
    int controls_ok = 0;
    int late_runs = 0;  ///< number of runs with an OK after the deadline or the first inhibit
    int late = 0;       ///< number of OKs after the deadline or the first inhibit
    int slow = 0;       ///< runs whose first inhibit is missing or later than kDemanded_ns
    std::int64_t slowest_ns = 0;
};

bool all_allowed(const Outcome& outcome) {
    return outcome.asked_before > 0 && outcome.allowed_before == outcome.asked_before;
}

void add(const Injection& injection, const Outcome& outcome, bool faulty, Tally& tally) {
    if (!faulty) {
        ++tally.controls;
        tally.controls_ok += all_allowed(outcome) ? 1 : 0;
        return;
    }
    ++tally.injected;
    if (!injection.from_the_start && !all_allowed(outcome)) return;
    ++tally.counted;
    tally.late += outcome.allowed_late;
    tally.late_runs += outcome.allowed_late > 0 ? 1 : 0;
    const std::int64_t latency_ns = outcome.latency_ns.value_or(kNever_ns);
    tally.slow += latency_ns > kDemanded_ns ? 1 : 0;
    if (latency_ns != kNever_ns) tally.slowest_ns = std::max(tally.slowest_ns, latency_ns);
}

bool passes(const Injection& injection, const Tally& tally) {
    return tally.controls_ok == tally.controls && 10 * tally.counted >= 9 * tally.injected &&
           tally.late == 0 && (tally.slow == 0 || !injection.is_error);
}

void write(const Injection& injection,
           std::uint64_t seed,
           bool faulty,
           const Outcome& outcome,
           fmt::ostream& out) {
    const auto ms = [](std::int64_t ns) {
        return fmt::format("{:.1f}", 1e-6 * static_cast<double>(ns));
    };
    out.print("{},\"{}\",\"{}\",{},\"{}\",{},{:d},\"{}\",{},{},{},{},{},{},{},{:d}\n",
              injection.hazard,
              injection.cause,
              injection.level,
              injection.is_error ? "ERROR" : "NOT_TRAVERSABLE",
              injection.drawn,
              seed,
              faulty,
              outcome.variant,
              outcome.asked_before,
              outcome.allowed_before,
              outcome.asked_after,
              outcome.allowed_late,
              outcome.latency_ns ? ms(*outcome.latency_ns) : "",
              outcome.last_allowed_ns < 0 ? "-1" : ms(outcome.last_allowed_ns),
              gate::to_string(outcome.reason),
              injection.from_the_start);
}

Result<Tally> inject(const Injection& injection,
                     std::uint64_t first_seed,
                     int count,
                     fmt::ostream& out) {
    Tally tally;
    const int controls = std::max(2, count / 10);
    for (int k = 0; k < count + controls; ++k) {
        const bool faulty = k < count;
        const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(k);
        auto outcome = injection.run(seed, faulty);
        if (!outcome) return outcome.error();
        add(injection, *outcome, faulty, tally);
        write(injection, seed, faulty, *outcome, out);
    }
    return tally;
}

int inject_all(const std::vector<std::string>& words) {
    if (words.size() < 3)
        return app::report(usage_error("hazard_injections OUT.csv FIRST_SEED COUNT [HAZARDS]"));
    const std::uint64_t first_seed = std::strtoull(words[1].c_str(), nullptr, 10);
    const int count = std::atoi(words[2].c_str());
    const auto machine = machines::load_machine("rex");
    if (!machine) return app::report(machine.error());
    std::vector<Injection> injections = gate_injections(*machine);
    for (Injection& injection : frame_injections(*machine, std::max(2, count / 20)))
        injections.push_back(std::move(injection));
    if (words.size() > 3) {
        const auto wanted = io::split(words[3], ",");
        for (const auto& hazard : wanted) {
            if (std::ranges::find(injections, hazard, &Injection::hazard) == injections.end())
                return app::report(usage_error(fmt::format(
                    "HAZARDS: no injection belongs to hazard '{}'; see docs/reference/hazards.md",
                    hazard)));
        }
        std::erase_if(injections, [&](const Injection& injection) {
            return std::ranges::find(wanted, injection.hazard) == wanted.end();
        });
    }
    auto out = fmt::output_file(words[0]);
    out.print(
        "hazard,cause,level,class,drawn,seed,faulty,variant,asked_before,allowed_before,asked_"
        "after,"
        "allowed_late,latency_ms,last_allowed_ms,reason,from_the_start\n");
    bool passed = true;
    for (const Injection& injection : injections) {
        const auto tally = inject(injection, first_seed, count, out);
        if (!tally) return app::report(tally.error());
        const bool good = passes(injection, *tally);
        passed = passed && good;
        fmt::print(
            "{:4} {:40} {}: {} of {} count, {} of {} controls OK, OK too late in {} ({} times), "
            "first inhibit beyond 250 ms in {}, slowest {:.0f} ms\n",
            injection.hazard,
            injection.cause,
            good ? "passed" : "FAILED",
            tally->counted,
            tally->injected,
            tally->controls_ok,
            tally->controls,
            tally->late_runs,
            tally->late,
            tally->slow,
            1e-6 * static_cast<double>(tally->slowest_ns));
        out.flush();
        std::fflush(stdout);
    }
    return passed ? 0 : 1;
}

}  // namespace
}  // namespace surefoot::experiments

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::experiments::inject_all({argv + 1, argv + argc});
}
