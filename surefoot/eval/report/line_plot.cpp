// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/line_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/assert.hpp"
#include "surefoot/eval/report/svg_plot.hpp"
#include "surefoot/eval/report/ticks.hpp"

namespace surefoot::eval {
namespace {

constexpr double kWidth = 600.0;
constexpr double kHeight = 340.0;
constexpr double kLeft = 64.0;
constexpr double kRight = kWidth - 20.0;
constexpr double kTop = 64.0;
constexpr double kBottom = kHeight - 56.0;
/// Colours of Okabe and Ito 2008: distinguishable with common colour vision deficiencies, on white
/// and on black.
constexpr const char* kColour[LinePlot::kColours] = {
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00"};

bool finite(const LinePlot::Point& p) {
    return std::isfinite(p.x) && std::isfinite(p.y);
}

struct Axes {
    double x_high = 0.0;
    double y_high = 0.0;
    [[nodiscard]] double u(double x) const { return kLeft + x / x_high * (kRight - kLeft); }
    [[nodiscard]] double v(double y) const { return kBottom - y / y_high * (kBottom - kTop); }
};

std::string text(double u, double v, const char* anchor, const std::string& words) {
    return fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" fill=\"currentColor\">{}</text>",
        u,
        v,
        anchor,
        escaped(words));
}

std::string grid(const LinePlot& plot, const Axes& axes) {
    std::string body;
    const auto rule = [&](double u1, double v1, double u2, double v2) {
        body += fmt::format(
            "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" "
            "stroke=\"currentColor\" stroke-opacity=\"0.2\"/>",
            u1,
            v1,
            u2,
            v2);
    };
    const Ticks xs = nice_ticks(0.0, axes.x_high, 8);
    for (const double x : xs.values) {
        rule(axes.u(x), kTop, axes.u(x), kBottom);
        body += text(axes.u(x), kBottom + 18.0, "middle", xs.label(x));
    }
    const Ticks ys = nice_ticks(0.0, axes.y_high, 5);
    for (const double y : ys.values) {
        rule(kLeft, axes.v(y), kRight, axes.v(y));
        body += text(kLeft - 8.0, axes.v(y) + 4.0, "end", ys.label(y));
    }
    body += text(0.5 * (kLeft + kRight), kBottom + 40.0, "middle", plot.x_label);
    return body + text(8.0, 18.0, "start", plot.title + " [" + plot.y_label + "]");
}

std::string drawn(const LinePlot::Line& line, const char* colour, const Axes& axes) {
    std::string body;
    std::string points;
    const auto flush = [&] {
        if (!points.empty()) {
            body += fmt::format(
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>",
                points,
                colour,
                line.dashed ? " stroke-dasharray=\"6 5\"" : "");
        }
        points.clear();
    };
    for (const LinePlot::Point& p : line.points) {
        if (!finite(p)) {
            flush();
            continue;
        }
        points += fmt::format("{:.1f},{:.1f} ", axes.u(p.x), axes.v(p.y));
        body += fmt::format(
            "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"><title>{}: {:.4g} at "
            "{:.4g}</title></circle>",
            axes.u(p.x),
            axes.v(p.y),
            colour,
            escaped(line.label),
            p.y,
            p.x);
    }
    flush();
    return body;
}

std::string key(const LinePlot::Line& line, const char* colour, std::size_t place) {
    const std::size_t row = place / 3;
    const double u = kLeft + static_cast<double>(place % 3) * 180.0;
    const double v = 34.0 + static_cast<double>(row) * 18.0;
    return fmt::format(
               "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
               "stroke-width=\"3\"{}/>",
               u,
               v,
               u + 22.0,
               v,
               colour,
               line.dashed ? " stroke-dasharray=\"6 5\"" : "") +
           text(u + 28.0, v + 4.0, "start", line.label);
}

}  // namespace

std::string line_plot_svg(const LinePlot& plot) {
    SUREFOOT_ASSERT(plot.lines.size() <= LinePlot::kColours);
    Axes axes;
    for (const LinePlot::Line& line : plot.lines) {
        for (const LinePlot::Point& p : line.points) {
            if (!finite(p)) continue;
            SUREFOOT_ASSERT(p.x >= 0.0 && p.y >= 0.0);
            axes.x_high = std::max(axes.x_high, 1.05 * p.x);
            axes.y_high = std::max(axes.y_high, 1.05 * p.y);
        }
    }
    if (!(axes.x_high > 0.0)) return {};
    if (!(axes.y_high > 0.0)) axes.y_high = 1.0;
    std::string body = grid(plot, axes);
    for (std::size_t k = 0; k < plot.lines.size(); ++k) {
        body += drawn(plot.lines[k], kColour[k], axes);
        body += key(plot.lines[k], kColour[k], k);
    }
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" "
        "aria-label=\"{}\" font-family=\"sans-serif\" font-size=\"13\">{}</svg>\n",
        kWidth,
        kHeight,
        escaped(plot.title),
        body);
}

}  // namespace surefoot::eval
