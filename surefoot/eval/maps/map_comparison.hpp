// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "surefoot/eval/maps/map_edges.hpp"
#include "surefoot/eval/maps/maps.hpp"
#include "surefoot/eval/maps/sightings.hpp"
#include "surefoot/eval/report/error_bins.hpp"

namespace surefoot::eval {

/// The camera of a run, for the image column where each cell was seen.
struct CameraTrack {
    PinholeView view;
    Trajectory T_world_camera;  ///< optical frame in the map's frame, in time order
    double max_depth_m = 10.0;  ///< beyond it nothing was mapped
};

/// A live map and the truth on the same cells; a layer that is not there is empty.
struct MapPair {
    grid::GridGeometry geometry;
    grid::Layer live_m;
    grid::Layer live_var_m2;  ///< may be empty
    /// One sigma of the angle between the live map's z axis and the vertical, about any horizontal
    /// axis: what it does to heights counts in `MapComparison::sigma`. NaN = not known.
    double tilt_sigma_rad = 0.0;
    grid::Layer live_traversability;
    grid::Layer truth_m;
    /// The true surface that each live height is compared with, where that is not the highest one:
    /// floor under a table top. Empty = truth_m.
    grid::Layer compared_m;
    grid::Layer truth_traversability;
    Trajectory trajectory;              ///< base_link in the map's frame; may be empty
    std::optional<CameraTrack> camera;  ///< nothing: no figures by column and range
};

/// Everything that is measured about one live map. Figures without cells are NaN, lists without
/// their input are empty. Lengths in m.
struct MapComparison {
    ElevationErrors elevation;
    ElevationErrors elevation_away_from_edges;
    std::vector<ErrorBin> by_distance;  ///< to the nearest position of the machine [m]
    std::vector<ErrorBin> by_range;     ///< from the camera that saw the cell last [m]
    std::vector<ErrorBin> by_column;    ///< of the image where the cell was seen last [px]
    SigmaCoverage sigma;                ///< of the height, away from edges
    double coverage = 0.0;
    TraversabilityErrors traversability;
    ErrorFigures edges;                     ///< |jumps| between neighbours on the level floor
    std::vector<ErrorBin> edges_by_column;  ///< [px]
    FloorSpread floor;                      ///< of the level floor's cells
    Image<Call> calls;
    grid::Layer error_m;
};

/// Compares; nothing is aligned. Edges and floor look at level_floor of the truth. By distance,
/// range and column: the errors away from edges, since a cell at a step is off by the step when the
/// map is shifted by one cell, wherever it was seen.
[[nodiscard]] MapComparison compare_maps(const MapPair& maps, const EvalMapsConfig& config);

}  // namespace surefoot::eval
