// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "surefoot/core/views.hpp"
#include "surefoot/eval/maps/map_view.hpp"
#include "surefoot/eval/maps/maps.hpp"
#include "surefoot/eval/report/canvas.hpp"
#include "surefoot/eval/report/colormap.hpp"
#include "surefoot/eval/report/figure.hpp"
#include "surefoot/eval/trajectory/trajectory.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::eval {

struct ValueRange {
    double low = 0.0;
    double high = 1.0;
};

/// Mapping from numbers to colours.
struct LayerStyle {
    FigureText text;
    std::string unit;  ///< unit in the legend
    ColorMap map = ColorMap::viridis;
    std::optional<ValueRange> range;  ///< no value: 1st to 99th percentile of the known values
    double min_span = 0.0;            ///< smallest width of a range computed from the values
    std::optional<double> centre;     ///< middle of a diverging map; no value: middle of the range
    std::string low_word;             ///< diverging maps: word beside the legend, below the centre
    std::string high_word;
    double value_scale = 1.0;   ///< shown = value_scale * stored, e.g. 1000 for mm
    bool hill_shading = false;  ///< shades heights like ground lit from the upper left
};

/// Predefined styles; callers may change the subtitle.
[[nodiscard]] LayerStyle elevation_style();
[[nodiscard]] LayerStyle traversability_style(double safe_threshold);
/// Style for the sigma of heights, which is stored in m and shown in mm.
[[nodiscard]] LayerStyle height_sigma_style();

/// Returns the range of shown values as LayerStyle defines it; {0, 1} if no value is known.
[[nodiscard]] ValueRange shown_range(const Image<float>& values, const LayerStyle& style);

/// Draws a map layer from above: x forward is up, y left is left. Unknown cells are hatched grey.
/// Values outside the range take the colour of the legend's end; the legend then ends in a point.
[[nodiscard]] Picture render_layer(const grid::GridGeometry& geometry,
                                   const grid::Layer& layer,
                                   const LayerStyle& style,
                                   const Overlays& overlays);

/// Draws cells in given colours, hatched grey without a colour, with a legend.
[[nodiscard]] Picture render_cells(const grid::GridGeometry& geometry,
                                   const Image<std::optional<Rgb8>>& colors,
                                   const std::vector<KeyEntry>& meaning,
                                   const FigureText& text,
                                   const Overlays& overlays);

/// Draws the height error live - truth in mm. Red = the map is too low, blue = too high.
[[nodiscard]] Picture render_error_map(const grid::GridGeometry& geometry,
                                       const grid::Layer& error_m,
                                       const FigureText& text,
                                       const Overlays& overlays);

/// Draws white cells where the live map says safe, and black cells where it says unsafe. Dots:
/// green = right, blue on white = unsafe rated safe, orange on black = safe rated unsafe. Colours
/// of Lange 2016, section 9.2, except its red: some people confuse this red with the green.
[[nodiscard]] Picture render_confusion(const grid::GridGeometry& geometry,
                                       const Image<Call>& calls,
                                       const FigureText& text,
                                       const Overlays& overlays);

/// Draws only the map of render_confusion. Shows the cells that both maps know, and the path, but
/// at least `kThumbnailCells` (or the whole map) along each axis. Empty without such cells.
inline constexpr int kThumbnailCells = 80;
[[nodiscard]] Picture render_confusion_thumbnail(const grid::GridGeometry& geometry,
                                                 const Image<Call>& calls,
                                                 const Overlays& overlays);

/// Explains the colours of a confusion map in words.
inline constexpr const char* kConfusionLegend =
    "White cells are safe according to the map, black cells unsafe. Green dot: the map is right. "
    "Blue dot on white: the map says safe, but it is NOT safe. Orange dot on black: the map says "
    "unsafe, but it is safe. Grey cells are unknown in the live map.";

[[nodiscard]] Picture render_camera_image(const GreyImage& image, const FigureText& text);

/// Draws the disparity [px] of the rectified left image. If `depth_times_disparity_m_px` (focal
/// length times baseline) is above 0, the legend also shows the depth in m.
[[nodiscard]] Picture render_disparity(const Image<float>& disparity_px,
                                       double depth_times_disparity_m_px,
                                       const FigureText& text);

/// Draws one sigma of a quantity per pixel, in `unit`.
[[nodiscard]] Picture render_sigma(const Image<float>& sigma,
                                   const std::string& unit,
                                   const FigureText& text);

/// Draws positions from above. `truth` may be empty. Does not align the paths: align them before.
[[nodiscard]] Picture render_trajectory(const Trajectory& estimate,
                                        const Trajectory& truth,
                                        const FigureText& text);

/// Error of a pose at one time.
struct ErrorSample {
    double time_s = 0.0;
    double error_m = 0.0;
};
/// Draws the error over time as a line, in mm, or in m from 1 m on. Samples are in time order.
[[nodiscard]] Picture render_error_over_time(const std::vector<ErrorSample>& samples,
                                             const FigureText& text);

/// Joins two pictures on one sheet, one below the other.
[[nodiscard]] Picture stacked(const Picture& upper, const Picture& lower);

}  // namespace surefoot::eval
