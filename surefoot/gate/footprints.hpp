// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "surefoot/core/machine.hpp"
#include "surefoot/gate/verdict.hpp"
#include "surefoot/grid/fixed_polygon.hpp"

namespace surefoot::gate {

/// The map can show an object up to one cell of 25 mm beside its true position. Example: a table
/// rim covers half of a cell, and the cell shows the floor behind the rim. On maps with measured
/// noise, all missed hazards except the corner of a hole had a cell with the hazard within this
/// distance (docs/lab/gate_scenes.md).
inline constexpr std::int64_t kBesideTenthMm = 250;

/// Matchers show ground beyond the edge of a deep drop. Width of the strip around a drop band in
/// which the map shows this drop at the latest (docs/decisions/068-drops-beyond-the-band.md).
inline constexpr std::int64_t kSmearTenthMm = 1'000;

/// Width of the ground around the soles that shows the slope under the feet. An edge just outside
/// the soles is then in fewer than half of the pairs of cells whose slopes count (stance.hpp). A
/// constant, so that no limit of a machine file changes the slope.
inline constexpr std::int32_t kAroundTenthMm = 500;

/// A pose in the plane: position in units of 0.1 mm, cosine and sine of the yaw times 2^20.
struct FixedPose {
    static constexpr int kFractionBits = 20;
    static constexpr std::int64_t kOne = std::int64_t{1} << kFractionBits;

    grid::FixedPoint position;
    std::int64_t cos_yaw = kOne;
    std::int64_t sin_yaw = 0;
};

/// Makes a pose. Precondition: |cos_yaw| and |sin_yaw| <= 1.001.
[[nodiscard]] FixedPose fixed_pose(std::int64_t x_tenth_mm,
                                   std::int64_t y_tenth_mm,
                                   double cos_yaw,
                                   double sin_yaw) noexcept;
/// Returns a point of the body in odom, rounded to 0.1 mm.
[[nodiscard]] grid::FixedPoint to_odom(const FixedPose& pose,
                                       std::int64_t forward_tenth_mm,
                                       std::int64_t left_tenth_mm) noexcept;
/// Returns the corners of a box in odom, counter-clockwise for base_link, widened by a margin.
using Corners = std::array<grid::FixedPoint, 4>;
[[nodiscard]] Corners corners_of(const GroundBox& box,
                                 const FixedPose& pose,
                                 std::int64_t margin_tenth_mm) noexcept;
/// Returns the pose of base_link after the movement.
[[nodiscard]] FixedPose moved(const FixedPose& pose, const Movement& movement) noexcept;

/// The regions that one foot needs for a movement. kBesideTenthMm widens corridor and band, too.
struct FootSweep {
    Foot foot = Foot::none;
    grid::FixedConvex stance;  ///< sole area at the start
    /// Rear and front half of the sole area at the start, widened by kAroundTenthMm.
    std::array<grid::FixedConvex, 2> halves;
    grid::FixedConvex landing;  ///< sole area at the target
    grid::FixedPoint landing_center;
    grid::FixedConvex corridor;  ///< hull of stance and landing, widened by `foot_margin`
    grid::FixedConvex band;      ///< landing box, widened by `drop_band`
    grid::FixedConvex edges;     ///< landing box, widened by `drop_band` and kSmearTenthMm
};

/// The areas of one part of the body, widened by sway and kBesideTenthMm.
struct PartSweep {
    grid::FixedConvex way;   ///< hull of its box at start and target
    grid::FixedConvex here;  ///< its box at the start
    /// Bit i: the part leaves `here` across its edge from vertex i to vertex i + 1.
    std::uint32_t leaves = 0;

    /// For a cell that overlaps `here`: true if the movement needs no more of it than standing
    /// does.
    [[nodiscard]] bool stays_in(std::int64_t ix,
                                std::int64_t iy,
                                const grid::FixedGrid& grid) const noexcept;
};

/// All regions that a movement needs, in odom.
struct Sweep {
    std::array<FootSweep, 2> feet;  ///< left, right
    std::array<PartSweep, Body::kMaxParts> body;
    FixedPose start;
    FixedPose target;
};

/// A rectangle in odom, parallel to the axes of odom [0.1 mm].
struct Extent {
    grid::FixedPoint low;
    grid::FixedPoint high;

    void include(grid::FixedPoint p) noexcept;
};
/// Returns the smallest rectangle that contains the whole sweep.
[[nodiscard]] Extent extent_of(const Sweep& sweep) noexcept;

/// Returns the margin for sweep_of() if cells drifted after their measurement: `sigma_factor` times
/// the part of the drift (1 sigma, horizontal) above 10 mm. The usual margins cover the first 10
/// mm.
[[nodiscard]] std::int64_t drift_margin(const GateLimits& limits,
                                        std::int64_t drift_tenth_mm) noexcept;
/// Returns all regions. `margin_tenth_mm` widens all except `stance`, `halves` and
/// `landing`.
[[nodiscard]] Sweep sweep_of(const Machine& machine,
                             const FixedPose& start,
                             const Movement& movement,
                             std::int64_t margin_tenth_mm = 0) noexcept;

}  // namespace surefoot::gate
