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

/// How numbers become colours.
struct LayerStyle {
    FigureText text;
    std::string unit;  ///< on the legend
    ColorMap map = ColorMap::viridis;
    std::optional<ValueRange> range;  ///< nothing: 1st to 99th percentile of the known values
    double min_span = 0.0;            ///< a range found from the values is at least this wide
    std::optional<double> centre;     ///< middle of a diverging map; nothing: middle of the range
    std::string low_word;             ///< diverging maps: beside the legend below the centre
    std::string high_word;
    double value_scale = 1.0;   ///< shown = value_scale * stored, e.g. 1000 for mm
    bool hill_shading = false;  ///< lets heights look like ground lit from the upper left
};

/// Ready-made styles; `subtitle` may be changed afterwards.
[[nodiscard]] LayerStyle elevation_style();
[[nodiscard]] LayerStyle traversability_style(double safe_threshold);
/// For one-sigma heights stored in m, shown in mm.
[[nodiscard]] LayerStyle height_sigma_style();

/// Range of the shown values by the rule of LayerStyle; {0, 1} when nothing is known.
[[nodiscard]] ValueRange shown_range(const Image<float>& values, const LayerStyle& style);

/// A map layer seen from above, x forward up and y left, one square per cell; unknown is hatched
/// grey. Values outside the range take the colour of its end; the legend then ends in a point.
[[nodiscard]] Picture render_layer(const grid::GridGeometry& geometry,
                                   const grid::Layer& layer,
                                   const LayerStyle& style,
                                   const Overlays& overlays);

/// Cells in colours of their own, hatched grey where they have none, and what the colours mean.
[[nodiscard]] Picture render_cells(const grid::GridGeometry& geometry,
                                   const Image<std::optional<Rgb8>>& colors,
                                   const std::vector<KeyEntry>& meaning,
                                   const FigureText& text,
                                   const Overlays& overlays);

/// Height error live - truth in mm: red = the map is too low (truth above it), blue = too high.
[[nodiscard]] Picture render_error_map(const grid::GridGeometry& geometry,
                                       const grid::Layer& error_m,
                                       const FigureText& text,
                                       const Overlays& overlays);

/// What the live map calls safe is white, unsafe black; the dot says whether that is right: green =
/// right, blue on white = unsafe called safe, orange on black = safe called unsafe. These are the
/// colours of the thesis (9.2), but for its red, which some eyes cannot tell from the green.
[[nodiscard]] Picture render_confusion(const grid::GridGeometry& geometry,
                                       const Image<Call>& calls,
                                       const FigureText& text,
                                       const Overlays& overlays);

/// The same colours without title, axes and key, cut to the cells that the live map knows and to
/// the way (at least `kThumbnailCells` wide and high); empty where nothing is known.
inline constexpr int kThumbnailCells = 80;
[[nodiscard]] Picture render_confusion_thumbnail(const grid::GridGeometry& geometry,
                                                 const Image<Call>& calls,
                                                 const Overlays& overlays);

/// What the colours of a confusion map mean, as words.
inline constexpr const char* kConfusionLegend =
    "White: the map calls it safe, black: unsafe. The dot says whether that is right: green = yes, "
    "blue on white = called safe and is NOT, orange on black = called unsafe and is safe. Grey: "
    "never seen.";

[[nodiscard]] Picture render_camera_image(const GreyImage& image, const FigureText& text);

/// Disparity [px] of the rectified left image. With `depth_times_disparity_m_px` (focal length
/// times baseline) > 0 the legend also shows the depth in m.
[[nodiscard]] Picture render_disparity(const Image<float>& disparity_px,
                                       double depth_times_disparity_m_px,
                                       const FigureText& text);

/// One sigma of a per-pixel quantity in `unit`.
[[nodiscard]] Picture render_sigma(const Image<float>& sigma,
                                   const std::string& unit,
                                   const FigureText& text);

/// Positions seen from above. `truth` may be empty; both are drawn as they are (align before).
[[nodiscard]] Picture render_trajectory(const Trajectory& estimate,
                                        const Trajectory& truth,
                                        const FigureText& text);

/// How far a pose was from its true one.
struct ErrorSample {
    double time_s = 0.0;
    double error_m = 0.0;
};
/// Error over time as a line, in mm or, from 1 m on, in m; samples in time order.
[[nodiscard]] Picture render_error_over_time(const std::vector<ErrorSample>& samples,
                                             const FigureText& text);

/// Two pictures on one sheet, one below the other.
[[nodiscard]] Picture stacked(const Picture& upper, const Picture& lower);

}  // namespace surefoot::eval
