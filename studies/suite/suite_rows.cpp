// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_rows.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace surefoot::app {
namespace {

/// Fills median and worst from the cases of the row.
void measure(SuiteRow& row, std::span<const SuiteResult* const> cases) {
    row.cases = static_cast<int>(cases.size());
    for (std::size_t i = 0; i < suite_figures().size(); ++i) {
        std::vector<double> values;
        for (const SuiteResult* result : cases) {
            if (!std::isnan(result->figures[i])) values.push_back(result->figures[i]);
        }
        std::sort(values.begin(), values.end());
        const double none = std::nan("");
        row.median.push_back(values.empty() ? none : values[values.size() / 2]);
        row.worst.push_back(values.empty()                       ? none
                            : suite_figures()[i].lower_is_better ? values.back()
                                                                 : values.front());
    }
}

std::vector<SuiteRow> grouped(std::span<const SuiteResult> results, bool by_scene) {
    std::vector<SuiteRow> rows;
    std::vector<std::vector<const SuiteResult*>> members;
    for (const SuiteResult& result : results) {
        const SuiteCase& c = result.which;
        const std::string scene = by_scene ? c.scene : "";
        const auto at = std::find_if(rows.begin(), rows.end(), [&](const SuiteRow& row) {
            return row.scene == scene && row.motion_model == c.motion_model && row.noise == c.noise;
        });
        const auto place = static_cast<std::size_t>(at - rows.begin());
        if (at == rows.end()) {
            SuiteRow row;
            row.scene = scene;
            row.motion_model = c.motion_model;
            row.noise = c.noise;
            rows.push_back(std::move(row));
            members.emplace_back();
        }
        members[place].push_back(&result);
    }
    for (std::size_t i = 0; i < rows.size(); ++i) measure(rows[i], members[i]);
    return rows;
}

}  // namespace

std::vector<SuiteResult> sorted(std::vector<SuiteResult> results) {
    const auto place_of = [](const SuiteResult& result) {
        const SuiteCase& c = result.which;
        return std::tie(c.scene, c.motion_model, c.noise, c.seed, c.max_frames);
    };
    std::sort(results.begin(), results.end(), [&](const SuiteResult& a, const SuiteResult& b) {
        return place_of(a) < place_of(b);
    });
    return results;
}

std::vector<SuiteRow> summarise(std::span<const SuiteResult> results) {
    return grouped(results, true);
}

std::vector<SuiteRow> summarise_by_motion_model(std::span<const SuiteResult> results) {
    std::vector<SuiteRow> rows = grouped(results, false);
    std::sort(rows.begin(), rows.end(), [](const SuiteRow& a, const SuiteRow& b) {
        return std::tie(a.motion_model, a.noise) < std::tie(b.motion_model, b.noise);
    });
    return rows;
}

std::vector<NoiseBins> pooled_by_noise(std::span<const SuiteResult> results) {
    std::map<double, NoiseBins> by_noise;
    for (const SuiteResult& result : results) {
        NoiseBins& level = by_noise[result.which.noise];
        level.noise = result.which.noise;
        ++level.cases;
        level.bins.insert(level.bins.end(), result.bins.begin(), result.bins.end());
        level.bins = pooled(level.bins);
    }
    std::vector<NoiseBins> levels;
    levels.reserve(by_noise.size());
    for (auto& [noise, level] : by_noise) levels.push_back(std::move(level));
    return levels;
}

}  // namespace surefoot::app
