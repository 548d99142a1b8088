// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "surefoot/sim/sensors/laser_scanner.hpp"

namespace surefoot::app {

/// Removes stray points of a laser scan: ranges that do not belong to any surface. A beam that
/// meets an edge and the background behind it measures a range between the two. Scanner software
/// removes such points from the organised scan ("stray point filter" of Faro Scene, shadow filters
/// of others), because they cannot be recognised in an unorganised cloud.
///
/// On a plane the inverse range changes linearly from beam to beam. Two beams on one side of a
/// point predict its range by extrapolation. The point stays if one prediction along its column and
/// one across the columns fulfil two conditions. (1) The prediction is right within 15 mm plus half
/// of the range change between the two beams (rough ground at a grazing angle). (2) The two beams
/// meet their surface at 3 deg or more. The compared beams are one beam width apart, because closer
/// beams meet the same edge. Surfaces narrower than three beam widths are lost.
class StrayFilter {
  public:
    /// Receives the points of a column in the frame of the scanner [m], lowest first. NaN = no
    /// return, or a removed stray point. Returns false to stop.
    using Take = std::function<bool(std::span<const Eigen::Vector3d> points_scanner_m)>;

    explicit StrayFilter(const sim::LaserScannerConfig& config);
    /// Adds a column. Columns come in order of azimuth. Passes on each column as soon as its
    /// neighbours are complete. Returns false if `take` stopped.
    bool add(const sim::ScanColumn& column, const Take& take);
    /// Passes on the columns that `add` still holds.
    bool finish(const Take& take);

  private:
    struct Column {
        std::vector<Eigen::Vector3d> points_m;
        std::vector<double> range_m;  ///< NaN = no point
    };
    bool hand_over(std::size_t at, const Take& take);
    [[nodiscard]] bool stays(std::size_t at, std::size_t row) const;
    [[nodiscard]] double range_m(std::ptrdiff_t at, std::ptrdiff_t row) const;
    [[nodiscard]] std::ptrdiff_t beams_apart(double range_m, double step_rad) const;

    double beam_exit_m_ = 0.0;
    double beam_divergence_rad_ = 0.0;
    double step_rad_ = 0.0;
    std::deque<Column> columns_;  ///< the next column and its neighbours on both sides
    std::size_t next_ = 0;        ///< index into `columns_` of the next column to pass on
    std::vector<Eigen::Vector3d> kept_m_;
};

}  // namespace surefoot::app
