// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"
#include "studies/suite/suite_rows.hpp"

namespace surefoot::app {
namespace {

using gate_process::dump_indented;
using gate_process::Json;
using gate_process::number;

Json suite_figures_json(const std::vector<double>& figures) {
    Json object = Json::object();
    for (std::size_t i = 0; i < figures.size(); ++i)
        object[suite_figures()[i].name] = number(figures[i]);
    return object;
}

Json suite_steps_json(const std::vector<SuiteStep>& steps) {
    Json list = Json::array();
    for (const SuiteStep& step : steps) {
        list.push_back({{"step", step.number},
                        {"time_s", step.time_s},
                        {"command", step.command},
                        {"safe", step.safe},
                        {"clear_cut", step.clear_cut},
                        {"seen", step.seen},
                        {"dangers", step.dangers},
                        {"decision", step.decision},
                        {"reasons", step.reasons}});
    }
    return list;
}

Json suite_tallies_json(const VerdictTallies& tallies) {
    Json list = Json::array();
    for (const VerdictTally& tally : tallies.all()) {
        list.push_back({{"by", kTallyKeyNames[static_cast<std::size_t>(tally.by)]},
                        {"name", tally.name},
                        {"named", tally.named},
                        {"alone", tally.alone}});
    }
    return list;
}

Json suite_bins_json(const std::vector<NoiseBins>& levels) {
    Json list = Json::array();
    for (const NoiseBins& level : levels) {
        for (const SuiteBin& bin : level.bins) {
            const std::string unit = unit_of(bin.key);
            list.push_back({{"noise", level.noise},
                            {"cases", level.cases},
                            {"by", kBinKeyNames[static_cast<std::size_t>(bin.key)]},
                            {"from_" + unit, bin.from},
                            {"to_" + unit, bin.to},
                            {"count", bin.errors.count()},
                            {"median_abs_m", number(bin.errors.percentile(0.5))},
                            {"p90_abs_m", number(bin.errors.percentile(0.9))},
                            {"p99_abs_m", number(bin.errors.percentile(0.99))}});
        }
    }
    return list;
}

}  // namespace

std::string suite_json(std::span<const SuiteResult> results) {
    Json cases = Json::array();
    for (const SuiteResult& result : results) {
        cases.push_back({{"scene", result.which.scene},
                         {"seed", result.which.seed},
                         {"noise", result.which.noise},
                         {"max_frames", result.which.max_frames},
                         {"motion_model", result.which.motion_model},
                         {"rate_hz", result.which.rate_hz},
                         {"figures", suite_figures_json(result.figures)},
                         {"steps", suite_steps_json(result.steps)},
                         {"wrong_answers", suite_tallies_json(result.tallies)}});
    }
    const auto rows_json = [](const std::vector<SuiteRow>& rows, bool by_scene) {
        Json list = Json::array();
        for (const SuiteRow& row : rows) {
            Json object = {{"motion_model", row.motion_model},
                           {"noise", row.noise},
                           {"cases", row.cases},
                           {"median", suite_figures_json(row.median)},
                           {"worst", suite_figures_json(row.worst)}};
            if (by_scene) object["scene"] = row.scene;
            list.push_back(std::move(object));
        }
        return list;
    };
    return dump_indented(
        Json{{"cases", cases},
             {"scenes", rows_json(summarise(results), true)},
             {"motion_models", rows_json(summarise_by_motion_model(results), false)},
             {"bins", suite_bins_json(pooled_by_noise(results))}});
}

}  // namespace surefoot::app
