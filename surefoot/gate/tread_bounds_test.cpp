// SPDX-License-Identifier: Apache-2.0
// The rules of treads, one by one. Each is compared with the same rule in plain code, at its limits
// to the tenth of a millimetre.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/tread_support.hpp"

namespace surefoot::gate::testing {
namespace {

constexpr std::int64_t kNone = Tread::kNone;

/// A machine with a movement of class stair, on a map that is set cell by cell.
struct OnTreads {
    std::unique_ptr<grid::MapSnapshot> map = Terrain().snapshot();
    Machine machine = rex();
    Query query = make_query(kForward, 0.0, 0.0, 1.0, 0.0);
    Sweep sweep;
    std::optional<Ground> ground;

    OnTreads() {
        machine.limits.step[1] = {true, 1800, 1800};
        machine.movements[kForward].movement_class = MovementClass::stair;
        map->sigma_tenth_mm.fill(0);
        map->drift_tenth_mm.fill(0);
        place(0, 0, 0.0);
    }
    void place(std::int64_t x_tenth_mm, std::int64_t y_tenth_mm, double yaw_rad) {
        query = make_query(kForward, 0.0, 0.0, std::cos(yaw_rad), std::sin(yaw_rad));
        query.x_tenth_mm = x_tenth_mm;
        query.y_tenth_mm = y_tenth_mm;
        look();
    }
    /// Call it again after a change of the machine.
    void look() {
        sweep =
            sweep_of(machine,
                     fixed_pose(query.x_tenth_mm, query.y_tenth_mm, query.cos_yaw, query.sin_yaw),
                     machine.movements[query.command]);
        ground.emplace(*map, query, machine.limits);
    }
    /// A random position within a cell, random heading and ankle, feet of two sizes.
    void place_anywhere(Rng& rng) {
        machine.right_foot.length_tenth_mm = 3320;
        machine.right_foot.width_tenth_mm = 1700;
        machine.ankle_from_heel_tenth_mm = 1000 + static_cast<std::int32_t>(rng.below(1800));
        machine.limits.patch_side_tenth_mm = 300 + static_cast<std::int32_t>(rng.below(300));
        place(static_cast<std::int64_t>(rng.below(250)),
              static_cast<std::int64_t>(rng.below(250)),
              rng.uniform(-3.2, 3.2));
    }
    [[nodiscard]] Scene scene() const {
        return {machine,
                machine.movements[query.command],
                *ground,
                sweep,
                query.stance_height_tenth_mm};
    }
    [[nodiscard]] std::size_t index(std::int64_t ix, std::int64_t iy) const {
        return static_cast<std::size_t>(iy * map->nx + ix);
    }
    [[nodiscard]] const GroundBox& box(std::size_t foot) const {
        return foot == 0 ? machine.left_foot : machine.right_foot;
    }

    /// A position along and across a landed foot, from its middle, doubled and rounded.
    struct Place {
        std::int64_t along = 0;
        std::int64_t across = 0;
    };
    [[nodiscard]] Place place_of(std::size_t foot, double x_tenth_mm, double y_tenth_mm) const {
        constexpr double kOne = 1048576.0;
        const grid::FixedPoint middle = sweep.feet[foot].landing_center;
        const double x = 2.0 * (x_tenth_mm - static_cast<double>(middle.x));
        const double y = 2.0 * (y_tenth_mm - static_cast<double>(middle.y));
        const auto c = static_cast<double>(sweep.target.cos_yaw);
        const auto s = static_cast<double>(sweep.target.sin_yaw);
        return {static_cast<std::int64_t>(std::floor((c * x + s * y) / kOne + 0.5)),
                static_cast<std::int64_t>(std::floor((c * y - s * x) / kOne + 0.5))};
    }
    [[nodiscard]] Place middle_of(std::size_t foot, std::int64_t ix, std::int64_t iy) const {
        const auto at = [](std::int64_t origin, std::int64_t i) {
            return static_cast<double>(origin) + 250.0 * (static_cast<double>(i) + 0.5);
        };
        return place_of(foot, at(map->origin_x_tenth_mm, ix), at(map->origin_y_tenth_mm, iy));
    }
    /// Half of a cell's projection on the axes of the foot, doubled, rounded up.
    [[nodiscard]] std::int64_t reach() const {
        const double shadow = std::abs(static_cast<double>(sweep.target.cos_yaw)) +
                              std::abs(static_cast<double>(sweep.target.sin_yaw));
        return 1 + static_cast<std::int64_t>(std::ceil(250.0 * shadow / 1048576.0));
    }
    [[nodiscard]] std::int64_t ankle(std::size_t foot) const {
        return 2 * machine.ankle_from_heel_tenth_mm - box(foot).length_tenth_mm;
    }
    template <typename Visit>
    void each_cell(const grid::FixedConvex& region, Visit&& visit) const {
        grid::for_each_overlapped_cell(
            region, ground->grid(), [&](std::int64_t ix, std::int64_t iy) {
                visit(ix, iy);
                return true;
            });
    }
};

/// find_treads in plain code.
Tread plain_tread(const OnTreads& on, std::size_t foot) {
    Tread tread;
    double sum = 0.0;
    double count = 0.0;
    bool all_known = true;
    on.each_cell(on.sweep.feet[foot].landing, [&](std::int64_t ix, std::int64_t iy) {
        if (std::abs(on.middle_of(foot, ix, iy).along - on.ankle(foot)) >
            on.machine.limits.patch_side_tenth_mm)
            return;
        const GroundCell cell = on.ground->cell(ix, iy);
        all_known = all_known && cell.known();
        sum += static_cast<double>(cell.height_tenth_mm - on.query.stance_height_tenth_mm);
        count += 1.0;
    });
    tread.known = all_known && count > 0.0;
    if (!tread.known) return tread;
    tread.rise_tenth_mm = static_cast<std::int64_t>(std::floor(sum / count + 0.5));
    on.each_cell(on.sweep.feet[foot].band, [&](std::int64_t ix, std::int64_t iy) {
        const GroundCell cell = on.ground->cell(ix, iy);
        if (!cell.known()) return;
        tread.drift_tenth_mm = std::max<std::int64_t>(tread.drift_tenth_mm, cell.drift_tenth_mm);
        const std::int64_t above =
            cell.height_tenth_mm - on.query.stance_height_tenth_mm - tread.rise_tenth_mm;
        const bool lower = above < -on.machine.limits.drop_tenth_mm;
        const bool last = cell.drop_evidence >= on.machine.limits.drop_evidence &&
                          above <= on.machine.limits.swing_clearance_tenth_mm;
        if (!lower && !last) return;
        // The cell itself is off the tread, or it is the last cell of it.
        const std::int64_t along = on.middle_of(foot, ix, iy).along;
        const std::int64_t from_middle = lower ? -on.reach() : on.reach();
        if (along > on.ankle(foot))
            tread.toe_edge = std::min(tread.toe_edge, along + from_middle);
        else
            tread.heel_edge = std::min(tread.heel_edge, from_middle - along);
    });
    return tread;
}

TEST(TreadBounds, level_and_ends_of_a_tread_are_those_of_a_plain_reckoning) {
    Rng rng(91);
    OnTreads on;
    int toes = 0;
    int heels = 0;
    int unknown = 0;
    for (int round = 0; round < 400; ++round) {
        on.place_anywhere(rng);
        const std::int32_t stance = static_cast<std::int32_t>(rng.below(2001)) - 1000;
        on.query.stance_height_tenth_mm = stance;
        on.machine.limits.drop_evidence = static_cast<std::uint8_t>(1 + rng.below(255));
        const std::int64_t rise = static_cast<std::int64_t>(rng.below(3000)) - 1500;
        for (const FootSweep& foot : on.sweep.feet) {
            on.each_cell(foot.band, [&](std::int64_t ix, std::int64_t iy) {
                const std::size_t at = on.index(ix, iy);
                const std::uint64_t what = rng.below(200);
                on.map->height_tenth_mm[at] =
                    stance +
                    static_cast<std::int32_t>(rise + static_cast<std::int64_t>(rng.below(20)));
                on.map->drop_evidence[at] = 0;
                on.map->source[at] = grid::EvidenceSource::measured;
                on.map->drift_tenth_mm[at] = static_cast<std::uint16_t>(rng.below(50));
                if (what == 0) on.map->source[at] = grid::EvidenceSource::unknown;
                if (what >= 1 && what <= 3) on.map->height_tenth_mm[at] -= 650;
                if (what == 4 || what == 5) {
                    on.map->drop_evidence[at] = static_cast<std::uint8_t>(
                        on.machine.limits.drop_evidence - (what == 4 ? 0 : 1));
                }
            });
        }
        const Treads found = find_treads(on.scene());
        for (std::size_t foot = 0; foot < 2; ++foot) {
            const Tread plain = plain_tread(on, foot);
            ASSERT_EQ(found[foot].known, plain.known) << round;
            if (!plain.known) ++unknown;
            ASSERT_EQ(found[foot].rise_tenth_mm, plain.rise_tenth_mm) << round;
            ASSERT_EQ(found[foot].toe_edge, plain.toe_edge) << round;
            ASSERT_EQ(found[foot].heel_edge, plain.heel_edge) << round;
            ASSERT_EQ(found[foot].drift_tenth_mm, plain.drift_tenth_mm) << round;
            toes += plain.toe_edge != kNone ? 1 : 0;
            heels += plain.heel_edge != kNone ? 1 : 0;
        }
    }
    EXPECT_GT(toes, 200);
    EXPECT_GT(heels, 200);
    EXPECT_GT(unknown, 10);
}

TEST(TreadBounds, one_cell_under_the_ankle_is_a_tread_and_none_is_not) {
    OnTreads on;
    on.map->height_tenth_mm.fill(123);
    on.machine.left_foot.width_tenth_mm = 20;  // within one row of cells
    on.machine.limits.patch_side_tenth_mm = 1;
    const auto look_from = [&on](std::int64_t x_tenth_mm) {
        on.place(x_tenth_mm, 100, 0.0);
        return find_treads(on.scene())[0];
    };
    int found = 0;
    for (std::int64_t x = 0; x < 250; ++x) {
        const Tread tread = look_from(x);
        if (!tread.known) continue;
        ++found;
        EXPECT_EQ(tread.rise_tenth_mm, 123);
    }
    EXPECT_EQ(found, 1);  // only where the middle of a cell is the middle of the ankle
}

TEST(TreadBounds, a_drop_begins_a_tenth_of_a_millimetre_beyond_its_limit) {
    OnTreads on;
    on.map->height_tenth_mm.fill(0);
    // Ahead of the toes, far from the ankle.
    const std::size_t at = cell_at(*on.map, 0.40 + 0.24 + 0.06, 0.18);
    const auto with = [&](std::int32_t height, std::uint8_t evidence) {
        on.map->height_tenth_mm[at] = height;
        on.map->drop_evidence[at] = evidence;
        return find_treads(on.scene())[0].toe_edge;
    };
    EXPECT_EQ(with(-500, 0), kNone);
    const std::int64_t begins = with(-501, 0);
    EXPECT_NE(begins, kNone);
    EXPECT_EQ(with(-500, 127), kNone);
    // A cell with evidence is ground itself: the edge is its far side.
    EXPECT_EQ(with(-500, 128), begins + 2 * on.reach());
    EXPECT_NE(with(400, 128), kNone);
    EXPECT_EQ(with(401, 128), kNone);  // a wall, not the ground before a drop
}

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

std::set<Reason> reasons_of(const Findings& findings) {
    std::set<Reason> all;
    for (int i = 0; i < kReasonCount; ++i) {
        if (findings.reasons().contains(static_cast<Reason>(i))) all.insert(static_cast<Reason>(i));
    }
    return all;
}

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

/// check_tread on even ground in plain code: the part that numbers alone decide.
enum class Carried { whole, unsure, little };

struct PlainCarried {
    std::int64_t seen_toe, seen_heel, sure_toe, sure_heel;
    Carried answer = Carried::little;

    PlainCarried(const OnTreads& on,
                 std::size_t foot,
                 const Tread& tread,
                 std::optional<std::int64_t> toe_line = {},
                 std::optional<std::int64_t> heel_line = {}) {
        const std::int64_t length = on.box(foot).length_tenth_mm;
        const auto sure = [&](std::int64_t edge, std::optional<std::int64_t> line) {
            if (edge == kNone) return length;
            std::int64_t end = edge - 500;
            if (line && *line > end) end = std::min(edge, *line);
            const double drift =
                on.machine.limits.sigma_factor * static_cast<double>(tread.drift_tenth_mm);
            return std::min(length, end - 2 * (static_cast<std::int64_t>(std::floor(drift)) + 1));
        };
        seen_toe = std::min(length, tread.toe_edge);
        seen_heel = std::min(length, tread.heel_edge);
        sure_toe = sure(tread.toe_edge, toe_line);
        sure_heel = sure(tread.heel_edge, heel_line);
        const GateLimits& limits = on.machine.limits;
        const auto enough = [&](std::int64_t toe, std::int64_t heel) {
            const double share = static_cast<double>(toe + heel) / static_cast<double>(2 * length);
            return 1000.0 * share >= limits.tread_share_permille - 1e-9 &&
                   length - toe <= 2 * limits.tread_overhang_tenth_mm &&
                   length - heel <= 2 * limits.tread_overhang_tenth_mm &&
                   toe >= on.ankle(foot) + limits.patch_side_tenth_mm &&
                   heel >= limits.patch_side_tenth_mm - on.ankle(foot);
        };
        if (enough(sure_toe, sure_heel))
            answer = Carried::whole;
        else if (enough(seen_toe, seen_heel))
            answer = Carried::unsure;
    }
};

Findings tread_findings(const OnTreads& on, std::size_t foot, const Tread& tread) {
    ReachableSurfaces reachable;
    reachable.add(1);
    Findings findings;
    check_tread(on.scene(), on.sweep.feet[foot], on.box(foot), tread, reachable, findings);
    return findings;
}

Carried answer_of(const Findings& findings) {
    if (findings.reasons().contains(Reason::support_area)) return Carried::little;
    return findings.reasons().contains(Reason::edge_margin) ? Carried::unsure : Carried::whole;
}

TEST(TreadBounds, what_carries_a_foot_is_enough_to_the_tenth_of_a_millimetre) {
    Rng rng(93);
    OnTreads on;
    on.map->height_tenth_mm.fill(0);
    std::array<int, 3> answers{};
    for (int round = 0; round < 6000; ++round) {
        on.place_anywhere(rng);
        on.machine.limits.tread_share_permille = static_cast<std::int32_t>(700 + 50 * rng.below(6));
        on.machine.limits.tread_overhang_tenth_mm = static_cast<std::int32_t>(rng.below(900));
        const std::size_t foot = rng.below(2);
        const GateLimits& limits = on.machine.limits;
        const std::int64_t length = on.box(foot).length_tenth_mm;
        Tread tread{true, 0, kNone, kNone, 0};
        tread.drift_tenth_mm = static_cast<std::int64_t>(rng.below(3) * rng.below(60));
        const std::int64_t doubt =
            500 + 2 * (static_cast<std::int64_t>(limits.sigma_factor *
                                                 static_cast<double>(tread.drift_tenth_mm)) +
                       1);
        // At one of the limits, as measured or with uncertainty, and 0.1 mm beside it.
        const auto edge = [&](std::int64_t ankle) -> std::int64_t {
            const std::array<std::int64_t, 5> at{
                length - 2 * limits.tread_overhang_tenth_mm,
                2 * limits.tread_share_permille * length / 1000 - length,
                ankle + limits.patch_side_tenth_mm,
                length,
                static_cast<std::int64_t>(rng.below(3000))};
            return at[rng.below(5)] + static_cast<std::int64_t>(rng.below(2)) * doubt +
                   static_cast<std::int64_t>(rng.below(5)) - 2;
        };
        if (rng.below(3) != 0) tread.toe_edge = edge(on.ankle(foot));
        if (rng.below(3) != 0) tread.heel_edge = edge(-on.ankle(foot));
        const PlainCarried plain(on, foot, tread);
        const Findings findings = tread_findings(on, foot, tread);
        ASSERT_EQ(answer_of(findings), plain.answer)
            << "round " << round << ", toe " << tread.toe_edge << ", heel " << tread.heel_edge;
        ++answers[static_cast<std::size_t>(plain.answer)];
        if (plain.answer == Carried::whole) {
            ASSERT_TRUE(findings.reasons().empty());
            continue;
        }
        const bool unsure = plain.answer == Carried::unsure;
        const std::int64_t carried =
            unsure ? plain.sure_toe + plain.sure_heel : plain.seen_toe + plain.seen_heel;
        const Finding* worst = findings.worst(unsure ? Reason::edge_margin : Reason::support_area);
        ASSERT_NE(worst, nullptr);
        ASSERT_EQ(worst->value_tenth_mm, std::max<std::int64_t>(0, carried / 2));
        ASSERT_EQ(worst->severity, -(carried / 2));
        ASSERT_EQ(worst->limit_tenth_mm, limits.tread_share_permille * length / 1000);
        ASSERT_EQ(worst->foot, foot == 0 ? Foot::left : Foot::right);
        const grid::FixedPoint middle = on.sweep.feet[foot].landing_center;
        ASSERT_EQ(worst->cell_x, (middle.x - on.map->origin_x_tenth_mm) / 250);
        ASSERT_EQ(worst->cell_y, (middle.y - on.map->origin_y_tenth_mm) / 250);
    }
    for (const int count : answers) EXPECT_GT(count, 300);
}

TEST(TreadBounds, the_ground_of_the_ankle_is_carried_to_its_last_tenth_of_a_millimetre) {
    OnTreads on;
    on.map->height_tenth_mm.fill(0);
    on.machine.limits.tread_share_permille = 600;
    on.machine.limits.tread_overhang_tenth_mm = 3000;
    on.machine.limits.patch_side_tenth_mm = 500;
    const std::int64_t doubt = 502;
    for (const bool at_toe : {true, false}) {
        on.machine.ankle_from_heel_tenth_mm = at_toe ? 2600 : 1060;
        on.look();
        const std::int64_t wanted = 1540 + 500;  // from the middle, doubled
        const auto with = [&](std::int64_t edge) {
            Tread tread{true, 0, kNone, kNone, 0};
            (at_toe ? tread.toe_edge : tread.heel_edge) = edge;
            return answer_of(tread_findings(on, 0, tread));
        };
        EXPECT_EQ(with(wanted + doubt), Carried::whole);
        EXPECT_EQ(with(wanted + doubt - 1), Carried::unsure);
        EXPECT_EQ(with(wanted), Carried::unsure);
        EXPECT_EQ(with(wanted - 1), Carried::little);
    }
}

TEST(TreadBounds, a_tread_that_is_not_known_carries_nothing) {
    OnTreads on;
    on.map->height_tenth_mm.fill(0);
    const Findings findings = tread_findings(on, 0, Tread{});
    EXPECT_EQ(reasons_of(findings), std::set<Reason>{Reason::unknown_cells});
}

/// A line of the snapshot between two positions, both along and across a foot that faces +x, from
/// its middle [tenth_mm].
grid::SnapshotEdge line(const OnTreads& on,
                        std::int64_t from_along,
                        std::int64_t from_across,
                        std::int64_t to_along,
                        std::int64_t to_across) {
    const grid::FixedPoint middle = on.sweep.feet[0].landing_center;
    const auto x = [&](std::int64_t along) {
        return static_cast<std::int32_t>(middle.x + along - on.map->origin_x_tenth_mm);
    };
    const auto y = [&](std::int64_t across) {
        return static_cast<std::int32_t>(middle.y + across - on.map->origin_y_tenth_mm);
    };
    grid::SnapshotEdge edge;
    edge.from_x_tenth_mm = x(from_along);
    edge.from_y_tenth_mm = y(from_across);
    edge.to_x_tenth_mm = x(to_along);
    edge.to_y_tenth_mm = y(to_across);
    edge.lower_tenth_mm = -1500;
    return edge;
}

/// The certainly supported length of a foot, as stated by its refusal [doubled tenth_mm].
std::int64_t carried(const OnTreads& on, const Tread& tread) {
    const Findings findings = tread_findings(on, 0, tread);
    const Finding* worst = findings.worst(Reason::edge_margin);
    return worst == nullptr ? -1 : 2 * worst->value_tenth_mm;
}

/// The tread seems to end 100 tenth_mm before the toes; with 600 more it is too short.
struct Nosing {
    OnTreads on;
    Tread tread{true, 0, kNone, kNone, 0};
    std::int64_t length = 3660;

    explicit Nosing(bool at_toe) {
        on.map->height_tenth_mm.fill(0);
        on.machine.limits.tread_share_permille = 970;  // 3550 of 3660
        on.machine.ankle_from_heel_tenth_mm = 1830;
        on.look();
        (at_toe ? tread.toe_edge : tread.heel_edge) = length - 200;
    }
    void set(const grid::SnapshotEdge& edge) {
        on.map->edges[0] = edge;
        on.map->edge_count = 1;
        on.look();
    }
    [[nodiscard]] std::int64_t with(const grid::SnapshotEdge& edge) {
        set(edge);
        return carried(on, tread);
    }
};

TEST(TreadBounds, a_line_takes_back_doubt_to_the_tenth_of_a_millimetre) {
    for (const bool at_toe : {true, false}) {
        Nosing n(at_toe);
        const std::int64_t way = at_toe ? 1 : -1;
        EXPECT_EQ(carried(n.on, n.tread), 2 * n.length - 200 - 500 - 2);
        // 1630 along, a line whose only uncertainty is rounding; lower ground on its right.
        const auto at = [&](std::int64_t right_along, std::int64_t left_along, std::int64_t wide) {
            return at_toe ? line(n.on, right_along, -wide, left_along, wide)
                          : line(n.on, left_along, wide, right_along, -wide);
        };
        const auto straight = at(way * 1630, way * 1630, 2000);
        const std::int64_t with_line = n.length + 2 * 1630 - 2 - 2;
        EXPECT_EQ(n.with(straight), with_line);
        // A line that just spans the foot, and one that does not.
        EXPECT_EQ(n.with(at(way * 1630, way * 1630, 950)), with_line);
        const std::int64_t without = 2 * n.length - 200 - 500 - 2;
        auto shorter = at(way * 1630, way * 1630, 950);
        shorter.from_y_tenth_mm += at_toe ? 1 : -1;
        EXPECT_EQ(n.with(shorter), without);
        shorter = at(way * 1630, way * 1630, 950);
        shorter.to_y_tenth_mm += at_toe ? -1 : 1;
        EXPECT_EQ(n.with(shorter), without);
        // Slanted: where it crosses the nearer side of the foot, 950 of 2000 across.
        EXPECT_EQ(n.with(at(way * 1670, way * 1590, 2000)), n.length + 2 * 1611 - 4);
        EXPECT_EQ(n.with(at(way * 1590, way * 1670, 2000)), n.length + 2 * 1611 - 4);
        // Adds its sigma, times 3.4 and rounded up, on both sides.
        auto unsure = straight;
        unsure.across_sigma_tenth_mm = 10;
        EXPECT_EQ(n.with(unsure), with_line - 2 * 34);
        unsure.across_sigma_tenth_mm = 1'000;  // larger than a cell: the cell's value counts
        EXPECT_EQ(n.with(unsure), without);
        // Farther out than the cells: the cells decide.
        EXPECT_EQ(n.with(at(way * 1800, way * 1800, 2000)), -1);
        n.tread.drift_tenth_mm = 30;
        EXPECT_EQ(n.with(at(way * 1800, way * 1800, 2000)), 2 * n.length - 200 - 2 * 103);
        n.tread.drift_tenth_mm = 0;
    }
}

TEST(TreadBounds, a_line_is_this_nosing_at_its_height_and_with_a_drop_alone) {
    Nosing n(true);
    const std::int64_t without = carried(n.on, n.tread);
    const grid::SnapshotEdge straight = line(n.on, 1630, -2000, 1630, 2000);
    const std::int64_t with_line = n.with(straight);
    ASSERT_GT(with_line, without);
    const auto changed = [&](auto&& change) {
        grid::SnapshotEdge edge = straight;
        change(edge);
        return n.with(edge);
    };
    EXPECT_EQ(changed([](auto& e) { e.upper_tenth_mm = 250; }), with_line);
    EXPECT_EQ(changed([](auto& e) { e.upper_tenth_mm = 251; }), without);
    EXPECT_EQ(changed([](auto& e) { e.upper_tenth_mm = -250; }), with_line);
    EXPECT_EQ(changed([](auto& e) { e.upper_tenth_mm = -251; }), without);
    EXPECT_EQ(changed([](auto& e) { e.lower_tenth_mm = -501; }), with_line);
    EXPECT_EQ(changed([](auto& e) { e.lower_tenth_mm = -500; }), without);
    n.tread.rise_tenth_mm = 1500;
    n.on.query.stance_height_tenth_mm = 70;
    n.on.map->height_tenth_mm.fill(1570);
    EXPECT_EQ(changed([](auto&) {}), without);
    EXPECT_EQ(changed([](auto& e) { e.upper_tenth_mm = 1570 + 250; }), with_line);
    EXPECT_EQ(changed([](auto& e) { e.upper_tenth_mm = 1570 + 251; }), without);
}

TEST(TreadBounds, the_ends_of_a_line_lie_within_a_hundred_metres) {
    Nosing n(true);
    const std::int64_t without = carried(n.on, n.tread);
    constexpr std::int32_t kFarthest = 1'000'000;
    const auto ends = [&](std::int32_t from_y, std::int32_t to_y) {
        grid::SnapshotEdge edge = line(n.on, 1630, -2000, 1630, 2000);
        edge.from_y_tenth_mm = from_y;
        edge.to_y_tenth_mm = to_y;
        return n.with(edge);
    };
    EXPECT_GT(ends(-kFarthest, kFarthest), without);
    EXPECT_EQ(ends(-kFarthest - 1, kFarthest), without);
    EXPECT_EQ(ends(-kFarthest, kFarthest + 1), without);
    // Along the foot: such a slanted line passes the same position on both sides of the foot.
    const auto along = [&](std::int32_t from_x, std::int32_t to_x) {
        grid::SnapshotEdge edge = line(n.on, 1630, -2000, 1630, 2000);
        edge.across_sigma_tenth_mm = 0;
        edge.from_x_tenth_mm = from_x;
        edge.to_x_tenth_mm = to_x;
        n.set(edge);
        return answer_of(tread_findings(n.on, 0, n.tread));
    };
    // Beyond the toes on both sides only if both ends are: such a line removes all uncertainty.
    EXPECT_EQ(along(kFarthest, kFarthest), Carried::whole);
    EXPECT_EQ(along(kFarthest + 1, kFarthest), Carried::unsure);
    EXPECT_EQ(along(kFarthest, kFarthest + 1), Carried::unsure);
    grid::SnapshotEdge edge = line(n.on, 1630, -2000, 1630, 2000);
    edge.across_sigma_tenth_mm = -1;
    EXPECT_EQ(n.with(edge), without);
}

TEST(TreadBounds, of_two_lines_the_nearer_counts) {
    Nosing n(true);
    for (const bool first_is_nearer : {true, false}) {
        n.set(line(n.on, 1630, -2000, 1630, 2000));
        const std::int64_t nearer = carried(n.on, n.tread);
        n.on.map->edges[0] =
            line(n.on, first_is_nearer ? 1630 : 1640, -2000, first_is_nearer ? 1630 : 1640, 2000);
        n.on.map->edges[1] =
            line(n.on, first_is_nearer ? 1640 : 1630, -2000, first_is_nearer ? 1640 : 1630, 2000);
        n.on.map->edge_count = 2;
        n.on.look();
        EXPECT_EQ(carried(n.on, n.tread), nearer);
    }
}

/// The supported part is tested like a foot of that size: a bump counts from its first cell on.
TEST(TreadBounds, the_carried_part_of_a_foot_is_judged_and_nothing_else) {
    Rng rng(94);
    OnTreads on;
    for (int round = 0; round < 100; ++round) {
        on.place_anywhere(rng);
        on.machine.limits.tread_share_permille = 600;
        on.machine.limits.tread_overhang_tenth_mm = 3000;
        on.machine.ankle_from_heel_tenth_mm = 1830;
        on.machine.limits.patch_side_tenth_mm = 300;
        on.look();
        const std::size_t foot = rng.below(2);
        on.map->height_tenth_mm.fill(0);
        Tread tread{true, 0, kNone, kNone, 0};
        const bool at_toe = rng.below(2) == 0;
        (at_toe ? tread.toe_edge : tread.heel_edge) =
            1500 + static_cast<std::int64_t>(rng.below(1500));
        const PlainCarried plain(on, foot, tread);
        if (plain.answer != Carried::whole) continue;
        GroundBox part = on.box(foot);
        part.center_x_tenth_mm += static_cast<std::int32_t>((plain.sure_toe - plain.sure_heel) / 4);
        part.length_tenth_mm = static_cast<std::int32_t>((plain.sure_toe + plain.sure_heel) / 2);
        Machine with_part = on.machine;
        (foot == 0 ? with_part.left_foot : with_part.right_foot) = part;
        const Sweep sweep = sweep_of(
            with_part,
            fixed_pose(
                on.query.x_tenth_mm, on.query.y_tenth_mm, on.query.cos_yaw, on.query.sin_yaw),
            with_part.movements[kForward]);
        std::set<std::size_t> below;
        on.each_cell(sweep.feet[foot].landing,
                     [&](std::int64_t ix, std::int64_t iy) { below.insert(on.index(ix, iy)); });
        on.each_cell(on.sweep.feet[foot].band, [&](std::int64_t ix, std::int64_t iy) {
            const std::size_t at = on.index(ix, iy);
            on.map->source[at] = grid::EvidenceSource::unknown;
            const bool judged =
                tread_findings(on, foot, tread).reasons().contains(Reason::unknown_cells);
            EXPECT_EQ(judged, below.contains(at)) << "round " << round;
            on.map->source[at] = grid::EvidenceSource::measured;
        });
    }
}

TEST(TreadBounds, a_lowered_body_passes_what_is_just_as_high_as_it_begins) {
    OnTreads on;
    on.map->height_tenth_mm.fill(0);
    Treads treads{Tread{true, -1500, kNone, kNone, 0}, Tread{true, -1400, kNone, kNone, 0}};
    on.machine.body.parts[0] = {{0, 0, 6600, 6450}, 1500, 20'500};
    on.query.stance_height_tenth_mm = 30;
    on.map->height_tenth_mm.fill(30);
    const auto said = [&] {
        Findings findings;
        check_body_lowered(on.scene(), treads, findings);
        return findings.reasons().contains(Reason::body_clearance);
    };
    EXPECT_FALSE(said());  // 1500 over the lower tread
    treads[0].rise_tenth_mm = -1501;
    EXPECT_TRUE(said());
    std::swap(treads[0], treads[1]);  // the lower one counts
    EXPECT_TRUE(said());
    // Level or up: the path of the body was tested before.
    on.map->height_tenth_mm.fill(5000);
    treads = {};
    EXPECT_FALSE(said());
    treads[0].rise_tenth_mm = treads[1].rise_tenth_mm = -1;
    EXPECT_TRUE(said());
}

TEST(TreadBounds, a_lowered_body_asks_the_cells_below_its_parts_with_sway_and_a_cell) {
    Rng rng(95);
    OnTreads on;
    const Treads treads{Tread{true, -1500, kNone, kNone, 0}, Tread{true, -1500, kNone, kNone, 0}};
    on.machine.body.parts[0] = {{701, 2303, 3001, 2803}, 1600, 6100};
    on.machine.body.parts[1] = {{-100, 0, 7200, 401}, 1600, 20'500};
    on.machine.body.count = 2;
    on.machine.body.sway_tenth_mm = 200;
    on.map->height_tenth_mm.fill(0);
    for (int round = 0; round < 10; ++round) {
        on.place_anywhere(rng);
        std::set<std::size_t> wanted;
        for (const BodyPart& part : on.machine.body.all()) {
            // The box, wider by half a tenth of a millimetre where its size is odd.
            std::array<grid::FixedPoint, 4> corners;
            for (std::size_t i = 0; i < 4; ++i) {
                const auto half = [](std::int32_t size) { return size / 2 + size % 2 + 450; };
                const std::int64_t x = half(part.box.length_tenth_mm) * (i % 2 == 0 ? 1 : -1);
                const std::int64_t y = half(part.box.width_tenth_mm) * (i < 2 ? 1 : -1);
                corners[i] = to_odom(on.sweep.target,
                                     part.box.center_x_tenth_mm + x,
                                     part.box.center_y_tenth_mm + y);
            }
            on.each_cell(grid::convex_hull(corners), [&](std::int64_t ix, std::int64_t iy) {
                wanted.insert(on.index(ix, iy));
            });
        }
        const std::int64_t reach = 40;
        const std::int64_t cx = (on.sweep.target.position.x - on.map->origin_x_tenth_mm) / 250;
        const std::int64_t cy = (on.sweep.target.position.y - on.map->origin_y_tenth_mm) / 250;
        for (std::int64_t iy = cy - reach; iy <= cy + reach; ++iy) {
            for (std::int64_t ix = cx - reach; ix <= cx + reach; ++ix) {
                const std::size_t at = on.index(ix, iy);
                on.map->height_tenth_mm[at] = 101;  // one unit above the lower edge of the part
                Findings findings;
                check_body_lowered(on.scene(), treads, findings);
                const Finding* worst = findings.worst(Reason::body_clearance);
                ASSERT_EQ(worst != nullptr, wanted.contains(at)) << round << " " << ix << " " << iy;
                if (worst != nullptr) {
                    ASSERT_EQ(worst->cell_x, ix);
                    ASSERT_EQ(worst->cell_y, iy);
                    ASSERT_EQ(worst->foot, Foot::none);
                    ASSERT_EQ(worst->value_tenth_mm, 1601);
                    ASSERT_EQ(worst->limit_tenth_mm, 1600);
                    ASSERT_FALSE(worst->overhead);
                }
                on.map->height_tenth_mm[at] = 0;
            }
        }
    }
    // Unknown cells report nothing.
    on.map->source.fill(grid::EvidenceSource::unknown);
    on.map->height_tenth_mm.fill(5000);
    Findings findings;
    check_body_lowered(on.scene(), treads, findings);
    EXPECT_TRUE(findings.reasons().empty());
}

TEST(TreadBounds, a_body_is_lifted_by_the_higher_tread_and_never_lowered) {
    const auto lift = [](std::int64_t left, std::int64_t right) {
        Treads treads;
        treads[0].rise_tenth_mm = left;
        treads[1].rise_tenth_mm = right;
        return lift_of(treads);
    };
    EXPECT_EQ(lift(0, 0), 0);
    EXPECT_EQ(lift(1500, 1480), 1500);
    EXPECT_EQ(lift(1, 20), 20);
    EXPECT_EQ(lift(-1500, -1), 0);
    EXPECT_EQ(lift(-1500, 1), 1);
}

/// Two surfaces in the path of a foot: 1 is the present one, 2 begins `gap` cells beyond a strip of
/// 3.
struct Surfaces {
    OnTreads on;
    std::int64_t row = 0;
    std::int64_t column = 0;

    explicit Surfaces(double yaw_rad) {
        on.place(0, 0, yaw_rad);
        on.map->height_tenth_mm.fill(0);
        on.map->component.fill(0);
        const grid::FixedPoint middle = on.sweep.feet[0].landing_center;
        column = (middle.x - on.map->origin_x_tenth_mm) / 250;
        row = (middle.y - on.map->origin_y_tenth_mm) / 250;
    }
    void set(std::int64_t ix, std::int64_t iy, std::uint16_t component, std::int32_t height) {
        on.map->component[on.index(ix, iy)] = component;
        on.map->height_tenth_mm[on.index(ix, iy)] = height;
    }
    [[nodiscard]] bool joins(std::uint16_t component = 2) const {
        ReachableSurfaces reachable;
        reachable.add(1);
        add_a_step_away(on.scene(), reachable);
        return reachable.contains(component);
    }
};

TEST(TreadBounds, a_surface_is_a_step_away_within_two_cells_and_as_high_as_the_class_steps) {
    for (const bool across : {false, true}) {
        for (const std::int64_t cells : {1, 2, 3}) {
            for (const std::int64_t way : {-1, 1}) {
                Surfaces s(0.0);
                const std::int64_t dx = across ? 0 : way * cells;
                const std::int64_t dy = across ? way * cells : 0;
                const auto joined = [&](std::int32_t height) {
                    s.set(s.column, s.row, 1, 70);
                    s.set(s.column + dx, s.row + dy, 2, 70 + height);
                    return s.joins();
                };
                EXPECT_EQ(joined(0), cells <= 2) << across << cells << way;
                EXPECT_EQ(joined(1800), cells <= 2);
                EXPECT_FALSE(joined(1801));
                EXPECT_EQ(joined(-1800), cells <= 2);
                EXPECT_FALSE(joined(-1801));
            }
        }
    }
}

TEST(TreadBounds, up_and_down_have_limits_of_their_own) {
    Surfaces s(0.0);
    s.on.machine.limits.step[1] = {true, 1000, 500};
    s.set(s.column, s.row, 1, 0);
    s.set(s.column + 1, s.row, 2, 1000);
    EXPECT_TRUE(s.joins());
    s.set(s.column + 1, s.row, 2, -600);
    EXPECT_FALSE(s.joins());
    s.set(s.column + 1, s.row, 2, -500);
    EXPECT_TRUE(s.joins());
    // From the other side of the border: the present surface is the second cell.
    s.set(s.column, s.row, 2, -500);
    s.set(s.column + 1, s.row, 1, 0);
    EXPECT_TRUE(s.joins());
    s.set(s.column, s.row, 2, -501);
    EXPECT_FALSE(s.joins());
    s.set(s.column, s.row, 2, 1000);
    EXPECT_TRUE(s.joins());
    s.set(s.column, s.row, 2, 1001);
    EXPECT_FALSE(s.joins());
}

TEST(TreadBounds, one_step_is_added_and_no_flight) {
    Surfaces s(0.0);
    s.set(s.column, s.row, 1, 0);
    s.set(s.column + 1, s.row, 2, 1500);
    s.set(s.column + 2, s.row, 3, 3000);
    EXPECT_TRUE(s.joins(2));
    EXPECT_FALSE(s.joins(3));
}

TEST(TreadBounds, only_measured_ground_in_the_way_of_a_foot_is_a_step_away) {
    Surfaces s(0.3);
    s.set(s.column, s.row, 1, 0);
    s.set(s.column + 1, s.row, 2, 0);
    ASSERT_TRUE(s.joins());
    s.on.map->source[s.on.index(s.column + 1, s.row)] = grid::EvidenceSource::unknown;
    EXPECT_FALSE(s.joins());
    s.on.map->source[s.on.index(s.column + 1, s.row)] = grid::EvidenceSource::measured;
    s.on.map->source[s.on.index(s.column, s.row)] = grid::EvidenceSource::unknown;
    EXPECT_FALSE(s.joins());
    s.on.map->source[s.on.index(s.column, s.row)] = grid::EvidenceSource::measured;
    // Every cell of the corridor: a pair counts if both cells lie in it.
    s.set(s.column, s.row, 0, 0);
    s.set(s.column + 1, s.row, 0, 0);
    std::set<std::size_t> way;
    s.on.each_cell(s.on.sweep.feet[0].corridor,
                   [&](std::int64_t ix, std::int64_t iy) { way.insert(s.on.index(ix, iy)); });
    std::set<std::size_t> other;
    s.on.each_cell(s.on.sweep.feet[1].corridor,
                   [&](std::int64_t ix, std::int64_t iy) { other.insert(s.on.index(ix, iy)); });
    for (std::int64_t iy = s.row - 15; iy <= s.row + 15; ++iy) {
        for (std::int64_t ix = s.column - 30; ix <= s.column + 15; ++ix) {
            for (const bool up : {false, true}) {
                const std::int64_t dx = up ? 0 : 1;
                const std::int64_t dy = up ? 1 : 0;
                const std::size_t a = s.on.index(ix, iy);
                const std::size_t b = s.on.index(ix + dx, iy + dy);
                s.set(ix, iy, 1, 0);
                s.set(ix + dx, iy + dy, 2, 0);
                EXPECT_EQ(s.joins(),
                          (way.contains(a) && way.contains(b)) ||
                              (other.contains(a) && other.contains(b)))
                    << ix << " " << iy;
                s.set(ix, iy, 0, 0);
                s.set(ix + dx, iy + dy, 0, 0);
            }
        }
    }
}

}  // namespace
}  // namespace surefoot::gate::testing
