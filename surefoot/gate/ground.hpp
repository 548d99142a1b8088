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

/// What speaks for the ground in a cell. Only `vouched` and `measured` are knowledge.
enum class Knowledge : std::uint8_t { outside, unknown, attested, measured };

/// The reason for which the gate refuses a cell whose height is not known. Only this function turns
/// unknown ground into a reason; every proof that meets such a cell denies with it.
[[nodiscard]] constexpr Reason reason_of_unknown(Knowledge knowledge) noexcept {
    return knowledge == Knowledge::outside ? Reason::outside_map : Reason::unknown_cells;
}

/// One cell as the gate sees it. The numbers mean something only when `known()`, but for the
/// evidence of a drop, which an unknown cell may have too.
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

/// The map, seen through an operator's word where there is one. The only place where a cell becomes
/// known; a cell without a measurement has no other way than to lie wholly in the vouched area.
/// There the word also stands for a measurement that decides nothing by itself and does not
/// contradict it: it must not be worse to have looked than not to have looked. What hangs over such
/// a cell and evidence of a drop stay, and where lines of sight passed below the vouched ground by
/// a drop the word is wrong: such a cell is unknown and a drop.
class Ground {
  public:
    Ground(const grid::MapSnapshot& map, const Query& query, const GateLimits& limits) noexcept;

    [[nodiscard]] const grid::FixedGrid& grid() const noexcept { return grid_; }
    [[nodiscard]] std::span<const grid::SnapshotEdge> edges() const noexcept;
    /// In the header: a verdict asks for thousands.
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
    /// The eight cells around one are known, and each passes `test(cell)`.
    template <typename Test>
    [[nodiscard]] bool all_around(std::int64_t ix, std::int64_t iy, Test&& test) const noexcept {
        for (std::int64_t y = iy - 1; y <= iy + 1; ++y) {
            for (std::int64_t x = ix - 1; x <= ix + 1; ++x) {
                if (x == ix && y == iy) continue;
                const GroundCell beside = cell(x, y);
                if (!beside.known() || !test(beside)) return false;
            }
        }
        return true;
    }
    /// Twice the centre of a cell relative to twice `origin`: exact for every cell size.
    [[nodiscard]] grid::FixedPoint doubled_center(std::int64_t ix,
                                                  std::int64_t iy,
                                                  grid::FixedPoint origin) const noexcept;
    [[nodiscard]] bool is_attesting() const noexcept { return attestation_; }
    /// Tangent of the largest angle between the map's z axis and the vertical (tilt.hpp).
    [[nodiscard]] double vertical_bound_tan() const noexcept { return vertical_bound_tan_; }
    /// What a verdict about `sweep` may read: the sweep and the vouched area, with a ring of cells
    /// beside both (`all_around`, `ReachableSurfaces::add_beside_attested`).
    [[nodiscard]] Extent zone_of(const Sweep& sweep) const noexcept;
    /// Nobody changed a cell of the rows of a zone since the map was sealed. Precondition:
    /// grid::is_sealed().
    [[nodiscard]] bool is_intact(const Extent& zone) const noexcept;
    [[nodiscard]] const AttestedArea& attested() const noexcept { return attested_; }

  private:
    /// What an operator's word makes of a cell; not in the header, because few verdicts have one.
    void take_word(std::size_t at,
                   std::int64_t ix,
                   std::int64_t iy,
                   GroundCell& cell) const noexcept;
    /// Too unsure for the limits of a foot by itself, and nearer to the word than two of its sigma.
    [[nodiscard]] bool is_unsure_but_agrees(const GroundCell& cell) const noexcept;
    /// Of an unknown cell: there is no ground where somebody vouched for it.
    [[nodiscard]] bool is_proven_lower(std::size_t at) const noexcept;
    /// Whole, in the area.
    [[nodiscard]] bool is_attested(std::int64_t ix, std::int64_t iy) const noexcept;

    const grid::MapSnapshot& map_;
    grid::FixedGrid grid_;
    AttestedArea attested_;
    double vertical_bound_tan_;
    std::int32_t drop_tenth_mm_;
    bool attestation_ = false;
};

/// The connected surfaces that the machine stands on.
class ReachableSurfaces {
  public:
    void add(std::uint16_t component) noexcept;
    [[nodiscard]] bool contains(std::uint16_t component) const noexcept;
    /// Surfaces that begin in the vouched area or beside it, no more than `step_tenth_mm` above or
    /// below it: an operator's word reaches as far as the floor it touches.
    void add_beside_attested(const Ground& ground, std::int32_t step_tenth_mm) noexcept;

  private:
    std::array<std::uint64_t, 1024> bits_{};  // one for each of 65536 labels
};

}  // namespace surefoot::gate
