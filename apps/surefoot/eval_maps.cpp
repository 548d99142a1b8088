// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/verbs.hpp"
#include "eval/maps.hpp"
#include "io/config_yaml.hpp"
#include "io/dem_file.hpp"
#include "io/file.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::app {
namespace {

/// The settings that the live run used, so that the truth goes through the identical chain.
Result<Settings> settings_of(const EvalMapsOptions& options) {
    CommonOptions common = options.common;
    const std::string used = options.live_dir + "/config.yaml";
    if (common.config_file.empty() && io::is_file(used)) common.config_file = used;
    return load_settings(common);
}

}  // namespace

int eval_maps(const EvalMapsOptions& options) {
    const auto settings = settings_of(options);
    if (!settings) return report(settings.error());
    const auto live = io::read_esri_grid(options.live_dir + "/elevation.asc");
    if (!live) return report(live.error());
    const auto live_rating = io::read_esri_grid(options.live_dir + "/traversability.asc");
    if (!live_rating) return report(live_rating.error());
    const auto truth = io::read_esri_grid(options.truth_dir + "/elevation.asc");
    if (!truth) return report(truth.error());

    const double resolution_m = live->geometry.resolution_m;
    const grid::Layer truth_m =
        eval::resample_nearest(truth->geometry, truth->values, live->geometry);
    Serial serial;
    traversability::TraversabilityLayers rated;
    traversability::rate(settings->pipeline.traversability.widened_to(resolution_m),
                         truth_m.view(),
                         resolution_m,
                         serial,
                         rated);

    const auto all = eval::elevation_errors(live->values, truth_m, {}, settings->maps);
    if (all.count == 0) {
        return report(input_error(
            fmt::format("{} and {} have no known cell in common: are both in the same frame?",
                        options.live_dir,
                        options.truth_dir)));
    }
    const auto away = eval::elevation_errors(
        live->values, truth_m, eval::away_from_edges(truth_m, settings->maps), settings->maps);
    const auto calls =
        eval::classify(live_rating->values, rated.traversability, settings->maps.safe_threshold);
    const auto confusion = eval::traversability_errors(calls, {});
    const double coverage = eval::coverage(live->values, truth_m, {});
    if (options.common.json) {
        fmt::print("{}\n", maps_json(all, away, confusion, coverage));
    } else {
        fmt::print(
            "elevation: median |error| {:.1f} mm, 90 % within {:.1f} mm, {} cells; away from edges "
            "{:.2f} % above 50 mm\n"
            "traversability: {:.2f} % of the unsafe cells called safe, {:.2f} % of the safe ones "
            "called unsafe\n"
            "{:.1f} % of the true cells are known\n",
            1e3 * all.median_abs_m,
            1e3 * all.p90_abs_m,
            all.count,
            100.0 * away.share_over_50mm,
            100.0 * confusion.false_safe,
            100.0 * confusion.false_unsafe,
            100.0 * coverage);
    }
    return kExitOk;
}

}  // namespace surefoot::app
