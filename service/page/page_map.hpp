// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "surefoot/core/machine.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::page {

/// Colour class of a cell on the page: bits 0-1 of the state of the cell. See ground_state().
enum class GroundState : std::uint8_t { unknown = 0, free = 1, unsafe = 2, unsure = 3 };

/// Operator attestation: an operator confirmed this ground.
inline constexpr std::uint8_t kAttestedBit = 1U << 2U;
inline constexpr std::uint8_t kDropBit = 1U << 3U;  ///< evidence of a drop beyond the limit
/// An object above the cell hangs lower than the machine is high.
inline constexpr std::uint8_t kOverheadBit = 1U << 4U;

/// A cell in the form that the page receives. messages.json defines each value.
struct PageCell {
    static constexpr std::int16_t kUnknownHeight = std::numeric_limits<std::int16_t>::min();
    static constexpr std::uint8_t kSigmaSaturated_mm = 255;

    std::int16_t height_mm = kUnknownHeight;  ///< height above PageMap::base_z_tenth_mm
    std::uint8_t sigma_mm = kSigmaSaturated_mm;
    std::uint8_t state = 0;
    friend bool operator==(const PageCell&, const PageCell&) = default;
};
static_assert(sizeof(PageCell) == 4, "map_message() copies each cell as 4 bytes");

/// The map that the page shows, in odom. Cell (ix, iy) is the element iy * nx + ix of `cells`, as
/// in MapSnapshot.
struct PageMap {
    std::uint64_t version = 0;
    std::int64_t frame_time_ns = 0;  ///< time on the source's clock
    std::int64_t origin_x_tenth_mm = 0;
    std::int64_t origin_y_tenth_mm = 0;
    std::int32_t base_z_tenth_mm = 0;  ///< zero of PageCell::height_mm, in odom
    std::int32_t resolution_tenth_mm = 0;
    std::int32_t nx = 0;
    std::int32_t ny = 0;
    std::vector<grid::SnapshotEdge> edges;
    std::vector<PageCell> cells;
};

/// Limits of the machine that determine the colour of a cell. The default of drop_evidence is the
/// largest possible value.
struct ColourLimits {
    std::int32_t cell_sigma_tenth_mm = 0;
    std::int32_t up_tenth_mm = 0;
    std::int32_t down_tenth_mm = 0;
    std::uint8_t drop_evidence = std::numeric_limits<std::uint8_t>::max();
    /// Height of the highest body part; 0 = no check for obstacles above the ground.
    std::int32_t machine_height_tenth_mm = 0;
};
[[nodiscard]] ColourLimits colour_limits(const Machine& machine) noexcept;

/// Returns the colour class of a cell, for display only: it is not a permission to step. It rates
/// one cell and its four neighbours. The gate rates whole feet, their paths and the body.
/// - unknown: the map has no measured height of the cell.
/// - unsure: the cell's sigma exceeds the gate's limit for a cell.
/// - unsafe: the cell has evidence of a drop, or an object above the cell hangs lower than the
///   machine is high, or the height difference to a neighbour exceeds the step limits of walking.
/// - free: all other cells.
[[nodiscard]] GroundState ground_state(const grid::MapSnapshot& snapshot,
                                       int ix,
                                       int iy,
                                       const ColourLimits& limits) noexcept;

/// Fills `out` from a valid snapshot (nx and ny within kMaxSide). `out.base_z_tenth_mm` stays the
/// same while the height of the machine is within 20 m of it. So unchanged cells keep their values
/// from message to message. Allocates memory only when the map grows.
void fill_page_map(const grid::MapSnapshot& snapshot,
                   std::int64_t frame_time_ns,
                   const ColourLimits& limits,
                   PageMap& out);

/// Returns the binary map message with the cells that changed since `before`. The message contains
/// all known cells if `before` is null, or the grids do not match (size, resolution, base height,
/// or a shift by a fraction of a cell), or if all known cells need fewer bytes.
[[nodiscard]] std::string map_message(const PageMap& map, const PageMap* before);

}  // namespace surefoot::page
