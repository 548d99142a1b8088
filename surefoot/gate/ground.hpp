// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "surefoot/gate/footprints.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/grid/fixed_polygon.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::gate {

/// Source of the knowledge about a cell. Only `attested` and `measured` count as known.
enum class Knowledge : std::uint8_t { outside, unknown, attested, measured };

/// Returns the reason for which the gate refuses a cell without a known height. All tests of
/// decide() take the reason for such a cell from this function.
[[nodiscard]] constexpr Reason reason_of_unknown(Knowledge knowledge) noexcept {
    return knowledge == Knowledge::outside ? Reason::outside_map : Reason::unknown_cells;
}

/// One cell as the gate reads it. The numbers are valid only if `known()` is true, except for the
/// drop evidence: it is also valid in an unknown cell.
struct GroundCell {
    Knowledge knowledge = Knowledge::unknown;
    std::uint8_t drop_evidence = 0;
    std::uint16_t component = grid::MapSnapshot::kNoComponent;
    std::int32_t sigma_tenth_mm = 0;
    std::int32_t drift_tenth_mm = 0;
    std::int32_t clearance_tenth_mm = grid::MapSnapshot::kNoCeiling;
    std::int64_t height_tenth_mm = 0;  ///< odom z

    [[nodiscard]] bool known() const noexcept {
        return knowledge == Knowledge::attested || knowledge == Knowledge::measured;
    }
};

/// The map together with the operator's attestation. Only this class makes a cell known. A cell
/// without a measurement becomes known only if it lies wholly in the attested area. There the
/// attestation also replaces a measurement that agrees with it but is too uncertain to decide. So
/// such a measurement never makes the verdict worse than no measurement. Overhead obstacles
/// and drop evidence stay. An unknown cell there is a drop if a ray proves it lower by more than
/// `drop`.
class Ground {
  public:
    Ground(const grid::MapSnapshot& map, const Query& query, const GateLimits& limits) noexcept;

    [[nodiscard]] const grid::FixedGrid& grid() const noexcept { return grid_; }
    [[nodiscard]] std::span<const grid::SnapshotEdge> edges() const noexcept;
    /// Defined in the header for speed: one verdict reads thousands of cells.
    [[nodiscard]] GroundCell cell(std::int64_t ix, std::int64_t iy) const noexcept {
        GroundCell cell;
        if (ix < 0 || iy < 0 || ix >= map_.nx || iy >= map_.ny) {
            cell.knowledge = Knowledge::outside;
            return cell;
        }
        const auto at = static_cast<std::size_t>(iy * map_.nx + ix);
        cell.drop_evidence = map_.drop_evidence[at];
        if (map_.is_measured(at)) {
            cell.knowledge = Knowledge::measured;
            cell.component = map_.component[at];
            cell.sigma_tenth_mm = map_.sigma_tenth_mm[at];
            cell.drift_tenth_mm = map_.drift_tenth_mm[at];
            cell.clearance_tenth_mm = map_.clearance_tenth_mm[at];
            cell.height_tenth_mm = map_.height_tenth_mm[at];
        }
        if (attestation_) take_word(at, ix, iy, cell);
        return cell;
    }
    /// For an unknown cell inside the map: true if lines of sight over it show that nothing in it
    /// is higher than `z_tenth_mm` (odom).
    [[nodiscard]] bool is_below(std::int64_t ix,
                                std::int64_t iy,
                                std::int64_t z_tenth_mm) const noexcept;
    /// True if the eight cells around a cell are known and each passes `test(cell, ix, iy)`.
    template <typename Test>
    [[nodiscard]] bool all_around(std::int64_t ix, std::int64_t iy, Test&& test) const noexcept {
        for (std::int64_t y = iy - 1; y <= iy + 1; ++y) {
            for (std::int64_t x = ix - 1; x <= ix + 1; ++x) {
                if (x == ix && y == iy) continue;
                const GroundCell beside = cell(x, y);
                if (!beside.known() || !test(beside, x, y)) return false;
            }
        }
        return true;
    }
    /// Returns twice the centre of a cell minus twice `origin`; exact for every cell size.
    [[nodiscard]] grid::FixedPoint doubled_center(std::int64_t ix,
                                                  std::int64_t iy,
                                                  grid::FixedPoint origin) const noexcept;
    [[nodiscard]] bool is_attesting() const noexcept { return attestation_; }
    /// Returns tan of the largest angle between the map's z axis and the vertical (tilt.hpp).
    [[nodiscard]] double vertical_bound_tan() const noexcept { return vertical_bound_tan_; }
    /// Returns the zone that a verdict about `sweep` may read: sweep, attested area, and a ring of
    /// cells around both (`all_around`, `ReachableSurfaces::add_beside_attested`).
    [[nodiscard]] Extent zone_of(const Sweep& sweep) const noexcept;
    /// True if no cell in the rows of a zone changed since the map was sealed. Precondition:
    /// grid::is_sealed().
    [[nodiscard]] bool is_intact(const Extent& zone) const noexcept;
    [[nodiscard]] const AttestedArea& attested() const noexcept { return attested_; }

  private:
    /// Applies the attestation to a cell. Defined in ground.cpp, because few verdicts need it.
    void take_word(std::size_t at,
                   std::int64_t ix,
                   std::int64_t iy,
                   GroundCell& cell) const noexcept;
    /// True if sigma is above 7.9 mm and the height is within 15 mm of the attested height.
    [[nodiscard]] bool is_unsure_but_agrees(const GroundCell& cell) const noexcept;
    /// For an unknown cell: true if rays prove it more than `drop` below the attested ground.
    [[nodiscard]] bool is_proven_lower(std::size_t at) const noexcept;
    /// True if the whole cell lies in the attested area.
    [[nodiscard]] bool is_attested(std::int64_t ix, std::int64_t iy) const noexcept;

    const grid::MapSnapshot& map_;
    grid::FixedGrid grid_;
    AttestedArea attested_;
    double vertical_bound_tan_;
    std::int32_t drop_tenth_mm_;
    bool attestation_ = false;
};

/// The connected surfaces (component labels of the map) that the machine can reach.
class ReachableSurfaces {
  public:
    void add(std::uint16_t component) noexcept;
    [[nodiscard]] bool contains(std::uint16_t component) const noexcept;
    /// Adds surfaces in or beside the attested area that lie at most `step_tenth_mm` above or below
    /// the area. So an attestation extends to the floor that it touches.
    void add_beside_attested(const Ground& ground, std::int32_t step_tenth_mm) noexcept;

  private:
    std::array<std::uint64_t, 1024> bits_{};  // one bit for each of 65536 labels
};

}  // namespace surefoot::gate
