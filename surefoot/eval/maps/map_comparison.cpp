// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/maps/map_comparison.hpp"

#include <cmath>
#include <limits>
#include <span>

#include "surefoot/grid/tilt_variance.hpp"

namespace surefoot::eval {
namespace {

/// Borders of the distance bins. Bins are 0.5 m wide where the next steps land, and wider farther
/// away.
constexpr double kDistanceEdges_m[] = {0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0};
/// Number of bins over the columns of the image: large enough to separate the sides of the image
/// from its middle, small enough to fill each bin.
constexpr int kColumnBins = 8;

std::span<const float> values_of(const grid::Layer& layer) {
    return {layer.data(), layer.size()};
}

grid::Layer masked(const grid::Layer& layer, const CellMask& mask) {
    grid::Layer result = layer;
    for (std::size_t i = 0; i < result.size(); ++i) {
        if (mask.data()[i] == 0) result.data()[i] = std::numeric_limits<float>::quiet_NaN();
    }
    return result;
}

grid::Layer sigma_of(const grid::Layer& var_m2) {
    grid::Layer sigma_m = var_m2;
    for (std::size_t i = 0; i < sigma_m.size(); ++i)
        sigma_m.data()[i] = std::sqrt(sigma_m.data()[i]);
    return sigma_m;
}

/// Returns the edges of equally wide bins over the image, in pixel coordinates (pixel 0 begins at
/// -0.5).
std::vector<double> column_edges(int width) {
    std::vector<double> edges_px;
    for (int k = 0; k <= kColumnBins; ++k)
        edges_px.push_back(-0.5 + width * k / double{kColumnBins});
    return edges_px;
}

void compare_by_camera(const MapPair& maps,
                       const grid::Layer& error_m,
                       const CellMask& floor,
                       MapComparison& result) {
    const CameraTrack& camera = *maps.camera;
    const Sightings seen = last_sightings(
        maps.geometry, maps.live_m, camera.T_world_camera, camera.view, camera.max_depth_m);
    const auto edges_px = column_edges(camera.view.width);
    result.by_column = by_bins(values_of(error_m), values_of(seen.column_px), edges_px);
    result.by_range = by_bins(values_of(error_m), values_of(seen.range_m), kDistanceEdges_m);
    const HeightJumps jumps = height_jumps(maps.live_m, floor, seen.column_px);
    result.edges_by_column = by_bins(jumps.jump_m, jumps.key, edges_px);
}

}  // namespace

MapComparison compare_maps(const MapPair& maps, const EvalMapsConfig& config) {
    MapComparison result;
    const CellMask away = away_from_edges(maps.truth_m, config);
    const CellMask floor = level_floor(maps.truth_m, config);
    const grid::Layer& compared_m = maps.compared_m.empty() ? maps.truth_m : maps.compared_m;
    result.error_m = height_error(maps.live_m, compared_m);
    result.elevation = elevation_errors(maps.live_m, compared_m, {}, config);
    result.elevation_away_from_edges = elevation_errors(maps.live_m, compared_m, away, config);
    result.coverage = coverage(maps.live_m, maps.truth_m, {});
    result.calls =
        classify(maps.live_traversability, maps.truth_traversability, config.safe_threshold);
    result.traversability = traversability_errors(result.calls, {});

    const grid::Layer error_m = masked(result.error_m, away);
    const grid::Layer sigma_m =
        maps.live_var_m2.empty()
            ? grid::Layer(error_m.width(), error_m.height(), std::nanf(""))
            : sigma_of(grid::with_tilt_variance(
                  maps.live_var_m2.view(), maps.geometry, maps.tilt_sigma_rad));
    result.sigma = sigma_coverage(values_of(error_m), values_of(sigma_m));
    result.edges = error_figures(height_jumps(maps.live_m, floor, {}).jump_m);
    result.floor = floor_spread(maps.geometry, maps.live_m, floor);
    if (!maps.trajectory.empty()) {
        const grid::Layer distance_m = distance_to(maps.geometry, maps.trajectory);
        result.by_distance = by_bins(values_of(error_m), values_of(distance_m), kDistanceEdges_m);
    }
    if (maps.camera) compare_by_camera(maps, error_m, floor, result);
    return result;
}

}  // namespace surefoot::eval
