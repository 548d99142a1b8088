// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/run_features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "studies/runs/stairs_text.hpp"
#include "surefoot/eval/stairs/feature_errors.hpp"

namespace surefoot::app {
namespace {

template <typename Feature>
void split(std::vector<Feature>& confirmed, std::vector<Feature>& unconfirmed) {
    const auto once =
        std::stable_partition(confirmed.begin(), confirmed.end(), [](const Feature& feature) {
            return feature.tracked.is_confirmed();
        });
    unconfirmed.assign(once, confirmed.end());
    confirmed.erase(once, confirmed.end());
}

/// Sets `in_final_map` of all tracked features and adds the features that only the final map has.
template <typename Feature>
void compare(const eval::KindErrors& errors,
             const std::vector<Feature>& final_map,
             std::vector<Feature>& tracked) {
    for (Feature& feature : tracked) feature.tracked.in_final_map = true;
    for (const std::size_t i : errors.extra_at) tracked[i].tracked.in_final_map = false;
    for (const std::size_t i : errors.missed_at) {
        Feature feature = final_map[i];
        feature.tracked.observations = 0;
        feature.tracked.seen_now = false;
        feature.tracked.in_final_map = true;
        tracked.push_back(std::move(feature));
    }
}

}  // namespace

RunFeatures split_by_confirmation(stairs::TerrainFeatures tracked) {
    RunFeatures out;
    out.confirmed = std::move(tracked);
    out.unconfirmed.time_ns = out.confirmed.time_ns;
    split(out.confirmed.edges, out.unconfirmed.edges);
    split(out.confirmed.drops, out.unconfirmed.drops);
    split(out.confirmed.kerbs, out.unconfirmed.kerbs);
    split(out.confirmed.sills, out.unconfirmed.sills);
    split(out.confirmed.flights, out.unconfirmed.flights);
    split(out.confirmed.doors, out.unconfirmed.doors);
    return out;
}

RunFeatures compare_with_final_map(stairs::TerrainFeatures tracked,
                                   const stairs::TerrainFeatures& final_map) {
    const eval::FeatureErrors errors = eval::feature_errors(tracked, final_map, {});
    compare(errors.edges, final_map.edges, tracked.edges);
    compare(errors.drops, final_map.drops, tracked.drops);
    compare(errors.kerbs, final_map.kerbs, tracked.kerbs);
    compare(errors.sills, final_map.sills, tracked.sills);
    compare(errors.flights, final_map.flights, tracked.flights);
    compare(errors.doors, final_map.doors, tracked.doors);
    return split_by_confirmation(std::move(tracked));
}

std::string features_count_text(const RunFeatures& features) {
    std::string text = features_count_text(features.confirmed);
    const std::size_t drops = features.unconfirmed.drops.size();
    if (drops > 0)
        text += fmt::format(
            "; {} drop{} not confirmed by a second observation", drops, drops == 1 ? "" : "s");
    return text;
}

}  // namespace surefoot::app
