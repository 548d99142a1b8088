// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/verdict_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

/// A refusal without a cell.
Verdict refusal(Reason reason, std::int64_t value_tenth_mm = 0, std::int64_t limit_tenth_mm = 0) {
    Verdict verdict;
    verdict.decision = Decision::not_traversable;
    verdict.primary = reason;
    verdict.evidence.value_tenth_mm = value_tenth_mm;
    verdict.evidence.limit_tenth_mm = limit_tenth_mm;
    return verdict;
}
Query standing_at(std::int64_t x_tenth_mm,
                  std::int64_t y_tenth_mm,
                  double cos_yaw,
                  double sin_yaw) {
    Query query;
    query.x_tenth_mm = x_tenth_mm;
    query.y_tenth_mm = y_tenth_mm;
    query.cos_yaw = cos_yaw;
    query.sin_yaw = sin_yaw;
    return query;
}

/// The position part of the sentence, which follows the reason.
std::string place_of(std::int64_t x_tenth_mm,
                     std::int64_t y_tenth_mm,
                     Foot foot,
                     const Query& query = standing_at(0, 0, 1.0, 0.0),
                     const Machine& machine = rex()) {
    Verdict verdict = refusal(Reason::unknown_cells);
    verdict.evidence.has_worst_cell = true;
    verdict.evidence.worst_x_tenth_mm = x_tenth_mm;
    verdict.evidence.worst_y_tenth_mm = y_tenth_mm;
    verdict.evidence.foot = foot;
    const std::string text = text_of(verdict, query, machine);
    const std::string reason = "ground that was never seen, ";
    EXPECT_EQ(text.substr(0, reason.size()), reason);
    return text.substr(std::min(text.size(), reason.size()));
}

TEST(VerdictText, a_place_is_told_from_the_nearer_foot_or_the_one_it_is_about) {
    // The left foot: 0.126 m back to 0.240 m ahead, 0.085 to 0.275 m left; the right one mirrored.
    EXPECT_EQ(place_of(570, 1800, Foot::left), "under the left foot");
    EXPECT_EQ(place_of(570, -1800, Foot::right), "under the right foot");
    EXPECT_EQ(place_of(5500, 1800, Foot::left), "0.31 m ahead of the left foot");
    EXPECT_EQ(place_of(-4360, 1800, Foot::left), "0.31 m behind the left foot");
    EXPECT_EQ(place_of(570, 4750, Foot::left), "0.20 m left of the left foot");
    EXPECT_EQ(place_of(570, -4750, Foot::right), "0.20 m right of the right foot");
    EXPECT_EQ(place_of(570, 1800, Foot::right), "0.27 m left of the right foot");
    EXPECT_EQ(place_of(570, -1800, Foot::left), "0.27 m right of the left foot");
    EXPECT_EQ(place_of(5500, 10, Foot::none), "0.31 m ahead of the left foot");
    EXPECT_EQ(place_of(5500, 0, Foot::none), "0.31 m ahead of the left foot");
    EXPECT_EQ(place_of(5500, -10, Foot::none), "0.31 m ahead of the right foot");
    EXPECT_EQ(place_of(5500, -10, Foot::left), "0.31 m ahead of the left foot");
    EXPECT_EQ(place_of(5500, 10, Foot::right), "0.31 m ahead of the right foot");
}

TEST(VerdictText, what_would_be_0_00_m_away_is_under_the_foot) {
    EXPECT_EQ(place_of(2449, 1800, Foot::left), "under the left foot");
    EXPECT_EQ(place_of(2451, 1800, Foot::left), "0.01 m ahead of the left foot");
    EXPECT_EQ(place_of(-1309, 1800, Foot::left), "under the left foot");
    EXPECT_EQ(place_of(-1311, 1800, Foot::left), "0.01 m behind the left foot");
    EXPECT_EQ(place_of(570, 2799, Foot::left), "under the left foot");
    EXPECT_EQ(place_of(570, 2801, Foot::left), "0.01 m left of the left foot");
    EXPECT_EQ(place_of(570, 801, Foot::left), "under the left foot");
    EXPECT_EQ(place_of(570, 799, Foot::left), "0.01 m right of the left foot");
}

TEST(VerdictText, half_a_centimetre_is_told) {
    Machine small = rex();  // 0.01 - 0.005 = 0.005, to the last bit
    small.left_foot = {0, 0, 100, 100};
    const auto place = [&](std::int64_t x, std::int64_t y) {
        return place_of(x, y, Foot::left, standing_at(0, 0, 1.0, 0.0), small);
    };
    EXPECT_EQ(place(100, 0), "0.01 m ahead of the left foot");
    EXPECT_EQ(place(0, 100), "0.01 m left of the left foot");
    EXPECT_EQ(place(-100, 0), "0.01 m behind the left foot");
    EXPECT_EQ(place(99, 99), "under the left foot");
}

TEST(VerdictText, of_two_distances_the_greater_is_told_and_ahead_when_they_are_equal) {
    Machine square = rex();
    square.left_foot = square.right_foot = {0, 0, 10'000, 10'000};
    const auto place = [&](std::int64_t x, std::int64_t y) {
        return place_of(x, y, Foot::left, standing_at(0, 0, 1.0, 0.0), square);
    };
    EXPECT_EQ(place(10'000, 10'000), "0.50 m ahead of the left foot");
    EXPECT_EQ(place(-10'000, 10'000), "0.50 m behind the left foot");
    EXPECT_EQ(place(10'000, 15'000), "1.00 m left of the left foot");
    EXPECT_EQ(place(15'000, 10'000), "1.00 m ahead of the left foot");
    EXPECT_EQ(place(10'000, -15'000), "1.00 m right of the left foot");
    EXPECT_EQ(place(-15'000, -10'000), "1.00 m behind the left foot");
}

TEST(VerdictText, a_place_is_seen_from_where_the_machine_stands_and_looks) {
    // From (1 m, 2 m), heading (0.6, 0.8): 0.74 m forward and 0.18 m left is (1.300, 2.700).
    const Query query = standing_at(10'000, 20'000, 0.6, 0.8);
    EXPECT_EQ(place_of(13'000, 27'000, Foot::left, query), "0.50 m ahead of the left foot");
    // 0.057 m forward and 0.775 m left.
    EXPECT_EQ(place_of(4'142, 25'106, Foot::left, query), "0.50 m left of the left foot");
    // 0.126 + 0.5 m back and 0.18 m right.
    EXPECT_EQ(place_of(7'684, 13'912, Foot::none, query), "0.50 m behind the right foot");
}

TEST(VerdictText, lengths_below_a_tenth_of_a_metre_are_told_to_the_millimetre) {
    const auto drop = [](std::int64_t value) {
        return text_of(refusal(Reason::drop_off, value, 500), Query{}, rex());
    };
    EXPECT_EQ(drop(994), "drop of 0.099 m (limit 0.050 m)");
    EXPECT_EQ(drop(995), "drop of 0.10 m (limit 0.050 m)");
    EXPECT_EQ(drop(1), "drop of 0.000 m (limit 0.050 m)");
    EXPECT_EQ(drop(17'000), "drop of 1.70 m (limit 0.050 m)");
    EXPECT_EQ(drop(-2'000), "drop of -0.20 m (limit 0.050 m)");
    EXPECT_EQ(drop(0), "edge of a drop");
}

TEST(VerdictText, every_refusal_says_its_own_numbers) {
    struct Case {
        Reason reason;
        bool overhead;
        const char* text;
    };
    const Case cases[] = {
        {Reason::outside_map, false, "the step leaves the map"},
        {Reason::drop_off, false, "drop of 0.12 m (limit 0.034 m)"},
        {Reason::step_too_high, false, "step up of 0.12 m (limit 0.034 m)"},
        {Reason::step_too_low, false, "step down of 0.12 m (limit 0.034 m)"},
        {Reason::corridor_blocked,
         false,
         "something 0.12 m high in the way of the foot (limit 0.034 m)"},
        {Reason::corridor_blocked,
         true,
         "something that hangs 0.12 m high in the way of the foot (limit 0.034 m)"},
        {Reason::body_clearance,
         false,
         "something 0.12 m high in the way of the body (limit 0.034 m)"},
        {Reason::body_clearance,
         true,
         "only 0.12 m of room under something overhead (limit 0.034 m)"},
        {Reason::unknown_cells, false, "ground that was never seen"},
        {Reason::roughness, false, "ground uneven by 0.12 m (limit 0.034 m)"},
        {Reason::disconnected, false, "ground that is not connected with where you stand"},
        {Reason::memory_uncertain,
         false,
         "ground seen too far back to be sure where it is: drift 0.12 m (limit 0.034 m)"},
        {Reason::not_resolvable, false, "ground not seen well enough (limit 0.034 m)"},
        {Reason::none, false, "NONE"},  // impossible state; it must not permit a step
    };
    for (const Case& c : cases) {
        Verdict verdict = refusal(c.reason, 1200, 340);
        verdict.evidence.overhead = c.overhead;
        EXPECT_EQ(text_of(verdict, Query{}, rex()), c.text);
    }
}

TEST(VerdictText, a_slope_is_told_in_percent_beside_the_steepest_allowed) {
    Machine machine = rex();
    machine.limits.min_normal_z = 0.8;  // tan = 0.75
    const auto slope = [&](double tan_sq) {
        Verdict verdict = refusal(Reason::slope);
        verdict.evidence.max_tilt_tan_sq = tan_sq;
        return text_of(verdict, Query{}, machine);
    };
    EXPECT_EQ(slope(0.0225), "ground sloping 15.0 % (limit 75.0 %)");
    EXPECT_EQ(slope(4.0), "ground sloping 200.0 % (limit 75.0 %)");
    EXPECT_EQ(slope(1e6), "ground sloping 100000.0 % (limit 75.0 %)");
    EXPECT_EQ(slope(1.0), "ground sloping 100.0 % (limit 75.0 %)");
    EXPECT_EQ(slope(0.0), "ground sloping 0.0 % (limit 75.0 %)");
    EXPECT_EQ(slope(-1.0), "ground sloping 0.0 % (limit 75.0 %)");
    EXPECT_EQ(slope(std::nan("")), "ground sloping 0.0 % (limit 75.0 %)");
}

TEST(VerdictText, an_ok_and_an_error_have_no_place) {
    Verdict verdict;
    verdict.decision = Decision::ok;
    verdict.primary = Reason::none;
    EXPECT_EQ(text_of(verdict, Query{}, rex()), "the way is clear and the ground carries");
    verdict.decision = Decision::error;
    verdict.primary = Reason::frame_stale;
    verdict.evidence.has_worst_cell = true;
    EXPECT_EQ(text_of(verdict, Query{}, rex()), "the last camera image is too old");
    verdict.primary = Reason::internal;
    EXPECT_EQ(text_of(verdict, Query{}, rex()), "internal error: the map or the gate is damaged");
    verdict.primary = Reason::exposure;
    EXPECT_EQ(text_of(verdict, Query{}, rex()), "the image is too bright") << "dark is BLIND";
    verdict.primary = Reason::internal;
    verdict.decision = static_cast<Decision>(200);
    EXPECT_EQ(text_of(verdict, Query{}, rex()), "internal error: the map or the gate is damaged");
}

TEST(VerdictText, says_what_where_value_and_limit) {
    Terrain hole;
    hole.box(0.55, 0.60, 0.15, 0.20, -0.17);
    const auto map = hole.snapshot();
    const Query query = query_at_body(kForward, *map);
    const Verdict verdict = decide(rex(), query, *map, kReady, kNowNs);
    // The cell's centre at 0.5625 m, the toes at 0.240 m.
    EXPECT_EQ(text_of(verdict, query, rex()),
              "drop of 0.17 m, 0.32 m ahead of the left foot (limit 0.050 m)");
}

TEST(VerdictText, every_reason_has_a_sentence_and_a_code) {
    for (int i = 0; i < kReasonCount; ++i) {
        Verdict verdict;
        verdict.primary = static_cast<Reason>(i);
        verdict.decision = is_error(verdict.primary) ? Decision::error : Decision::not_traversable;
        const std::string text = text_of(verdict, Query{}, rex());
        EXPECT_GT(text.size(), 12U) << to_string(verdict.primary);
        EXPECT_NE(text, to_string(verdict.primary));
        for (int j = 0; j < i; ++j)
            EXPECT_STRNE(to_string(static_cast<Reason>(j)), to_string(verdict.primary));
    }
    EXPECT_STREQ(to_string(static_cast<Reason>(200)), "INTERNAL");
    EXPECT_STREQ(to_string(static_cast<Decision>(200)), "ERROR");
}

}  // namespace
}  // namespace surefoot::gate::testing
