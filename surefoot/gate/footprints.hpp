// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "surefoot/core/machine.hpp"
#include "surefoot/gate/verdict.hpp"
#include "surefoot/grid/fixed_polygon.hpp"

namespace surefoot::gate {

/// The map shows things up to a cell of 25 mm beside their place: the rim of a table that was seen
/// past is bare floor in the cells that it half covers. Of hazards that were missed on maps with
/// measured noise, every one but a hole's corner had a cell that knew of it so far away
/// (docs/lab/gate_scenes.md).
inline constexpr std::int64_t kBesideTenthMm = 250;

/// A pose in the plane: position in units of 0.1 mm, cosine and sine of the yaw times 2^20.
struct FixedPose {
    static constexpr int kFractionBits = 20;
    static constexpr std::int64_t kOne = std::int64_t{1} << kFractionBits;

    grid::FixedPoint position;
    std::int64_t cos_yaw = kOne;
    std::int64_t sin_yaw = 0;
};

/// |cos|, |sin| <= 1.001 wanted.
[[nodiscard]] FixedPose fixed_pose(std::int64_t x_tenth_mm,
                                   std::int64_t y_tenth_mm,
                                   double cos_yaw,
                                   double sin_yaw) noexcept;
/// A point of the body in odom, rounded to 0.1 mm.
[[nodiscard]] grid::FixedPoint to_odom(const FixedPose& pose,
                                       std::int64_t forward_tenth_mm,
                                       std::int64_t left_tenth_mm) noexcept;
/// Where base_link stands after the movement.
[[nodiscard]] FixedPose moved(const FixedPose& pose, const Movement& movement) noexcept;

/// What one foot needs for a movement.
struct FootSweep {
    Foot foot = Foot::none;
    grid::FixedConvex stance;   ///< where it stands
    grid::FixedConvex landing;  ///< where it comes down
    grid::FixedPoint landing_center;
    grid::FixedConvex corridor;  ///< hull of both, widened by the margin
    grid::FixedConvex band;      ///< the landing box widened by the drop band
};

/// All the ground that a movement needs, in odom.
struct Sweep {
    std::array<FootSweep, 2> feet;  ///< left, right
    /// Of each part of the body the hull of its box at start and target, widened by the sway.
    std::array<grid::FixedConvex, Body::kMaxParts> body;
    FixedPose target;
};

/// A rectangle of odom, parallel to its axes.
struct Extent {
    grid::FixedPoint low;
    grid::FixedPoint high;

    void include(grid::FixedPoint p) noexcept;
};
/// That holds all of a sweep.
[[nodiscard]] Extent extent_of(const Sweep& sweep) noexcept;

/// How much farther every region reaches, on all sides, when the cells have drifted by this much
/// (1 sigma, horizontal) since they were seen: `sigma_factor` times what the margins of the regions
/// do not take up.
[[nodiscard]] std::int64_t drift_margin(const GateLimits& limits,
                                        std::int64_t drift_tenth_mm) noexcept;
/// `margin_tenth_mm`: added to every region, but to where the feet stand and land.
[[nodiscard]] Sweep sweep_of(const Machine& machine,
                             const FixedPose& start,
                             const Movement& movement,
                             std::int64_t margin_tenth_mm = 0) noexcept;

}  // namespace surefoot::gate
