// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "surefoot/core/time.hpp"
#include "surefoot/eval/report/html_report.hpp"

namespace surefoot::eval {
namespace {

constexpr int kReasonCount = static_cast<int>(HealthReason::imu_gap) + 1;

/// Formats digits in groups of three with a narrow space between them.
std::string grouped(std::int64_t number) {
    std::string digits = fmt::format("{}", number);
    for (std::size_t k = digits.size(); k > 3;) {
        k -= 3;
        digits.insert(k, "\u202f");
    }
    return digits;
}

/// Formats a reason as words.
std::string words(HealthReason reason) {
    std::string name = to_string(reason);
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

void add_timing(ReportContent& content, std::span<const FrameReport> frames) {
    for (int stage = 0; stage < kStageCount; ++stage) {
        StageTiming timing{to_string(static_cast<Stage>(stage)), {}};
        for (const FrameReport& frame : frames) {
            const double ms = frame.stage_ms[static_cast<std::size_t>(stage)];
            if (ms > 0.0) timing.ms.push_back(ms);  // 0 = the stage did not run in this frame
        }
        content.stages.push_back(std::move(timing));
    }
    for (const FrameReport& frame : frames) {
        content.frame_ms.push_back(
            std::accumulate(frame.stage_ms.begin(), frame.stage_ms.end(), 0.0));
    }
    if (frames.size() < 2) return;
    const double length_s = seconds_from_ns(frames.back().time_ns - frames.front().time_ns);
    content.frame_limit_ms = 1e3 * length_s / static_cast<double>(frames.size() - 1);
}

void add_health(ReportContent& content, std::span<const FrameReport> frames) {
    std::array<int, kReasonCount> counts{};
    for (const FrameReport& frame : frames) {
        const double time_s = seconds_from_ns(frame.time_ns - frames.front().time_ns);
        content.health.push_back({time_s, frame.motion.health, frame.motion.reason});
        ++counts[static_cast<std::size_t>(frame.motion.reason)];
    }
    ReportTable table{"Health reasons of the motion estimate", {"reason", "frames"}, {}};
    for (int reason = 1; reason < kReasonCount; ++reason) {
        const int count = counts[static_cast<std::size_t>(reason)];
        if (count == 0) continue;
        table.rows.push_back({words(static_cast<HealthReason>(reason)), fmt::format("{}", count)});
    }
    content.tables.push_back(std::move(table));
    const int blind = counts[static_cast<std::size_t>(HealthReason::imu_gap)];
    if (blind > 0)
        content.reasons.push_back(fmt::format(
            "In at least {} of {} frames, IMU samples were missing or unusable. The motion in "
            "these frames "
            "comes from the images alone; if the images fail too, tracking is lost at once.",
            blind,
            frames.size()));
}

ReportBars::Bar bar_of(const char* label, std::int64_t count, std::int64_t all) {
    const double percent =
        all > 0 ? 100.0 * static_cast<double>(count) / static_cast<double>(all) : 0.0;
    return {
        label, static_cast<double>(count), fmt::format("{} ({:.1f} %)", grouped(count), percent)};
}

void add_counts(ReportContent& content, std::span<const FrameReport> frames) {
    FusionCounts sum;
    for (const FrameReport& frame : frames) sum += frame.fusion;
    const std::int64_t n = sum.points;
    if (n > 0) {
        content.bars.push_back(
            {"Depth points by outcome",
             {bar_of("offered", n, n),
              bar_of("too near or too far", sum.gated_range, n),
              bar_of("too high or too low", sum.gated_height, n),
              bar_of("depth jump, grazing ray or outlier", sum.gated_confidence, n),
              bar_of("too few neighbours", sum.gated_density, n),
              bar_of("cell partly outside the image", sum.gated_border, n),
              bar_of("outside the map", sum.outside, n)}});
    }
    const std::int64_t m = sum.cells_measured;
    if (m > 0) {
        content.bars.push_back({"Measured cells by outcome",
                                {bar_of("measured", m, m),
                                 bar_of("new", sum.cells_new, m),
                                 bar_of("agreed, fused", sum.cells_fused, m),
                                 bar_of("disagreed, sigma increased", sum.cells_inflated, m)}});
    }
}

}  // namespace

void add_frames(ReportContent& content, std::span<const FrameReport> frames) {
    if (frames.empty()) return;
    add_timing(content, frames);
    add_health(content, frames);
    add_counts(content, frames);
}

}  // namespace surefoot::eval
