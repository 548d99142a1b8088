// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "surefoot/gate/ground.hpp"

namespace surefoot::gate {

/// The lines of nosings in a snapshot, as one region sees them. A map can show a riser up to a cell
/// (kBesideTenthMm) beside its position. Where a line gives the position better, cells count for a
/// region with the height of that side of the line on which the whole region lies.
class NosingLines {
  public:
    /// `widened`: the region is wider by this length than the area that must be free.
    NosingLines(const Ground& ground,
                const GateLimits& limits,
                const grid::FixedConvex& region,
                std::int64_t widened_tenth_mm) noexcept;

    /// Changes the height and the sigma of a known cell if all of this holds for a line:
    /// - The region, without `widened`, lies on one side of the line, at a distance of at least
    ///   `sigma_factor` sigma of the line and of the drift of the cell.
    /// - The cell lies between the ends of the line. It reaches to the other side of the line, or
    ///   so near to it that the line may pass through the cell (`sigma_factor` sigma).
    /// - Its height lies between the heights of the lower and the upper ground, with a tolerance of
    ///   `patch_residual`. So an object higher than the upper ground keeps its height. For a region
    ///   on the upper ground, a cell 10 mm to half a riser below it keeps its height too, because
    ///   it can be a worn nosing.
    /// The cell then has the height of the ground on the region's side. Returns true after a
    /// change.
    bool sharpen(std::int64_t ix, std::int64_t iy, GroundCell& cell) const noexcept;

  private:
    enum class Side : std::int8_t { lower = -1, upper = 1 };
    struct Line {
        grid::FixedPoint from;  ///< relative to the origin of the grid
        grid::FixedPoint to;
        std::int64_t length_up = 0;    ///< length, rounded up
        std::int64_t sigma_reach = 0;  ///< sigma_factor * sigma
        /// Smallest distance of the region from the line times `length_up`; plus `widened`.
        std::int64_t away = 0;
        Side side = Side::lower;
        std::int32_t lower_tenth_mm = 0;
        std::int32_t upper_tenth_mm = 0;
        std::int32_t height_sigma_tenth_mm = 0;
    };
    [[nodiscard]] bool concerns(const Line& line,
                                std::int64_t ix,
                                std::int64_t iy,
                                const GroundCell& cell) const noexcept;

    const Ground& ground_;
    double sigma_factor_;
    std::int64_t tolerance_tenth_mm_;
    std::array<Line, grid::MapSnapshot::kMaxEdges> lines_{};
    int count_ = 0;
};

/// Returns factor * x, rounded up, and never less than x. Precondition: x has 32 bits, and factor
/// is at most 10.
[[nodiscard]] std::int64_t times_up(double factor, std::int64_t x) noexcept;

/// True if the ground falls by more than `drop` at an edge, its numbers are in the range of the
/// exact geometry, and its sigmas are valid.
[[nodiscard]] bool is_nosing(const grid::SnapshotEdge& edge, const GateLimits& limits) noexcept;

}  // namespace surefoot::gate
