// SPDX-License-Identifier: Apache-2.0
// The level of a tread and where it ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "surefoot/core/rng.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/tread_support.hpp"
#include "surefoot/gate/tread_testing.hpp"

namespace surefoot::gate::testing {
namespace {

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

}  // namespace
}  // namespace surefoot::gate::testing
