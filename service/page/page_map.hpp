// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "surefoot/core/machine.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::page {

/// What the page says about the ground of a cell. Bits 0-1 of a cell's state.
enum class GroundState : std::uint8_t { unknown = 0, free = 1, unsafe = 2, unsure = 3 };

inline constexpr std::uint8_t kVouchedBit = 1U << 2U;  ///< an operator answers for it
inline constexpr std::uint8_t kDropBit = 1U << 3U;  ///< evidence of a drop above the gate's limit
inline constexpr std::uint8_t kOverheadBit = 1U << 4U;  ///< something hangs lower than the machine

/// A cell as the page gets it; messages.json has the meaning of each value.
struct PageCell {
    static constexpr std::int16_t kUnknownHeight = std::numeric_limits<std::int16_t>::min();
    static constexpr std::uint8_t kSigmaSaturated_mm = 255;

    std::int16_t height_mm = kUnknownHeight;  ///< over the map's base
    std::uint8_t sigma_mm = kSigmaSaturated_mm;
    std::uint8_t state = 0;
    friend bool operator==(const PageCell&, const PageCell&) = default;
};
static_assert(sizeof(PageCell) == 4, "cells leave as they lie in memory");

/// The ground as the page shows it. Element = iy * nx + ix, in odom, as in MapSnapshot.
struct PageMap {
    std::uint64_t version = 0;
    std::int64_t frame_time_ns = 0;  ///< of the source's clock
    std::int64_t origin_x_tenth_mm = 0;
    std::int64_t origin_y_tenth_mm = 0;
    std::int32_t base_z_tenth_mm = 0;  ///< heights of cells count from here
    std::int32_t resolution_tenth_mm = 0;
    std::int32_t nx = 0;
    std::int32_t ny = 0;
    std::vector<grid::SnapshotEdge> edges;
    std::vector<PageCell> cells;
};

/// What of a machine colours its ground.
struct ColourLimits {
    std::int32_t cell_sigma_tenth_mm = 0;
    std::int32_t up_tenth_mm = 0;
    std::int32_t down_tenth_mm = 0;
    std::uint8_t drop_evidence = std::numeric_limits<std::uint8_t>::max();
    std::int32_t machine_height_tenth_mm = 0;  ///< 0: nothing hangs too low
};
[[nodiscard]] ColourLimits colour_limits(const Machine& machine) noexcept;

/// For the eye alone, and no permission: it judges a cell and its four neighbours, where the gate
/// judges whole feet, their ways and the body.
/// - unknown: never measured.
/// - unsure: less sure than the gate requires of a cell.
/// - unsafe: evidence of a drop; something that stands on the cell or hangs over it lower than the
///   machine is high; or a step to a neighbour, higher or lower than a walking machine steps.
/// - free: all others.
[[nodiscard]] GroundState ground_state(const grid::MapSnapshot& snapshot,
                                       int ix,
                                       int iy,
                                       const ColourLimits& limits) noexcept;

/// Fills `out` from a snapshot that is sound (nx, ny within kMaxSide). `out.base_z_tenth_mm` stays
/// while the machine is within 20 m of it, so that heights keep their meaning from message to
/// message. Allocates only while maps grow.
void fill_page_map(const grid::MapSnapshot& snapshot,
                   std::int64_t frame_time_ns,
                   const ColourLimits& limits,
                   PageMap& out);

/// The bytes of a map message: what changed since `before`, or all that is known where there was
/// no map before, where it lay otherwise (size, resolution, base, a shift by parts of a cell), or
/// where that is shorter.
[[nodiscard]] std::string map_message(const PageMap& map, const PageMap* before);

}  // namespace surefoot::page
