// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surefoot/core/assert.hpp"
#include "surefoot/eval/report/percentile.hpp"
#include "surefoot/eval/report/ticks.hpp"

namespace surefoot::eval {
namespace {

constexpr double kWidth = 600.0;         ///< width of drawings that share a row of the page
constexpr double kHealthWidth = 1220.0;  ///< width of a drawing that fills a row
constexpr double kLabelWidth = 100.0;    ///< space for names left of the bars
constexpr double kValueWidth = 174.0;    ///< space for numbers right of the bars
constexpr double kRow = 30.0;
constexpr double kAxisHeight = 44.0;

std::string text_at(
    double x, double y, const char* css_class, const char* anchor, const std::string& text) {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"{}\" text-anchor=\"{}\">{}</text>",
                       x,
                       y,
                       css_class,
                       anchor,
                       escaped(text));
}

std::string rect_at(double x, double y, double width, double height, const char* css_class) {
    return fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"{}\"/>",
        x,
        y,
        std::max(0.0, width),
        height,
        css_class);
}

std::string line_at(double x1, double y1, double x2, double y2, const char* css_class) {
    return fmt::format(
        "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"{}\"/>",
        x1,
        y1,
        x2,
        y2,
        css_class);
}

std::string svg(double width, double height, const std::string& title, const std::string& body) {
    return fmt::format(
        "<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">{}</svg>\n",
        width,
        height,
        escaped(title),
        body);
}

/// Draws vertical grid lines with their numbers below.
std::string x_axis(
    double left, double right, double top, double bottom, double high, const std::string& unit) {
    std::string body;
    const Ticks ticks = nice_ticks(0.0, high, 5);
    for (const double value : ticks.values) {
        const double x = left + value / high * (right - left);
        body += line_at(x, top, x, bottom, "axis");
        body += text_at(x, bottom + 18.0, "label", "middle", ticks.label(value));
    }
    return body + text_at(0.5 * (left + right), bottom + 38.0, "label", "middle", unit);
}

/// Replaces groups of neighbours by their largest value, so that a spike is never lost.
std::vector<double> largest_of_groups(const std::vector<double>& values, std::size_t most) {
    const std::size_t group = (values.size() + most - 1) / most;
    std::vector<double> merged;
    for (std::size_t k = 0; k < values.size(); k += group) {
        const auto from = values.begin() + static_cast<std::ptrdiff_t>(k);
        const auto to =
            values.begin() + static_cast<std::ptrdiff_t>(std::min(k + group, values.size()));
        merged.push_back(*std::max_element(from, to));
    }
    return merged;
}

const char* css_class_of(Health health) {
    switch (health) {
        case Health::ok: return "ok";
        case Health::degraded: return "degraded";
        case Health::lost: return "lost";
    }
    return "lost";
}

std::string health_legend(const std::vector<HealthSample>& samples, double y) {
    std::string body;
    double x = 0.0;
    for (const Health health : {Health::ok, Health::degraded, Health::lost}) {
        const auto count = std::count_if(samples.begin(),
                                         samples.end(),
                                         [&](const HealthSample& s) { return s.health == health; });
        const double percent =
            100.0 * static_cast<double>(count) / static_cast<double>(samples.size());
        body += rect_at(x, y - 12.0, 16.0, 16.0, css_class_of(health));
        body += text_at(x + 24.0,
                        y + 1.0,
                        "label",
                        "start",
                        fmt::format("{} {:.1f} % ({} frames)", to_string(health), percent, count));
        x += 0.22 * kHealthWidth;
    }
    return body;
}

struct BinPlotFrame {
    double left = 62.0;
    double right = kWidth - 16.0;
    double top = 34.0;
    double bottom = 214.0;
    double low = 0.0;   ///< lower end of the x axis
    double high = 1.0;  ///< upper end of the x axis
    double tall = 1.0;  ///< upper end of the y axis

    [[nodiscard]] double x_of(double value) const {
        return left + (value - low) / (high - low) * (right - left);
    }
    [[nodiscard]] double y_of(double value) const {
        return bottom - std::min(value / tall, 1.0) * (bottom - top);
    }
};

std::string bin_plot_axes(const BinPlot& plot, const BinPlotFrame& frame) {
    std::string body;
    const Ticks y_ticks = nice_ticks(0.0, frame.tall, 4);
    for (const double value : y_ticks.values) {
        const double y = frame.y_of(value);
        body += line_at(frame.left, y, frame.right, y, "axis");
        body += text_at(frame.left - 8.0,
                        y + 5.0,
                        "label",
                        "end",
                        fmt::format("{} {}", y_ticks.label(value), plot.unit));
    }
    const Ticks x_ticks = nice_ticks(frame.low, frame.high, 8);
    for (const double value : x_ticks.values) {
        body += text_at(
            frame.x_of(value), frame.bottom + 20.0, "label", "middle", x_ticks.label(value));
    }
    return body + text_at(0.5 * (frame.left + frame.right),
                          frame.bottom + 40.0,
                          "label",
                          "middle",
                          plot.x_label);
}

/// Draws the line with a mark at every value. The line has a gap at an empty bin.
std::string bin_plot_line(const BinPlot& plot,
                          const BinPlot::Line& line,
                          const BinPlotFrame& frame,
                          const char* css_class) {
    std::string body;
    std::string points;
    const auto flush = [&] {
        if (!points.empty())
            body += fmt::format("<polyline points=\"{}\" class=\"{}\"/>", points, css_class);
        points.clear();
    };
    for (std::size_t k = 0; k < line.values.size(); ++k) {
        if (!std::isfinite(line.values[k])) {
            flush();
            continue;
        }
        const double x = frame.x_of(0.5 * (plot.edges[k] + plot.edges[k + 1]));
        const double y = frame.y_of(line.values[k]);
        points += fmt::format("{:.1f},{:.1f} ", x, y);
        body += fmt::format(
            "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" class=\"{} mark\">"
            "<title>{}: {:.4g} {}</title></circle>",
            x,
            y,
            css_class,
            escaped(line.label),
            line.values[k],
            escaped(plot.unit));
    }
    flush();
    return body;
}

}  // namespace

std::string escaped(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        switch (c) {
            case '&': safe += "&amp;"; break;
            case '<': safe += "&lt;"; break;
            case '>': safe += "&gt;"; break;
            case '"': safe += "&quot;"; break;
            case '\'': safe += "&#39;"; break;
            default: {
                const bool control = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
                const bool allowed = c == '\n' || c == '\t';
                safe += control && !allowed ? ' ' : c;
            }
        }
    }
    return safe;
}

std::string stage_bars_svg(const std::vector<StageTiming>& stages) {
    double high = 0.0;
    std::vector<StageTiming> shown;
    for (StageTiming stage : stages) {
        if (stage.ms.empty()) continue;
        std::sort(stage.ms.begin(), stage.ms.end());
        high = std::max(high, percentile_of_sorted(stage.ms, 0.99));
        shown.push_back(std::move(stage));
    }
    if (shown.empty()) return {};
    high = std::max(high, 1e-3);
    const double left = kLabelWidth;
    const double right = kWidth - kValueWidth;
    const double bottom = kRow * static_cast<double>(shown.size());
    std::string body = x_axis(left, right, 0.0, bottom, high, "ms");
    double y = 0.0;
    for (const StageTiming& stage : shown) {
        const double median = percentile_of_sorted(stage.ms, 0.5);
        const double tail = percentile_of_sorted(stage.ms, 0.99);
        const auto width = [&](double ms) { return ms / high * (right - left); };
        body += text_at(left - 10.0, y + 20.0, "label", "end", stage.name);
        body += rect_at(left, y + 12.0, width(tail), 6.0, "tail");
        body += rect_at(left, y + 6.0, width(median), 18.0, "median");
        body += text_at(kWidth,
                        y + 20.0,
                        "value",
                        "end",
                        fmt::format("{:.2f} ms, p99 {:.2f} ms", median, tail));
        y += kRow;
    }
    return svg(kWidth, bottom + kAxisHeight, "Time per stage, median and 99th percentile", body);
}

std::string frame_times_svg(const std::vector<double>& frame_ms, double limit_ms) {
    if (frame_ms.size() < 2) return {};
    constexpr double kTop = 10.0;
    constexpr double kBottom = 190.0;
    constexpr double kLeft = 62.0;
    const std::vector<double> values = largest_of_groups(frame_ms, 600);
    const double largest = *std::max_element(values.begin(), values.end());
    const double high = std::max({1.05 * largest, 1.05 * limit_ms, 1e-3});
    const auto y_of = [&](double ms) { return kBottom - ms / high * (kBottom - kTop); };
    std::string body;
    const Ticks ms_ticks = nice_ticks(0.0, high, 4);
    for (const double ms : ms_ticks.values) {
        body += line_at(kLeft, y_of(ms), kWidth, y_of(ms), "axis");
        body += text_at(kLeft - 8.0, y_of(ms) + 5.0, "label", "end", ms_ticks.label(ms) + " ms");
    }
    const auto last = static_cast<double>(frame_ms.size() - 1);
    const Ticks frame_ticks = nice_ticks(0.0, std::max(1.0, last), 6);
    for (const double frame : frame_ticks.values) {
        const double x = kLeft + frame / last * (kWidth - 16.0 - kLeft);
        body += text_at(x, kBottom + 20.0, "label", "middle", frame_ticks.label(frame));
    }
    body += text_at(0.5 * (kLeft + kWidth), kBottom + 40.0, "label", "middle", "frame");
    std::string points;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double share = static_cast<double>(k) / static_cast<double>(values.size() - 1);
        points +=
            fmt::format("{:.1f},{:.1f} ", kLeft + share * (kWidth - 16.0 - kLeft), y_of(values[k]));
    }
    body += fmt::format("<polyline points=\"{}\" class=\"line\"/>", points);
    if (limit_ms > 0.0) body += line_at(kLeft, y_of(limit_ms), kWidth, y_of(limit_ms), "limit");
    return svg(kWidth, kBottom + 46.0, "Time per frame", body);
}

std::string health_svg(const std::vector<HealthSample>& samples) {
    if (samples.empty()) return {};
    const double start_s = samples.front().time_s;
    const double step_s = samples.size() < 2 ? 1.0
                                             : (samples.back().time_s - start_s) /
                                                   static_cast<double>(samples.size() - 1);
    const double length_s = std::max(samples.back().time_s - start_s + step_s, 1e-9);
    const auto x_of = [&](double time_s) {
        return std::clamp((time_s - start_s) / length_s, 0.0, 1.0) * kHealthWidth;
    };
    std::string body;
    for (std::size_t k = 0; k < samples.size();) {
        std::size_t end = k + 1;  // first sample of the next state
        while (end < samples.size() && samples[end].health == samples[k].health &&
               samples[end].reason == samples[k].reason) {
            ++end;
        }
        const double from = x_of(samples[k].time_s);
        const double to = end < samples.size() ? x_of(samples[end].time_s) : kHealthWidth;
        body += fmt::format(
            "<g><title>{:.2f} s: {}, {}</title>{}</g>",
            samples[k].time_s,
            to_string(samples[k].health),
            to_string(samples[k].reason),
            rect_at(from, 0.0, std::max(1.0, to - from), 34.0, css_class_of(samples[k].health)));
        k = end;
    }
    const Ticks ticks = nice_ticks(0.0, length_s, 10);
    for (const double time_s : ticks.values) {
        const double x = std::clamp(time_s / length_s * kHealthWidth, 12.0, kHealthWidth - 12.0);
        body += text_at(x, 54.0, "label", "middle", ticks.label(time_s));
    }
    body += text_at(0.5 * kHealthWidth, 74.0, "label", "middle", "time [s]");
    body += health_legend(samples, 104.0);
    return svg(kHealthWidth, 116.0, "Health of the motion estimate over time", body);
}

std::string bin_plot_svg(const BinPlot& plot) {
    double largest = 0.0;
    std::size_t first = plot.edges.size();  // first bin with a value; `end` is one past the last
    std::size_t end = 0;
    for (const BinPlot::Line& line : plot.lines) {
        SUREFOOT_ASSERT(line.values.size() + 1 == plot.edges.size());
        for (std::size_t k = 0; k < line.values.size(); ++k) {
            if (!std::isfinite(line.values[k])) continue;
            largest = std::max(largest, line.values[k]);
            first = std::min(first, k);
            end = std::max(end, k + 1);
        }
    }
    if (first >= end) return {};
    BinPlotFrame frame;
    frame.low = plot.edges[first];
    frame.high = plot.edges[end];
    frame.tall = plot.high > 0.0 ? plot.high : std::max(1.1 * largest, 1e-9);
    std::string body = bin_plot_axes(plot, frame);
    double key_x = frame.left;
    for (std::size_t i = 0; i < plot.lines.size(); ++i) {
        const char* css_class = i == 0 ? "line" : "second";
        body += line_at(key_x, 12.0, key_x + 22.0, 12.0, css_class);
        body += text_at(key_x + 30.0, 17.0, "label", "start", plot.lines[i].label);
        key_x += 190.0;
        body += bin_plot_line(plot, plot.lines[i], frame, css_class);
    }
    return svg(kWidth, frame.bottom + 46.0, "Figures over " + plot.x_label, body);
}

}  // namespace surefoot::eval
