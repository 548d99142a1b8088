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
/// Returns the pose of base_link after the movement.
[[nodiscard]] FixedPose moved(const FixedPose& pose, const Movement& movement) noexcept;

/// A region that a movement needs.
struct Region {
    /// Here mapped objects count: wider than `way` by kBesideTenthMm.
    grid::FixedConvex around;
    /// Here the ground must be known. Unlike a mapped object, unknown ground is not displaced.
    grid::FixedConvex way;
};

/// The regions that one foot needs for a movement.
struct FootSweep {
    Foot foot = Foot::none;
    grid::FixedConvex stance;   ///< sole area at the start
    grid::FixedConvex landing;  ///< sole area at the target
    grid::FixedPoint landing_center;
    Region corridor;  ///< hull of stance and landing, widened by `foot_margin`
    Region band;      ///< landing box, widened by `drop_band`
};

/// All regions that a movement needs, in odom.
struct Sweep {
    std::array<FootSweep, 2> feet;  ///< left, right
    /// The areas of one part of the body.
    struct Part {
        Region region;  ///< hull of its box at start and target, widened by `sway`
        /// Its box at the start, wider by sway. The part itself fills the cells that overlap it,
        /// but for slivers narrower than a cell. So nothing else is there.
        grid::FixedConvex filled;
    };
    std::array<Part, Body::kMaxParts> body;
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
/// Returns all regions. `margin_tenth_mm` widens all except the stance and landing areas.
[[nodiscard]] Sweep sweep_of(const Machine& machine,
                             const FixedPose& start,
                             const Movement& movement,
                             std::int64_t margin_tenth_mm = 0) noexcept;

}  // namespace surefoot::gate
