// SPDX-License-Identifier: Apache-2.0
// How much of a foot its tread supports.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>

#include "surefoot/core/rng.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/tread_support.hpp"
#include "surefoot/gate/tread_testing.hpp"

namespace surefoot::gate::testing {
namespace {

/// check_tread on even ground in plain code: the part that numbers alone decide.
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

}  // namespace
}  // namespace surefoot::gate::testing
