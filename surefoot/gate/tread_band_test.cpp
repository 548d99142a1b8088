// SPDX-License-Identifier: Apache-2.0
// The cells around a foot on a tread.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/tread_support.hpp"
#include "surefoot/gate/tread_testing.hpp"

namespace surefoot::gate::testing {
namespace {

/// check_tread_bands for one foot in plain code: the expected reasons of each cell.
struct PlainBand {
    std::set<Reason> reasons;
    Evidence evidence;

    PlainBand(const OnTreads& on, const Treads& treads) {
        for (std::size_t foot = 0; foot < 2; ++foot) {
            const Tread& tread = treads[foot];
            on.each_cell(on.sweep.feet[foot].band, [&](std::int64_t ix, std::int64_t iy) {
                look_at(on, tread, foot, ix, iy);
            });
            if (tread.toe_edge != kNone && tread.heel_edge != kNone)
                reasons.insert(Reason::drop_off);
        }
        if (std::abs(treads[0].rise_tenth_mm - treads[1].rise_tenth_mm) >
            on.machine.limits.patch_residual_tenth_mm)
            reasons.insert(Reason::roughness);
    }

  private:
    void below(const OnTreads& on,
               const GroundCell& cell,
               std::int64_t value,
               std::int64_t limit,
               Reason reason) {
        if (value > limit)
            reasons.insert(reason);
        else if (on.machine.limits.sigma_factor * cell.sigma_tenth_mm >
                 static_cast<double>(limit - value))
            reasons.insert(Reason::not_resolvable);
    }
    void look_at(const OnTreads& on,
                 const Tread& tread,
                 std::size_t foot,
                 std::int64_t ix,
                 std::int64_t iy) {
        const GateLimits& limits = on.machine.limits;
        const GroundCell cell = on.ground->cell(ix, iy);
        ++evidence.cells;
        if (!cell.known()) {
            reasons.insert(Reason::unknown_cells);
            return;
        }
        ++evidence.known_cells;
        evidence.attested_cells += cell.knowledge == Knowledge::attested ? 1 : 0;
        evidence.max_drift_tenth_mm =
            std::max<std::int64_t>(evidence.max_drift_tenth_mm, cell.drift_tenth_mm);
        evidence.min_clearance_tenth_mm =
            std::min<std::int64_t>(evidence.min_clearance_tenth_mm, cell.clearance_tenth_mm);
        if (cell.sigma_tenth_mm > limits.cell_sigma_tenth_mm)
            reasons.insert(Reason::not_resolvable);
        if (cell.drift_tenth_mm > limits.drift_tenth_mm) reasons.insert(Reason::memory_uncertain);

        const OnTreads::Place place = on.middle_of(foot, ix, iy);
        const GroundBox& box = on.box(foot);
        const std::int64_t gap = std::max(std::abs(place.along) - box.length_tenth_mm,
                                          std::abs(place.across) - box.width_tenth_mm) -
                                 on.reach();
        // At least 0.1 mm more than the drift, because of rounding.
        const auto drift =
            static_cast<std::int64_t>(std::floor(limits.sigma_factor * cell.drift_tenth_mm)) + 1;
        const std::int64_t above =
            cell.height_tenth_mm - on.query.stance_height_tenth_mm - tread.rise_tenth_mm;
        if (gap < 2 * (limits.foot_margin_tenth_mm + 250 + drift))
            below(on, cell, above, limits.swing_clearance_tenth_mm, Reason::corridor_blocked);
        if (above >= -limits.drop_tenth_mm) {
            below(on, cell, -above, limits.drop_tenth_mm, Reason::drop_off);
        } else if (std::abs(place.along - on.ankle(foot)) <
                   limits.patch_side_tenth_mm + on.reach()) {
            reasons.insert(Reason::drop_off);
        } else {
            below(on, cell, -above, limits.step[1].down_tenth_mm, Reason::drop_off);
        }
    }
};

/// Changes one cell in the band of a foot on even ground. Each number takes the values at a limit
/// and beside it.
TEST(TreadBounds, the_band_of_a_tread_asks_each_cell_what_a_plain_reckoning_asks) {
    Rng rng(92);
    OnTreads on;
    std::array<int, kReasonCount> said{};
    std::int32_t stance = 0;
    for (int round = 0; round < 4000; ++round) {
        if (round % 20 == 0) {
            on.place_anywhere(rng);
            stance = static_cast<std::int32_t>(rng.below(2001)) - 1000;
            on.map->height_tenth_mm.fill(stance);
            on.map->sigma_tenth_mm.fill(0);
            on.map->drift_tenth_mm.fill(0);
            on.map->clearance_tenth_mm.fill(grid::MapSnapshot::kNoCeiling);
            on.map->source.fill(grid::EvidenceSource::measured);
        }
        const std::size_t foot = rng.below(2);
        std::vector<std::size_t> cells;
        on.each_cell(on.sweep.feet[foot].band,
                     [&](std::int64_t ix, std::int64_t iy) { cells.push_back(on.index(ix, iy)); });
        const std::size_t at = cells[rng.below(cells.size())];
        Treads treads;
        for (Tread& tread : treads) tread.known = true;
        const std::int64_t apart = std::array{0, 250, 251, -250, -251}[rng.below(40) % 5];
        treads[1].rise_tenth_mm = rng.below(20) == 0 ? apart : 0;
        if (rng.below(20) == 0) treads[foot].toe_edge = 3000;
        if (rng.below(20) == 0) treads[foot].heel_edge = 3000;
        const auto one_of = [&rng](auto... values) {
            const std::array<std::int64_t, sizeof...(values)> all{values...};
            return all[rng.below(all.size())];
        };
        const std::int64_t height =
            one_of(0, 0, 399, 400, 401, -499, -500, -501, -502, -1799, -1800, -1801, 1600, -200);
        on.map->height_tenth_mm[at] =
            static_cast<std::int32_t>(stance + height + treads[foot].rise_tenth_mm);
        on.map->sigma_tenth_mm[at] = static_cast<std::uint16_t>(
            one_of(0, 0, 0, 1, 30, 58, 59, 117, 118, 120, 121, 147, 148));
        on.map->drift_tenth_mm[at] =
            static_cast<std::uint16_t>(one_of(0, 0, 1, 30, 99, 100, 249, 250, 251));
        on.map->clearance_tenth_mm[at] = static_cast<std::uint16_t>(20'000 + rng.below(9));
        if (rng.below(15) == 0) on.map->source[at] = grid::EvidenceSource::unknown;
        on.query.stance_height_tenth_mm = stance;

        Findings findings;
        check_tread_bands(on.scene(), treads, findings);
        const PlainBand plain(on, treads);
        ASSERT_EQ(reasons_of(findings), plain.reasons) << "round " << round;
        for (const Reason reason : plain.reasons) ++said[static_cast<std::size_t>(reason)];
        ASSERT_EQ(findings.evidence.cells, plain.evidence.cells);
        ASSERT_EQ(findings.evidence.known_cells, plain.evidence.known_cells);
        ASSERT_EQ(findings.evidence.attested_cells, plain.evidence.attested_cells);
        ASSERT_EQ(findings.evidence.max_drift_tenth_mm, plain.evidence.max_drift_tenth_mm);
        ASSERT_EQ(findings.evidence.min_clearance_tenth_mm, plain.evidence.min_clearance_tenth_mm);
        on.map->height_tenth_mm[at] = stance;
        on.map->sigma_tenth_mm[at] = 0;
        on.map->drift_tenth_mm[at] = 0;
        on.map->source[at] = grid::EvidenceSource::measured;
    }
    for (const Reason reason : {Reason::unknown_cells,
                                Reason::not_resolvable,
                                Reason::memory_uncertain,
                                Reason::corridor_blocked,
                                Reason::drop_off,
                                Reason::roughness})
        EXPECT_GT(said[static_cast<std::size_t>(reason)], 20) << to_string(reason);
}

TEST(TreadBounds, a_finding_of_a_band_says_where_how_much_and_against_what) {
    OnTreads on;
    on.map->height_tenth_mm.fill(0);
    const Treads level{Tread{true, 0, kNone, kNone, 0}, Tread{true, 0, kNone, kNone, 0}};
    const std::size_t at = cell_at(*on.map, 0.40 + 0.24 + 0.06, -0.18);
    const auto expect = [&](Reason reason, std::int64_t value, std::int64_t limit) {
        Findings findings;
        check_tread_bands(on.scene(), level, findings);
        const Finding* worst = findings.worst(reason);
        ASSERT_NE(worst, nullptr) << to_string(reason);
        EXPECT_EQ(on.index(worst->cell_x, worst->cell_y), at);
        EXPECT_EQ(worst->foot, Foot::right);
        EXPECT_EQ(worst->value_tenth_mm, value);
        EXPECT_EQ(worst->severity, value);
        EXPECT_EQ(worst->limit_tenth_mm, limit);
    };
    on.map->height_tenth_mm[at] = -1900;
    expect(Reason::drop_off, 1900, 1800);
    on.map->height_tenth_mm[at] = -490;
    on.map->sigma_tenth_mm[at] = 60;
    expect(Reason::not_resolvable, 60, 10);
    on.map->height_tenth_mm[at] = 0;
    on.map->sigma_tenth_mm[at] = 200;
    expect(Reason::not_resolvable, 200, 120);
    on.map->sigma_tenth_mm[at] = 0;
    on.map->drift_tenth_mm[at] = 300;
    expect(Reason::memory_uncertain, 300, 250);
    on.map->source[at] = grid::EvidenceSource::unknown;
    expect(Reason::unknown_cells, 0, 0);
}

TEST(TreadBounds, a_cell_lies_under_the_ankle_with_any_part_of_it) {
    OnTreads on;
    on.map->height_tenth_mm.fill(0);
    const Treads level{Tread{true, 0, kNone, kNone, 0}, Tread{true, 0, kNone, kNone, 0}};
    int cells = 0;
    for (double x_m = 0.40 + 0.11; x_m < 0.40 + 0.23; x_m += 0.025) {
        const std::size_t at = cell_at(*on.map, x_m, 0.18);
        const auto ix = static_cast<std::int64_t>(at % static_cast<std::size_t>(on.map->nx));
        const auto iy = static_cast<std::int64_t>(at / static_cast<std::size_t>(on.map->nx));
        const std::int64_t from_ankle = on.middle_of(0, ix, iy).along - on.ankle(0);
        on.map->height_tenth_mm[at] = -700;  // as low as the next tread may be
        for (const std::int64_t beyond : {0, 1}) {
            on.machine.limits.patch_side_tenth_mm =
                static_cast<std::int32_t>(from_ankle - on.reach() + beyond);
            Findings findings;
            check_tread_bands(on.scene(), level, findings);
            EXPECT_EQ(findings.reasons().contains(Reason::drop_off), beyond == 1) << x_m;
        }
        on.map->height_tenth_mm[at] = 0;
        ++cells;
    }
    EXPECT_GE(cells, 4);
}

TEST(TreadBounds, a_band_counts_what_an_operator_answers_for_and_ends_where_the_map_does) {
    OnTreads on;
    on.map->height_tenth_mm.fill(0);
    const Treads level{Tread{true, 0, kNone, kNone, 0}, Tread{true, 0, kNone, kNone, 0}};
    on.query.attested = {true, 0, 0, 10'000, 0};
    on.map->source.fill(grid::EvidenceSource::unknown);
    on.look();
    Findings attested;
    check_tread_bands(on.scene(), level, attested);
    EXPECT_TRUE(attested.reasons().empty());
    EXPECT_GT(attested.evidence.cells, 100);
    EXPECT_EQ(attested.evidence.attested_cells, attested.evidence.cells);
    on.map->source[cell_at(*on.map, 0.45, 0.18)] = grid::EvidenceSource::measured;
    Findings all_but_one;
    check_tread_bands(on.scene(), level, all_but_one);
    EXPECT_EQ(all_but_one.evidence.attested_cells, attested.evidence.cells - 1);
    // Half a cell of the band lies beyond the last row of the map: one cell is sufficient.
    on.query.attested = {};
    on.map->source.fill(grid::EvidenceSource::measured);
    on.place(26'000, 0, 0.0);
    Findings beyond;
    check_tread_bands(on.scene(), level, beyond);
    EXPECT_TRUE(beyond.reasons().contains(Reason::outside_map));
    EXPECT_FALSE(beyond.reasons().contains(Reason::unknown_cells));
    std::int64_t all = 0;
    for (const FootSweep& foot : on.sweep.feet)
        on.each_cell(foot.band, [&all](std::int64_t, std::int64_t) { ++all; });
    EXPECT_LT(beyond.evidence.cells, all);
}

}  // namespace
}  // namespace surefoot::gate::testing
