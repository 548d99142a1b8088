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

/// Sums over a group of cases, with their wrong verdicts.
struct Pool {
    int cases = 0;
    double safe = 0.0;     ///< number of clear-cut safe movements
    double allowed = 0.0;  ///< number of these movements that the gate allowed
    VerdictTallies tallies;

    void add(const SuiteResult& result) {
        ++cases;
        for (const VerdictTally& tally : result.tallies.all()) tallies.add(tally);
        const double questions = result.figure("safe_questions");
        if (!(questions > 0.0)) return;
        safe += questions;
        allowed += questions * result.figure("allowed");
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
                              percent(tally.named, pool.safe),
                              percent(tally.alone, pool.safe));
        bars.bars.push_back({name, static_cast<double>(tally.named), text});
    }
    std::stable_sort(bars.bars.begin(), bars.bars.end(), [](const auto& a, const auto& b) {
        return a.value > b.value;
    });
    return bars;
}

}  // namespace

double allowed_share(std::span<const SuiteResult> results) {
    Pool pool;
    for (const SuiteResult& result : results) pool.add(result);
    return pool.safe > 0.0 ? pool.allowed / pool.safe : std::nan("");
}

std::vector<eval::ReportBars> refusal_bars(std::span<const SuiteResult> results) {
    std::map<double, Pool> by_noise;
    for (const SuiteResult& result : results) by_noise[result.which.noise].add(result);
    std::vector<eval::ReportBars> all;
    for (const auto& [noise, pool] : by_noise) {
        const std::string at = fmt::format("noise {}", times(noise));
        all.push_back(bars_of(
            pool, TallyKey::reason, "Reasons of the refusals of clearly safe movements, " + at));
        all.push_back(
            bars_of(pool, TallyKey::proof, "Proofs that failed for clearly safe movements, " + at));
        all.push_back(bars_of(pool, TallyKey::danger, "Missed hazards, " + at));
    }
    return all;
}

eval::ReportTable refusal_table(std::span<const SuiteResult> results) {
    std::vector<std::string> reasons;
    std::map<std::pair<std::string, double>, Pool> rows;
    for (const SuiteResult& result : results) {
        rows[{result.which.scene, result.which.noise}].add(result);
        for (const VerdictTally& tally : result.tallies.all()) {
            if (tally.by != TallyKey::reason) continue;
            if (std::find(reasons.begin(), reasons.end(), tally.name) == reasons.end())
                reasons.push_back(tally.name);
        }
    }
    std::sort(reasons.begin(), reasons.end());
    eval::ReportTable table;
    table.title = "Reasons of the refusals of clearly safe movements";
    table.hint =
        "Share of the clearly safe movements at the end of the path whose verdict names this "
        "reason. A verdict can name several reasons.";
    table.wide = true;
    table.header = {"scene", "noise", "cases", "safe movements", "allowed"};
    for (const std::string& reason : reasons) table.header.push_back(words_of(reason));
    for (const auto& [key, pool] : rows) {
        const auto& [scene, noise] = key;
        table.rows.push_back({scene,
                              times(noise),
                              std::to_string(pool.cases),
                              fmt::format("{:.0f}", pool.safe),
                              percent(pool.allowed, pool.safe)});
        for (const std::string& reason : reasons) {
            const VerdictTally* tally = pool.find(TallyKey::reason, reason);
            table.rows.back().push_back(tally ? percent(tally->named, pool.safe) : "");
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
