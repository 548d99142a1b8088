// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "surefoot/eval/report/picture.hpp"
#include "surefoot/eval/report/ticks.hpp"

namespace surefoot::eval {
namespace {

constexpr int kWidth_px = 760;
constexpr int kHeight_px = 400;
constexpr int kTickLength_px = 6;
constexpr double kShowMetresFrom_m = 1.0;

/// Maps a time and an error to a position on the plot. The error axis begins at 0.
struct Axes {
    RectPx plot;
    double start_s = 0.0;
    double end_s = 1.0;
    double top = 1.0;  ///< upper end of the error axis in the displayed unit
    double per_m = 1e3;

    [[nodiscard]] PointPx to_px(double time_s, double error_m) const {
        return {plot.left + (time_s - start_s) / (end_s - start_s) * plot.width,
                plot.bottom() - error_m * per_m / top * plot.height};
    }
};

Axes axes_of(const RectPx& plot, const std::vector<ErrorSample>& samples) {
    Axes axes;
    axes.plot = plot;
    double largest_m = 0.0;
    for (const ErrorSample& sample : samples) largest_m = std::max(largest_m, sample.error_m);
    if (largest_m >= kShowMetresFrom_m) axes.per_m = 1.0;
    if (largest_m > 0.0) axes.top = 1.1 * largest_m * axes.per_m;
    if (samples.empty()) return axes;
    axes.start_s = samples.front().time_s;
    axes.end_s = std::max(samples.back().time_s, axes.start_s + 1e-3);
    return axes;
}

void draw_axes(Picture& picture, const Axes& axes) {
    const RectPx& plot = axes.plot;
    TextStyle style;
    style.cap_height_px = layout::kTextCap_px;
    draw_rect(picture, plot, 2, palette::kInk);
    style.anchor = TextAnchor::centre;
    const Ticks times = nice_ticks(axes.start_s, axes.end_s, kWidth_px / 110);
    for (const double time_s : times.values) {
        const double u = axes.to_px(time_s, 0.0).u;
        const double v = plot.bottom() + 2.0;
        draw_line(picture, {u, v}, {u, v + kTickLength_px}, 2, palette::kInk);
        draw_text(picture, {u, v + 22.0}, times.label(time_s), style);
    }
    style.anchor = TextAnchor::right;
    const Ticks errors = nice_ticks(0.0, axes.top, kHeight_px / 80);
    for (const double error : errors.values) {
        const double v = axes.to_px(axes.start_s, error / axes.per_m).v;
        draw_line(picture, {plot.left + 2.0, v}, {plot.right() - 3.0, v}, 1, palette::kFaint);
        draw_text(picture, {plot.left - 14.0, v}, errors.label(error), style);
    }
    style.anchor = TextAnchor::centre;
    style.color = palette::kSoftInk;
    draw_text(picture, {plot.left + 0.5 * plot.width, plot.bottom() + 60.0}, "time [s]", style);
    style.upward = true;
    const char* name = axes.per_m > 1.0 ? "position error [mm]" : "position error [m]";
    draw_text(picture, {28.0, plot.top + 0.5 * plot.height}, name, style);
}

/// Returns the largest error of each pixel column, so that the line of a long run keeps its peaks.
std::vector<PointPx> line_of(const Axes& axes, const std::vector<ErrorSample>& samples) {
    std::vector<PointPx> line;
    for (const ErrorSample& sample : samples) {
        if (!std::isfinite(sample.error_m)) continue;
        const PointPx p = axes.to_px(sample.time_s, sample.error_m);
        if (!line.empty() && std::floor(line.back().u) == std::floor(p.u)) {
            line.back().v = std::min(line.back().v, p.v);
        } else {
            line.push_back(p);
        }
    }
    return line;
}

}  // namespace

Picture render_error_over_time(const std::vector<ErrorSample>& samples, const FigureText& text) {
    Figure figure = make_figure(kWidth_px, kHeight_px, true, {}, text);
    const Axes axes = axes_of(figure.plot, samples);
    draw_axes(figure.picture, axes);
    const auto line = line_of(axes, samples);
    if (line.size() > 1) draw_polyline(figure.picture, line, 3, palette::kSafe);
    if (line.size() == 1) fill_circle(figure.picture, line[0], 4.0, palette::kSafe);
    return std::move(figure.picture);
}

Picture stacked(const Picture& upper, const Picture& lower) {
    Picture sheet(
        std::max(upper.width(), lower.width()), upper.height() + lower.height(), palette::kPaper);
    paste(sheet, upper, 0, 0);
    paste(sheet, lower, 0, upper.height());
    return sheet;
}

}  // namespace surefoot::eval
