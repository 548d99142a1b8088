// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/stairs/edges/edge_lines.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// The end of the upper ground in one row or column of cells, in the frame of an edge line.
struct BorderPoint {
    double s_m = 0.0;  ///< position across the line; positive on its lower side
    double t_m = 0.0;  ///< position along the line, from its beginning
    int edge = 0;      ///< number of the edge among parallel edges
};

/// Parameters of a search for border points.
struct BorderSearch {
    int edge = 0;             ///< edge number of the found points
    double at_m = 0.0;        ///< expected position of the edge, across the line
    double upper_m = 0.0;     ///< height of the ground above the edge
    double below_m = 0.0;     ///< cells may lie this much below `upper_m` and still be upper ground
    double inside_m = 0.07;   ///< the search begins this far before the edge, on the upper ground
    double outside_m = 0.12;  ///< the search ends this far behind the edge
    double cell_reach = 1.0;  ///< see StairsConfig
    double beside_m = 0.0;    ///< the search also covers rows up to this far beyond the line's ends
};

/// Largest depth of an upper cell below the upper level. It follows from the scatter of the cells,
/// but is always less than the riser.
[[nodiscard]] double upper_tolerance_m(double scatter_m, double rise_m);

/// Walks from the upper ground across the edge, row by row (by column where the line runs along the
/// rows). Adds the point between two cell centres where the ground falls below a threshold:
/// `below_m` under the upper level, see upper_tolerance_m(). Depth noise moves the points of a
/// distant riser's face by several cells, and a cell keeps its highest point. So cells before and
/// behind the riser may hold a height of the face.
void add_border_points(const Terrain& terrain,
                       const EdgeLine& line,
                       const BorderSearch& search,
                       std::vector<BorderPoint>& out);

/// Largest distance of a face point from its riser; well below the distance to the next riser.
inline constexpr double kFace_m = 0.08;
/// One sigma of the error that all points of a face share; averaging cannot reduce it.
inline constexpr double kFaceShared_px = 0.05;
/// An edge with fewer face points is placed by the ground above it.
inline constexpr std::size_t kLeastPoints = 10;

/// Adds the position of the vertical face below the edge instead of the border. The position in a
/// row is the middle of the points in excess of level ground (`Terrain::density_ratio`). Adds
/// nothing if too few rows show enough of them. Depth noise moves face points both ways, so their
/// middle is unbiased. Cell heights keep the highest point and are biased.
void add_face_points(const Terrain& terrain,
                     const EdgeLine& line,
                     const BorderSearch& search,
                     std::vector<BorderPoint>& out);

/// One of several parallel edges.
struct ParallelEdge {
    double at_m = 0.0;   ///< position across the line, at `middle_t_m`
    double rms_m = 0.0;  ///< weighted scatter of its points
    int points = 0;
};

/// Fits parallel edges to all their points at once: s = at + turn (t - middle_t). Robust least
/// squares (Huber weights) that starts at the medians. Returns the turn [rad]. `BorderPoint::edge`
/// is the index in `edges`; an edge without points keeps its position.
double fit_parallel(std::span<const BorderPoint> points,
                    double middle_t_m,
                    std::span<ParallelEdge> edges);

/// One sigma of the position of an edge, computed from the scatter of its points.
[[nodiscard]] double across_sigma_m(const grid::GridGeometry& grid,
                                    const EdgeLine& line,
                                    double rms_m);

/// The longest part of an edge that its points cover with gaps of at most `max_gap_m`. Points more
/// than `near_m` across from `at_m` do not count. Empty if to_m < from_m.
struct Extent {
    double from_m = 0.0;
    double to_m = -1.0;
};
[[nodiscard]] Extent longest_run(
    std::span<const BorderPoint> points, int edge, double at_m, double near_m, double max_gap_m);

}  // namespace surefoot::stairs
