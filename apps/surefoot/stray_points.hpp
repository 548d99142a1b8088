// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "surefoot/sim/sensors/laser_scanner.hpp"

namespace surefoot::app {

/// Leaves out what a scanner measures where no surface is: a beam that meets an edge and what lies
/// behind it measures a range between both. Software of scanners does the same to the organised
/// scan ("stray point filter" of Faro Scene, shadow filters of others), as nothing tells those
/// points once the scan is a cloud.
///
/// On a plane the inverse range changes evenly from beam to beam. A point stays if along its column
/// and across the columns the two beams on one side of it foretell its range, within 15 mm and half
/// of what the range changes between those two (rough ground seen at a glance), and lie on a
/// surface that the beams meet at 3 deg or more. The beams compared are as far apart as a beam is
/// wide, as narrower ones meet the same edge. What is less than three such beams wide is lost.
class StrayFilter {
  public:
    /// Points of a column in the scanner's frame, lowest first; NaN where nothing came back or a
    /// stray was left out. Returns false to end.
    using Take = std::function<bool(std::span<const Eigen::Vector3d> points_scanner_m)>;

    explicit StrayFilter(const sim::LaserScannerConfig& config);
    /// Columns in order of azimuth; hands over those whose neighbours are known.
    bool add(const sim::ScanColumn& column, const Take& take);
    /// The last columns.
    bool finish(const Take& take);

  private:
    struct Column {
        std::vector<Eigen::Vector3d> points_m;
        std::vector<double> range_m;  ///< NaN without a point
    };
    bool hand_over(std::size_t at, const Take& take);
    [[nodiscard]] bool stays(std::size_t at, std::size_t row) const;
    [[nodiscard]] double range_m(std::ptrdiff_t at, std::ptrdiff_t row) const;
    [[nodiscard]] std::ptrdiff_t beams_apart(double range_m, double step_rad) const;

    double beam_exit_m_ = 0.0;
    double beam_divergence_rad_ = 0.0;
    double step_rad_ = 0.0;
    std::deque<Column> columns_;  ///< before, judged next, after
    std::size_t next_ = 0;        ///< of `columns_`
    std::vector<Eigen::Vector3d> kept_m_;
};

}  // namespace surefoot::app
