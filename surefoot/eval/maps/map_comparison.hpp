// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "surefoot/eval/maps/map_edges.hpp"
#include "surefoot/eval/maps/maps.hpp"
#include "surefoot/eval/maps/sightings.hpp"
#include "surefoot/eval/report/error_bins.hpp"

namespace surefoot::eval {

/// Camera of a run; used to find the image column of each cell at its last observation.
struct CameraTrack {
    PinholeView view;
    Trajectory T_world_camera;  ///< optical frame in the map's frame, in time order
    double max_depth_m = 10.0;  ///< cells farther away were not mapped
};

/// A live map and the truth on the same cells; an empty layer = not available.
struct MapPair {
    grid::GridGeometry geometry;
    grid::Layer live_m;
    grid::Layer live_var_m2;  ///< may be empty
    /// One sigma of the angle between the live map's z axis and the vertical, about any horizontal
    /// axis. `MapComparison::sigma` includes its effect on the heights. NaN = unknown.
    double tilt_sigma_rad = 0.0;
    grid::Layer live_traversability;
    grid::Layer truth_m;
    /// The true surface with which each live height is compared, if this is not the highest
    /// surface: for example the floor under a table top. Empty = truth_m.
    grid::Layer compared_m;
    grid::Layer truth_traversability;
    Trajectory trajectory;              ///< base_link in the map's frame; may be empty
    std::optional<CameraTrack> camera;  ///< needed for errors by column and range
};

/// All measurements of one live map. Fields without cells are NaN. Lists whose input is missing are
/// empty. Lengths in m.
struct MapComparison {
    ElevationErrors elevation;
    ElevationErrors elevation_away_from_edges;
    std::vector<ErrorBin> by_distance;  ///< distance to the nearest machine position [m]
    std::vector<ErrorBin> by_range;     ///< distance to the camera at the last observation [m]
    std::vector<ErrorBin> by_column;    ///< image column of the cell's last observation [px]
    SigmaCoverage sigma;                ///< coverage of the height sigma, away from edges
    double coverage = 0.0;
    TraversabilityErrors traversability;
    ErrorFigures edges;                     ///< jumps between cells of the level floor
    std::vector<ErrorBin> edges_by_column;  ///< jumps by image column [px]
    FloorSpread floor;                      ///< distances of the level floor's cells from a plane
    Image<Call> calls;
    grid::Layer error_m;
};

/// Compares the maps without any alignment. `edges` and `floor` use level_floor of the truth.
/// Errors by distance, range and column leave out edges. At an edge, a shift of the map by one cell
/// causes an error as large as the step.
[[nodiscard]] MapComparison compare_maps(const MapPair& maps, const EvalMapsConfig& config);

}  // namespace surefoot::eval
