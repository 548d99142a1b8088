// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/core/pose.hpp"
#include "surefoot/eval/report/canvas.hpp"
#include "surefoot/eval/report/colormap.hpp"
#include "surefoot/eval/report/figure.hpp"

namespace surefoot::eval {

/// Top view of the ground: x forward is up, y left is left.
struct MapView {
    RectPx plot;
    double x_max_m = 0.0;  ///< x at the upper border
    double y_max_m = 0.0;  ///< y at the left border
    double px_per_m = 1.0;

    [[nodiscard]] PointPx to_px(const Eigen::Vector2d& p_m) const {
        return {plot.left + (y_max_m - p_m.y()) * px_per_m,
                plot.top + (x_max_m - p_m.x()) * px_per_m};
    }
    [[nodiscard]] Eigen::Vector2d from_px(PointPx p) const {
        return {x_max_m - (p.v - plot.top) / px_per_m, y_max_m - (p.u - plot.left) / px_per_m};
    }
    [[nodiscard]] double x_min_m() const { return x_max_m - plot.height / px_per_m; }
    [[nodiscard]] double y_min_m() const { return y_max_m - plot.width / px_per_m; }
};

/// A closed line over a map; coordinates in the map's frame [m].
struct Outline {
    std::vector<Eigen::Vector2d> points_m;
    Rgb8 color = palette::kInk;
    std::string label;  ///< legend text; outlines with equal labels share one entry
};
/// A line over a map, drawn with a white edge.
struct Stroke {
    std::vector<Eigen::Vector2d> points_m;
    Rgb8 color = palette::kInk;
    int width_px = 4;
    /// Legend entry, as for outlines; a line break starts a new row.
    std::string label = {};
    bool ticks = false;  ///< draws ticks on the right of the line: the ground falls there
    bool arrow = false;  ///< draws an arrow at the last point
};
/// A short text on a disc, for example the number of a step. A badge that would cover an earlier
/// badge is left out.
struct Badge {
    Eigen::Vector2d point_m = Eigen::Vector2d::Zero();
    std::string text;
    Rgb8 color = palette::kInk;
};
/// Small squares at positions, drawn below all lines.
struct Dots {
    std::vector<Eigen::Vector2d> points_m;
    Rgb8 color = palette::kInk;
    std::string label;  ///< legend text; used if there are points
};
struct Mark {
    Eigen::Vector2d point_m = Eigen::Vector2d::Zero();
    std::string label;  ///< text in the legend: text on the map would hide cells
};
struct Overlays {
    std::optional<Pose> T_odom_body;
    std::vector<Outline> outlines;  ///< closed lines, for example footprints
    std::vector<Eigen::Vector2d> trajectory_m;
    std::vector<Stroke> strokes;
    std::vector<Badge> badges;
    std::vector<Mark> marks;
    Dots dots;
    bool scale_bar = true;
    /// Arrow length of the body symbol [px]. No value: 0.35 m of the map, but at least 30 px.
    std::optional<double> body_px = {};
};

/// Draws ticks and names of the two axes around the plot.
void draw_axes(Picture& picture, const MapView& view);
/// Draws a bar of 1 m, or of another round length if 1 m does not fit the plot, in the lower left
/// corner. A plot that is too small gets no bar.
void draw_scale_bar(Picture& picture, const MapView& view);
/// Draws the overlays, only inside the plot.
void draw_overlays(Picture& picture, const MapView& view, const Overlays& overlays);
[[nodiscard]] std::vector<KeyEntry> key_of(const Overlays& overlays);

/// Draws `points_m` as a line.
void draw_path(Picture& picture,
               const MapView& view,
               const std::vector<Eigen::Vector2d>& points_m,
               Rgb8 color,
               int width_px);

}  // namespace surefoot::eval
