// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/stairs/edges/edge_lines.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Where the ground above an edge ends in one row or column of cells, in the frame of a line.
struct BorderPoint {
    double s_m = 0.0;  ///< across the line, on its lower side
    double t_m = 0.0;  ///< along it, from its beginning
    int edge = 0;      ///< which one of several parallel edges
};

/// What is asked of border_points.
struct BorderSearch {
    int edge = 0;             ///< number that the points get
    double at_m = 0.0;        ///< where about the edge lies, across the line
    double upper_m = 0.0;     ///< height of the ground above it
    double below_m = 0.0;     ///< that ground is lower nowhere by more
    double inside_m = 0.07;   ///< the walk begins so far before the edge, on the upper ground ...
    double outside_m = 0.12;  ///< ... and ends so far behind it
    double cell_reach = 1.0;  ///< see StairsConfig
    double beside_m = 0.0;    ///< rows beyond the ends of the line that are looked at too
};

/// How far below its level a cell is still upper ground: what its cells scatter by, but never
/// enough to be taken for the riser.
[[nodiscard]] double upper_tolerance_m(double scatter_m, double rise_m);

/// Walks from the upper ground over the edge, row by row (columns where the line runs along the
/// rows), and adds the place where it falls below its level, between the middles of two cells. A
/// tenth of the step below it, not half: cells before a riser hold points of it, which depth noise
/// moves by several cells when the riser is far, and those behind it hold them too; of both, the
/// highest count.
void add_border_points(const Terrain& terrain,
                       const EdgeLine& line,
                       const BorderSearch& search,
                       std::vector<BorderPoint>& out);

/// Points of a riser lie within this much of it, but not those of the next.
inline constexpr double kFace_m = 0.08;
/// One sigma of what all points of a face share: of a matcher's errors no more cancels out.
inline constexpr double kFaceShared_px = 0.05;
/// An edge with fewer points of its face is placed by the ground above it.
inline constexpr std::size_t kLeastPoints = 10;

/// The same, but adds where the vertical face below the edge stands: the middle of the points that
/// its cells show beyond those of level ground (`Terrain::density_ratio`), in each row that shows
/// enough of them, if enough rows do. Depth noise moves them both ways, so that their middle stays;
/// the cells' heights take the highest and move one way.
void add_face_points(const Terrain& terrain,
                     const EdgeLine& line,
                     const BorderSearch& search,
                     std::vector<BorderPoint>& out);

/// One of several parallel edges.
struct ParallelEdge {
    double at_m = 0.0;   ///< across, at `middle_t_m`
    double rms_m = 0.0;  ///< of its points, as far as they count
    int points = 0;
};

/// Places parallel edges by all their points together: s = at + turn (t - middle_t), robust least
/// squares (Huber's weights) that begins at the medians. Returns the turn [rad]; an edge without
/// points keeps its place. `edges` are numbered as the points say.
double fit_parallel(std::span<const BorderPoint> points,
                    double middle_t_m,
                    std::span<ParallelEdge> edges);

/// One sigma of where an edge lies, from the scatter of its points about it.
[[nodiscard]] double across_sigma_m(const grid::GridGeometry& grid,
                                    const EdgeLine& line,
                                    double rms_m);

/// The longest piece of an edge that its points show, without gaps of more than `max_gap_m`; points
/// further than `near_m` across from `at_m` do not count. Ends before it begins if there is none.
struct Extent {
    double from_m = 0.0;
    double to_m = -1.0;
};
[[nodiscard]] Extent longest_run(
    std::span<const BorderPoint> points, int edge, double at_m, double near_m, double max_gap_m);

}  // namespace surefoot::stairs
