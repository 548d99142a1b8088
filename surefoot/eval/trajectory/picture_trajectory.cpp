// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "surefoot/eval/report/canvas.hpp"
#include "surefoot/eval/report/picture.hpp"

namespace surefoot::eval {
namespace {

constexpr double kLongSide_px = 860.0;
constexpr double kSmallestExtent_m = 0.1;
constexpr double kLargestAspect = 1.6;  ///< longer side of the plot divided by its shorter side
constexpr double kBorderShare = 0.07;
constexpr Rgb8 kTruth{246, 178, 107};  ///< pale: the estimate stays visible on the wide line

std::vector<Eigen::Vector2d> ground_track(const Trajectory& trajectory) {
    std::vector<Eigen::Vector2d> points_m;
    for (const StampedPose& pose : trajectory) {
        const Eigen::Vector2d p_m = pose.T_world_body.translation_m.head<2>();
        if (p_m.allFinite()) points_m.push_back(p_m);
    }
    return points_m;
}

struct Box {
    Eigen::Vector2d low_m;
    Eigen::Vector2d high_m;
};

/// Returns a box around all points with a margin. The box is never a single point or a narrow
/// strip.
Box view_box(const std::vector<Eigen::Vector2d>& a, const std::vector<Eigen::Vector2d>& b) {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(HUGE_VAL);
    Eigen::Vector2d high = -low;
    for (const auto* track : {&a, &b}) {
        for (const Eigen::Vector2d& p_m : *track) {
            low = low.cwiseMin(p_m);
            high = high.cwiseMax(p_m);
        }
    }
    if (a.empty() && b.empty()) low = high = Eigen::Vector2d::Zero();
    const Eigen::Vector2d middle = 0.5 * (low + high);
    Eigen::Vector2d extent = (high - low).cwiseMax(kSmallestExtent_m) * (1.0 + 2.0 * kBorderShare);
    extent = extent.cwiseMax(extent.maxCoeff() / kLargestAspect);
    return {middle - 0.5 * extent, middle + 0.5 * extent};
}

MapView view_of(const Box& box) {
    const Eigen::Vector2d extent_m = box.high_m - box.low_m;
    MapView view;
    view.px_per_m = kLongSide_px / extent_m.maxCoeff();
    view.plot.width = nearest_px(extent_m.y() * view.px_per_m);
    view.plot.height = nearest_px(extent_m.x() * view.px_per_m);
    view.x_max_m = box.high_m.x();
    view.y_max_m = box.high_m.y();
    return view;
}

void draw_end(Picture& picture, PointPx center, Rgb8 fill) {
    fill_circle(picture, center, 9.0, palette::kPaper);
    fill_circle(picture, center, 7.0, palette::kInk);
    fill_circle(picture, center, 5.0, fill);
}

/// Draws a word beside an end of the track, on the side with more space.
void draw_end_word(Picture& picture, PointPx center, int plot_width, double dv, const char* word) {
    TextStyle style;
    style.halo = true;
    style.anchor = center.u < 0.7 * plot_width ? TextAnchor::left : TextAnchor::right;
    const double du = style.anchor == TextAnchor::left ? 16.0 : -16.0;
    draw_text(picture, {center.u + du, center.v + dv}, word, style);
}

void draw_tracks(Picture& picture,
                 const MapView& view,
                 const std::vector<Eigen::Vector2d>& estimate_m,
                 const std::vector<Eigen::Vector2d>& truth_m) {
    Picture part(view.plot.width, view.plot.height, palette::kPaper);
    MapView inside = view;
    inside.plot.left = 0;
    inside.plot.top = 0;
    draw_path(part, inside, truth_m, kTruth, 9);
    draw_path(part, inside, estimate_m, palette::kSafe, 3);
    draw_scale_bar(part, inside);
    if (!estimate_m.empty()) {
        const PointPx start = inside.to_px(estimate_m.front());
        const PointPx end = inside.to_px(estimate_m.back());
        const bool close = std::hypot(start.u - end.u, start.v - end.v) < 40.0;
        draw_end(part, start, palette::kPaper);
        draw_end(part, end, palette::kInk);
        draw_end_word(part, start, view.plot.width, close ? 14.0 : 0.0, "start");
        draw_end_word(part, end, view.plot.width, close ? -14.0 : 0.0, "end");
    }
    paste(picture, part, view.plot.left, view.plot.top);
}

}  // namespace

Picture render_trajectory(const Trajectory& estimate,
                          const Trajectory& truth,
                          const FigureText& text) {
    const auto estimate_m = ground_track(estimate);
    const auto truth_m = ground_track(truth);
    std::vector<KeyEntry> key;
    key.push_back({Symbol::line, palette::kSafe, "estimate", {}});
    if (!truth_m.empty()) key.push_back({Symbol::line, kTruth, "truth", {}});
    MapView view = view_of(view_box(estimate_m, truth_m));
    Figure figure =
        make_figure(view.plot.width, view.plot.height, true, column_size(key, BarKind::none), text);
    view.plot = figure.plot;
    draw_tracks(figure.picture, view, estimate_m, truth_m);
    draw_axes(figure.picture, view);
    draw_key(figure, figure.column.top, key);
    return std::move(figure.picture);
}

}  // namespace surefoot::eval
