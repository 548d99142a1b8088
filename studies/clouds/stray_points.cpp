// SPDX-License-Identifier: Apache-2.0
#include "studies/clouds/stray_points.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::app {
namespace {

constexpr double kOff_m = 0.015;
constexpr double kOffShare = 0.5;
constexpr double kGrazing_deg = 3.0;
/// Largest beam width that the filter considers, in angular steps. A beam is wider only at close
/// range.
constexpr std::ptrdiff_t kMostApart = 4;
constexpr std::ptrdiff_t kReach = 2 * kMostApart;

/// Returns true if two beams on one side, `spacing_m` apart, predict the range of a point.
bool foretell(double range_m, double beside_m, double beyond_m, double spacing_m) {
    static const double steepest = 1.0 / std::tan(kGrazing_deg * kRadPerDeg);
    const double change_m = std::abs(beside_m - beyond_m);  // NaN = the beam has no range
    if (!(change_m <= steepest * spacing_m)) return false;
    const double inverse = 2.0 / beside_m - 1.0 / beyond_m;
    return inverse > 0.0 && std::abs(1.0 / inverse - range_m) <= kOff_m + kOffShare * change_m;
}

}  // namespace

StrayFilter::StrayFilter(const sim::LaserScannerConfig& config)
    : beam_exit_m_(config.beam_exit_m),
      beam_divergence_rad_(config.beam_divergence_rad),
      step_rad_(config.step_deg * kRadPerDeg) {}

double StrayFilter::range_m(std::ptrdiff_t at, std::ptrdiff_t row) const {
    if (at < 0 || at >= std::ssize(columns_)) return kNan;
    const std::vector<double>& ranges_m = columns_[static_cast<std::size_t>(at)].range_m;
    return row < 0 || row >= std::ssize(ranges_m) ? kNan : ranges_m[static_cast<std::size_t>(row)];
}

std::ptrdiff_t StrayFilter::beams_apart(double range_m, double step_rad) const {
    const double width_m = beam_exit_m_ + beam_divergence_rad_ * range_m;
    const double apart = std::ceil(width_m / (step_rad * range_m));
    return clamped_integer<std::ptrdiff_t>(apart, std::ptrdiff_t{1}, kMostApart);
}

bool StrayFilter::stays(std::size_t at, std::size_t row) const {
    const double here_m = columns_[at].range_m[row];
    const Eigen::Vector3d& p_m = columns_[at].points_m[row];
    const auto i = static_cast<std::ptrdiff_t>(at);
    const auto j = static_cast<std::ptrdiff_t>(row);
    const auto on_a_side = [&](double step_rad, std::ptrdiff_t di, std::ptrdiff_t dj) {
        const std::ptrdiff_t k = beams_apart(here_m, step_rad);
        const double spacing_m = static_cast<double>(k) * step_rad * here_m;
        const auto foretold = [&](std::ptrdiff_t n) {
            return foretell(here_m,
                            range_m(i + n * di, j + n * dj),
                            range_m(i + 2 * n * di, j + 2 * n * dj),
                            spacing_m);
        };
        return foretold(k) || foretold(-k);
    };
    return on_a_side(step_rad_, 0, 1) && on_a_side(step_rad_ * p_m.head<2>().norm() / here_m, 1, 0);
}

bool StrayFilter::hand_over(std::size_t at, const Take& take) {
    const Column& column = columns_[at];
    kept_m_ = column.points_m;
    for (std::size_t row = 0; row < kept_m_.size(); ++row) {
        if (!std::isnan(column.range_m[row]) && !stays(at, row)) kept_m_[row].setConstant(kNan);
    }
    return take(kept_m_);
}

bool StrayFilter::add(const sim::ScanColumn& column, const Take& take) {
    Column added;
    // The filter no longer needs the oldest column, so its memory is reused.
    if (std::ssize(columns_) > 2 * kReach) {
        added = std::move(columns_.front());
        columns_.pop_front();
        --next_;
    }
    added.points_m.clear();
    added.range_m.clear();
    for (const sim::ScanPoint& point : column.points) {
        added.points_m.push_back(point.point_scanner_m);
        added.range_m.push_back(point.point_scanner_m.norm());
    }
    columns_.push_back(std::move(added));
    if (std::ssize(columns_) <= static_cast<std::ptrdiff_t>(next_) + kReach) return true;
    return hand_over(next_++, take);
}

bool StrayFilter::finish(const Take& take) {
    while (next_ < columns_.size()) {
        if (!hand_over(next_++, take)) return false;
    }
    return true;
}

}  // namespace surefoot::app
