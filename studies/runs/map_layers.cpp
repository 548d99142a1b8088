// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/map_layers.hpp"

#include <cmath>
#include <string_view>
#include <utility>

#include "studies/runs/run_output.hpp"
#include "surefoot/core/assert.hpp"
#include "surefoot/elevation/fusion/height_bounds.hpp"
#include "surefoot/grid/tilt_variance.hpp"
#include "surefoot/traversability/rating_confidence.hpp"

namespace surefoot::app {
namespace {

/// Converts the variance layer to standard deviations for display.
grid::Layer shown(const NamedLayer& layer) {
    grid::Layer values = layer.values;
    if (std::string_view(layer.name) != "variance") return values;
    for (std::size_t i = 0; i < values.size(); ++i) values.data()[i] = std::sqrt(values.data()[i]);
    return values;
}

bool is_height(std::string_view name) {
    return name == "elevation" || name == "highest" || name == "lowest" || name == "lower_bound" ||
           name == "upper_bound";
}

/// Returns for each cell: 1 = safe, 0 = proven unsafe, 0.5 = undecided or unreachable, NaN =
/// unknown.
grid::Layer foothold_layer(const pipeline::Pipeline& pipeline) {
    using traversability::Foothold;
    const Image<Foothold> holds = pipeline.footholds();
    grid::Layer layer(holds.width(), holds.height(), 0.0F);
    for (std::size_t i = 0; i < holds.size(); ++i) {
        if (holds.data()[i] == Foothold::unknown) layer.data()[i] = std::nanf("");
        if (holds.data()[i] == Foothold::safe) layer.data()[i] = 1.0F;
        if (holds.data()[i] == Foothold::unsure || holds.data()[i] == Foothold::unreachable)
            layer.data()[i] = 0.5F;
    }
    return layer;
}

/// Returns the confidence of the ratings.
traversability::ConfidenceLayers rating_confidence(const pipeline::Pipeline& pipeline) {
    const auto& map = pipeline.map().layers();
    const grid::Layer surface_m = pipeline.surface_m();
    const double resolution_m = pipeline.map().geometry().resolution_m;
    traversability::Traversability rater(pipeline.config().traversability.widened_to(resolution_m));
    traversability::TraversabilityLayers rating;
    rater.rate(surface_m.view(), resolution_m, serial(), rating);
    traversability::ConfidenceLayers confidence;
    traversability::RatingConfidence(rater.config(), resolution_m)
        .compute({surface_m.view(), map.height_var_m2.view(), rater.rated_step_heights(), rating},
                 confidence);
    return confidence;
}

}  // namespace

std::vector<NamedLayer> all_layers(const pipeline::Pipeline& pipeline) {
    const grid::GridGeometry& geometry = pipeline.map().geometry();
    const auto& map = pipeline.map().layers();
    const auto& rating = pipeline.rating();
    grid::Layer lower_m;
    grid::Layer upper_m;
    const grid::Layer variance_m2 = grid::with_tilt_variance(
        map.height_var_m2.view(), geometry, pipeline.alignment().tilt_sigma_rad);
    elevation::HeightBounds().compute({map.height_m.view(),
                                       variance_m2.view(),
                                       map.horizontal_drift_m.view(),
                                       geometry.resolution_m},
                                      serial(),
                                      lower_m,
                                      upper_m);
    traversability::ConfidenceLayers ratings = rating_confidence(pipeline);
    grid::Layer count(geometry.nx, geometry.ny);
    for (std::size_t i = 0; i < count.size(); ++i) {
        const bool known = !std::isnan(map.height_m.data()[i]);
        count.data()[i] = known ? static_cast<float>(map.count.data()[i]) : std::nanf("");
    }
    std::vector<NamedLayer> layers{{"elevation", pipeline.surface_m()},
                                   {"variance", map.height_var_m2.copy()},
                                   {"drift", map.horizontal_drift_m.copy()},
                                   {"confidence", map.confidence.copy()},
                                   {"count", std::move(count)},
                                   {"density_ratio", map.density_ratio.copy()},
                                   {"highest", map.highest_m.copy()},
                                   {"lowest", map.lowest_m.copy()},
                                   {"clearance", map.clearance_m.copy()},
                                   {"free_above", map.free_above_m.copy()},
                                   {"foothold", foothold_layer(pipeline)},
                                   {"normal_x", rating.normal_x},
                                   {"normal_y", rating.normal_y},
                                   {"normal_z", rating.normal_z},
                                   {"slope", rating.slope},
                                   {"step", rating.step},
                                   {"roughness", rating.roughness},
                                   {"lower_bound", lower_m},
                                   {"upper_bound", upper_m},
                                   {"rating_confidence", std::move(ratings.confidence)},
                                   {"smallest_step", std::move(ratings.smallest_step_m)},
                                   {"not_resolvable", std::move(ratings.not_resolvable)},
                                   {"reach_step", pipeline.reach_step_m()},
                                   {"traversability", rating.traversability}};
    SUREFOOT_ASSERT(layers.size() == kLayerNames.size());
    for (std::size_t i = 0; i < layers.size(); ++i) {
        SUREFOOT_ASSERT(std::string_view(layers[i].name) == kLayerNames[i]);
        layers[i].values = or_unknown(layers[i].values, geometry);
    }
    return layers;
}

std::vector<std::uint8_t> layer_sheet_png(const grid::GridGeometry& geometry,
                                          std::span<const NamedLayer> layers,
                                          double safe_threshold,
                                          int columns,
                                          const eval::FigureText& text,
                                          const eval::Overlays& overlays) {
    std::optional<eval::ValueRange> heights_m;
    std::vector<eval::SheetLayer> sheet;
    sheet.reserve(layers.size());
    for (const NamedLayer& layer : layers) {
        sheet.push_back({shown(layer), eval::style_of_layer(layer.name, safe_threshold)});
        eval::SheetLayer& added = sheet.back();
        if (!is_height(layer.name)) continue;
        if (!heights_m) heights_m = eval::shown_range(added.values, added.style);
        added.style.range = heights_m;
    }
    return eval::encode_png(eval::render_layer_sheet(geometry, sheet, columns, text, overlays));
}

}  // namespace surefoot::app
