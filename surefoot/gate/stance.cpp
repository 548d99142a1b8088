// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/stance.hpp"

#include <algorithm>
#include <span>

namespace surefoot::gate {
namespace {

/// Slopes between cells along one axis. With more pairs than fit, the first ones count.
class Slopes {
  public:
    void add(std::int64_t rise_tenth_mm, std::int64_t cells) noexcept {
        if (count_ == slopes_.size()) return;
        slopes_[count_++] =
            rise_tenth_mm * (std::int64_t{1} << StancePlane::kFractionBits) / (2 * cells);
    }
    /// True if there are enough pairs for a slope.
    [[nodiscard]] bool any() const noexcept { return count_ >= kFewest; }
    [[nodiscard]] std::int64_t median() noexcept { return any() ? at_rank(count_ / 2) : 0; }
    /// Returns the slope that three quarters of the pairs reach or exceed. Returns zero if there is
    /// no such slope.
    [[nodiscard]] std::int64_t shared() noexcept {
        if (!any()) return 0;
        const std::int64_t low = at_rank(count_ / 4);
        if (low > 0) return low;
        return std::min<std::int64_t>(0, at_rank(count_ - 1 - count_ / 4));
    }

  private:
    std::int64_t at_rank(std::size_t rank) noexcept {
        const auto begin = slopes_.begin();
        const auto nth = begin + static_cast<std::ptrdiff_t>(rank);
        std::nth_element(begin, nth, begin + static_cast<std::ptrdiff_t>(count_));
        return *nth;
    }

    static constexpr std::size_t kFewest = 8;

    std::array<std::int64_t, 512> slopes_{};
    std::size_t count_ = 0;
};

struct AxisSlopes {
    Slopes x;
    Slopes y;
};

/// Adds the slopes between the known cells of a polygon to all of `groups`.
template <typename... Groups>
void add_slopes(const Ground& ground,
                const grid::FixedConvex& polygon,
                Groups&... groups) noexcept {
    const grid::RowRuns area(polygon, ground.grid());
    const grid::FixedRun rows = area.rows();
    const grid::FixedRun columns = area.columns();
    const std::int64_t apart_x = std::max<std::int64_t>(1, (columns.last - columns.first + 1) / 2);
    const std::int64_t apart_y = std::max<std::int64_t>(1, (rows.last - rows.first + 1) / 2);
    for (std::int64_t iy = rows.first; iy <= rows.last; ++iy) {
        const grid::FixedRun run = area.run(iy);
        const grid::FixedRun above = area.run(iy + apart_y);
        for (std::int64_t ix = run.first; ix <= run.last; ++ix) {
            const GroundCell cell = ground.cell(ix, iy);
            if (!cell.known()) continue;
            const auto add = [&](Slopes AxisSlopes::*axis,
                                 const GroundCell& other,
                                 std::int64_t apart) {
                // An attested height can differ from the heights measured beside it.
                if (other.knowledge == cell.knowledge)
                    ((groups.*axis).add(other.height_tenth_mm - cell.height_tenth_mm, apart), ...);
            };
            if (run.contains(ix + apart_x))
                add(&AxisSlopes::x, ground.cell(ix + apart_x, iy), apart_x);
            if (above.contains(ix)) add(&AxisSlopes::y, ground.cell(ix, iy + apart_y), apart_y);
        }
    }
}

/// Sums over known cells. Positions are doubled, in cells.
struct Sums {
    std::int64_t count = 0;
    std::int64_t x = 0;
    std::int64_t y = 0;
    std::int64_t z = 0;
};

/// Adds the known cells under one foot. `above`: heights count from this plane.
void add_cells(const Ground& ground,
               const FootSweep& foot,
               const StancePlane& above,
               Sums& sums) noexcept {
    grid::for_each_overlapped_cell(
        foot.stance, ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
            const GroundCell cell = ground.cell(ix, iy);
            if (cell.known()) {
                ++sums.count;
                sums.x += 2 * ix + 1;
                sums.y += 2 * iy + 1;
                sums.z += cell.height_tenth_mm - above.at(ix, iy);
            }
            return true;
        });
}

/// Returns the median height of the known cells under some feet. A part of a foot can hang over the
/// nosing of its tread. With more cells than fit, the first ones count. Empty without known cells.
std::optional<std::int64_t> level_under(const Ground& ground,
                                        std::span<const FootSweep> feet) noexcept {
    std::array<std::int64_t, 2048> heights;  // NOLINT(*-member-init): only the first `count` count
    std::size_t count = 0;
    for (const FootSweep& foot : feet) {
        grid::for_each_overlapped_cell(
            foot.stance, ground.grid(), [&](std::int64_t ix, std::int64_t iy) {
                const GroundCell cell = ground.cell(ix, iy);
                if (cell.known() && count < heights.size()) heights[count++] = cell.height_tenth_mm;
                return true;
            });
    }
    if (count == 0) return std::nullopt;
    const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(heights.begin(), middle, heights.begin() + static_cast<std::ptrdiff_t>(count));
    return *middle;
}

}  // namespace

StancePlane::Tangents StancePlane::tangents(std::int64_t side_tenth_mm) const noexcept {
    const double per_unit = 2.0 / (static_cast<double>(std::int64_t{1} << kFractionBits) *
                                   static_cast<double>(side_tenth_mm));
    return {per_unit * static_cast<double>(slope_x), per_unit * static_cast<double>(slope_y)};
}

Stance find_stance(const Ground& ground,
                   const Query& query,
                   const Sweep& sweep,
                   bool level) noexcept {
    Stance stance;
    StancePlane& plane = stance.plane;
    Sums both;
    for (const FootSweep& foot : sweep.feet) add_cells(ground, foot, StancePlane{}, both);
    const bool given = query.stance_source == StanceHeight::given;
    stance.known = given || both.count > 0;
    if (!stance.known) return stance;
    if (both.count > 0) {
        plane.middle = {grid::rounded_div(both.x, both.count),
                        grid::rounded_div(both.y, both.count)};
        plane.height_tenth_mm =
            level ? *level_under(ground, sweep.feet) : grid::rounded_div(both.z, both.count);
    }
    if (given) plane.height_tenth_mm = query.stance_height_tenth_mm;
    stance.parts.fill(plane);
    if (!level) {
        AxisSlopes under;
        std::array<AxisSlopes, 4> parts;  // rear, front, left, right
        for (std::size_t foot = 0; foot < sweep.feet.size(); ++foot) {
            add_slopes(ground, sweep.feet[foot].stance, under);
            for (std::size_t half = 0; half < 2; ++half)
                add_slopes(ground, sweep.feet[foot].halves[half], parts[half], parts[2 + foot]);
        }
        for (std::size_t i = 0; i < parts.size(); ++i) {
            stance.parts[i].slope_x = parts[i].x.median();
            stance.parts[i].slope_y = parts[i].y.median();
        }
        plane.slope_x = under.x.shared();
        plane.slope_y = under.y.shared();
    }
    for (std::size_t i = 0; i < sweep.feet.size(); ++i) {
        if (level) {
            if (const auto own = level_under(ground, {&sweep.feet[i], 1}))
                stance.feet_tenth_mm[i] = *own - plane.height_tenth_mm;
            continue;
        }
        Sums own;
        add_cells(ground, sweep.feet[i], plane, own);
        if (own.count > 0) stance.feet_tenth_mm[i] = grid::rounded_div(own.z, own.count);
    }
    return stance;
}

}  // namespace surefoot::gate
