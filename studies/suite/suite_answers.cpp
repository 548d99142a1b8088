// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_answers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

namespace surefoot::app {
namespace {

struct Answers {
    double asked = 0.0;    ///< number of questions
    double allowed = 0.0;  ///< number of these questions with the answer OK

    void add(double questions, double share) {
        if (!(questions > 0.0)) return;
        asked += questions;
        allowed += questions * share;
    }
};

/// Sums over a group of cases, with their wrong verdicts.
struct Pool {
    int cases = 0;
    Answers safe;  ///< clear-cut safe movements
    Answers seen;  ///< those of them whose zone was in view on the way
    VerdictTallies tallies;

    void add(const SuiteResult& result) {
        ++cases;
        for (const VerdictTally& tally : result.tallies.all()) tallies.add(tally);
        safe.add(result.figure("safe_questions"), result.figure("allowed"));
        seen.add(result.figure("seen_questions"), result.figure("allowed_of_seen"));
    }
    /// Returns the movements of which a tally counts refusals.
    [[nodiscard]] const Answers& answers_of(TallyKey by) const {
        return by == TallyKey::seen ? seen : safe;
    }
    [[nodiscard]] const VerdictTally* find(TallyKey by, const std::string& name) const {
        const auto& all = tallies.all();
        const auto at = std::find_if(all.begin(), all.end(), [&](const VerdictTally& tally) {
            return tally.by == by && tally.name == name;
        });
        return at == all.end() ? nullptr : &*at;
    }
};

std::string percent(double part, double whole) {
    return whole > 0.0 ? fmt::format("{:.1f} %", 100.0 * part / whole) : "-";
}

std::string times(double noise) {
    return fmt::format("x {:g}", noise);
}

/// Replaces underscores: "left_supported" becomes "left supported".
std::string words_of(std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

eval::ReportBars bars_of(const Pool& pool, TallyKey by, std::string title) {
    eval::ReportBars bars;
    bars.title = std::move(title);
    for (const VerdictTally& tally : pool.tallies.all()) {
        if (tally.by != by) continue;
        const std::string name = by == TallyKey::proof ? words_of(tally.name) : tally.name;
        const std::string text =
            by == TallyKey::danger
                ? fmt::format("{} ({} as the only danger)", tally.named, tally.alone)
                : fmt::format("named in {}, named alone in {}",
                              percent(tally.named, pool.answers_of(by).asked),
                              percent(tally.alone, pool.answers_of(by).asked));
        bars.bars.push_back({name, static_cast<double>(tally.named), text});
    }
    std::stable_sort(bars.bars.begin(), bars.bars.end(), [](const auto& a, const auto& b) {
        return a.value > b.value;
    });
    return bars;
}

}  // namespace

double allowed_share(std::span<const SuiteResult> results, TallyKey by) {
    Pool pool;
    for (const SuiteResult& result : results) pool.add(result);
    const Answers& answers = pool.answers_of(by);
    return answers.asked > 0.0 ? answers.allowed / answers.asked : std::nan("");
}

std::vector<eval::ReportBars> refusal_bars(std::span<const SuiteResult> results) {
    std::map<double, Pool> by_noise;
    for (const SuiteResult& result : results) by_noise[result.which.noise].add(result);
    std::vector<eval::ReportBars> all;
    for (const auto& [noise, pool] : by_noise) {
        const std::string at = fmt::format("noise {}", times(noise));
        all.push_back(bars_of(
            pool, TallyKey::reason, "Reasons of the refusals of clearly safe movements, " + at));
        all.push_back(bars_of(
            pool,
            TallyKey::seen,
            "Reasons of the refusals of clearly safe movements that both cameras saw, " + at));
        all.push_back(
            bars_of(pool, TallyKey::proof, "Proofs that failed for clearly safe movements, " + at));
        all.push_back(bars_of(pool, TallyKey::danger, "Missed hazards, " + at));
    }
    return all;
}

eval::ReportTable refusal_table(std::span<const SuiteResult> results, TallyKey by) {
    std::vector<std::string> reasons;
    std::map<std::pair<std::string, double>, Pool> rows;
    for (const SuiteResult& result : results) {
        rows[{result.which.scene, result.which.noise}].add(result);
        for (const VerdictTally& tally : result.tallies.all()) {
            if (tally.by != by) continue;
            if (std::find(reasons.begin(), reasons.end(), tally.name) == reasons.end())
                reasons.push_back(tally.name);
        }
    }
    std::sort(reasons.begin(), reasons.end());
    const bool of_seen = by == TallyKey::seen;
    eval::ReportTable table;
    table.title = of_seen
                      ? "Reasons of the refusals of clearly safe movements that both cameras saw"
                      : "Reasons of the refusals of clearly safe movements";
    table.hint = fmt::format(
        "Share of the clearly safe movements at the end of the path{} whose verdict names this "
        "reason. A verdict can name several reasons.",
        of_seen ? " whose feet, ways and drop bands both cameras saw on the way" : "");
    table.wide = true;
    table.header = {"scene", "noise", "cases", "movements", "allowed"};
    for (const std::string& reason : reasons) table.header.push_back(words_of(reason));
    for (const auto& [key, pool] : rows) {
        const auto& [scene, noise] = key;
        const Answers& answers = pool.answers_of(by);
        table.rows.push_back({scene,
                              times(noise),
                              std::to_string(pool.cases),
                              fmt::format("{:.0f}", answers.asked),
                              percent(answers.allowed, answers.asked)});
        for (const std::string& reason : reasons) {
            const VerdictTally* tally = pool.find(by, reason);
            table.rows.back().push_back(tally ? percent(tally->named, answers.asked) : "");
        }
    }
    return table;
}

// ---- the steps of walking machines --------------------------------------------------------------

namespace {

std::string judgement(const SuiteStep& step) {
    const std::string truth = step.safe ? "safe" : "dangerous";
    return step.clear_cut ? truth : truth + ", within the margin";
}

std::string outcome(const SuiteStep& step) {
    if (step.allowed()) return step.safe ? "allowed" : step.clear_cut ? "MISSED" : "allowed";
    return step.safe ? "refused although safe" : "refused";
}

}  // namespace

eval::ReportTable step_table(std::span<const SuiteResult> results) {
    eval::ReportTable table;
    table.title =
        "Every step that a walking user requested, and the verdict of the gate just before it";
    table.header = {
        "case", "step", "time [s]", "command", "truth", "dangers", "gate", "reasons of the gate"};
    table.hint =
        "The gate is asked with the map and the pose of that moment. An operator attestation "
        "covers the level ground around the start.";
    table.wide = true;
    for (const SuiteResult& result : results) {
        for (const SuiteStep& step : result.steps) {
            table.rows.push_back({result.which.name(),
                                  std::to_string(step.number),
                                  fmt::format("{:.1f}", step.time_s),
                                  std::to_string(step.command),
                                  judgement(step),
                                  step.dangers,
                                  outcome(step),
                                  step.reasons});
        }
    }
    table.folded = true;
    return table;
}

eval::ReportBars step_bars(std::span<const SuiteResult> results) {
    std::map<std::string, int> counts;
    int safe = 0;
    for (const SuiteResult& result : results) {
        for (const SuiteStep& step : result.steps) {
            if (!step.safe || !step.clear_cut) continue;
            ++safe;
            ++counts[step.allowed() ? "allowed" : step.reasons.substr(0, step.reasons.find('|'))];
        }
    }
    eval::ReportBars bars;
    bars.title = "Verdicts of clearly safe steps (first reason)";
    for (const auto& [reason, count] : counts) {
        bars.bars.push_back({reason,
                             static_cast<double>(count),
                             fmt::format("{} ({:.0f} %)", count, 100.0 * count / safe)});
    }
    std::stable_sort(bars.bars.begin(), bars.bars.end(), [](const auto& a, const auto& b) {
        return a.value > b.value;
    });
    return bars;
}

}  // namespace surefoot::app
