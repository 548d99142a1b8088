// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "surefoot/gate/footprints.hpp"
#include "surefoot/gate/ground.hpp"

namespace surefoot::gate {

/// A plane in odom. Positions are cells of the snapshot, so that all heights are exact integers.
struct StancePlane {
    static constexpr int kFractionBits = 16;

    std::int64_t height_tenth_mm = 0;  ///< odom z at `middle`
    grid::FixedPoint middle;           ///< twice the position [cells]
    /// Rise over half a cell [0.1 mm / 2^16].
    std::int64_t slope_x = 0;
    std::int64_t slope_y = 0;

    /// Returns the odom z of the plane at the centre of a cell.
    [[nodiscard]] std::int64_t at(std::int64_t ix, std::int64_t iy) const noexcept {
        const std::int64_t rise =
            slope_x * (2 * ix + 1 - middle.x) + slope_y * (2 * iy + 1 - middle.y);
        constexpr std::int64_t kOne = std::int64_t{1} << kFractionBits;
        return height_tenth_mm + grid::floor_div(rise + kOne / 2, kOne);
    }
    /// Tangents of the slopes along the axes of odom, for cells of this side.
    struct Tangents {
        double x = 0.0;
        double y = 0.0;
    };
    [[nodiscard]] Tangents tangents(std::int64_t side_tenth_mm) const noexcept;
};

/// The ground under the present feet.
struct Stance {
    bool known = false;  ///< a cell under a foot is known, or the query gives the height
    StancePlane plane;   ///< with the slope that the ground surely has
    /// The same height with the slope of a part of the ground under and around the feet: the rear
    /// of both feet, the front of both, the left foot and the right foot. They differ where the
    /// ground bends.
    std::array<StancePlane, 4> parts;
    /// Mean height of the known cells under each foot above `plane`; empty if no cell is known.
    std::array<std::optional<std::int64_t>, 2> feet_tenth_mm;

    /// Level ground at a height (odom).
    [[nodiscard]] static Stance level_at(std::int64_t height_tenth_mm) noexcept {
        Stance stance;
        stance.known = true;
        stance.plane.height_tenth_mm = height_tenth_mm;
        stance.parts.fill(stance.plane);
        return stance;
    }
};

/// Finds the mean height of the ground under both feet (or takes the height of the query if its
/// source is `given`) and its slope. On treads (`level`) it is the median height, and the slope is
/// zero.
///
/// The slopes come from pairs of cells in one area of one foot, half of this area apart, that are
/// both measured or both attested. So a difference of height between the feet does not count. Along
/// each axis of odom, `plane` has the slope that three quarters of the pairs under the soles reach
/// (zero if none): neither noise nor a sill under the toes tilts it. Each of `parts` has a median
/// slope: an edge beside the soles is in fewer than half of the pairs.
[[nodiscard]] Stance find_stance(const Ground& ground,
                                 const Query& query,
                                 const Sweep& sweep,
                                 bool level) noexcept;

}  // namespace surefoot::gate
