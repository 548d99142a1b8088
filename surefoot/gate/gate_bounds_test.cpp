// SPDX-License-Identifier: Apache-2.0
// The bounds of the gate to the unit: allowed at a bound, refused beyond it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/findings.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

Verdict ask_at(const Query& query, const grid::MapSnapshot& map, std::int64_t now_ns = kNowNs) {
    return decide(rex(), query, map, kReady, now_ns);
}

/// A query on level ground with one number of it changed.
template <typename Change>
bool is_bad_number(const grid::MapSnapshot& map, Change&& change) {
    Query query = query_at_body(kForward, map);
    change(query);
    return ask_at(query, map).reasons.contains(Reason::bad_number);
}

TEST(GateBounds, places_are_within_100_km_and_heights_within_1_km) {
    Terrain floor;
    const auto map = floor.snapshot();
    struct Case {
        const char* name;
        std::int64_t bound;
        void (*set)(Query&, std::int64_t);
    };
    const Case cases[] = {
        {"x", 1'000'000'000, [](Query& q, std::int64_t v) { q.x_tenth_mm = v; }},
        {"y", 1'000'000'000, [](Query& q, std::int64_t v) { q.y_tenth_mm = v; }},
        {"height of the stance",
         10'000'000,
         [](Query& q, std::int64_t v) {
             q.stance_source = StanceHeight::given;
             q.stance_height_tenth_mm = static_cast<std::int32_t>(v);
         }},
        {"x of the attested area",
         1'000'000'000,
         [](Query& q, std::int64_t v) {
             q.attested = {true, v, 0, 100, 0};
         }},
        {"y of the attested area",
         1'000'000'000,
         [](Query& q, std::int64_t v) {
             q.attested = {true, 0, v, 100, 0};
         }},
        {"height of the attested area",
         10'000'000,
         [](Query& q, std::int64_t v) {
             q.attested = {true, 0, 0, 100, static_cast<std::int32_t>(v)};
         }},
    };
    for (const Case& c : cases) {
        for (const std::int64_t sign : {1, -1}) {
            const auto refused = [&](std::int64_t value) {
                return is_bad_number(*map, [&](Query& q) { c.set(q, sign * value); });
            };
            EXPECT_FALSE(refused(c.bound)) << c.name << " " << sign;
            EXPECT_TRUE(refused(c.bound + 1)) << c.name << " " << sign;
        }
    }
}

TEST(GateBounds, an_attested_area_has_a_radius_up_to_the_limit_of_the_machine) {
    Terrain floor;
    const auto map = floor.snapshot();
    const auto refused = [&](std::int32_t radius, bool active = true) {
        return is_bad_number(*map, [&](Query& q) { q.attested = {active, 0, 0, radius, 0}; });
    };
    EXPECT_TRUE(refused(0));
    EXPECT_FALSE(refused(1));
    EXPECT_FALSE(refused(10'000));
    EXPECT_TRUE(refused(10'001));
    EXPECT_FALSE(refused(10'001, false)) << "no attestation is active";
}

TEST(GateBounds, the_length_of_a_heading_is_one_to_a_two_thousandth) {
    Terrain floor;
    const auto map = floor.snapshot();
    const auto refused = [&](double cos_yaw, double sin_yaw) {
        return is_bad_number(*map, [&](Query& q) {
            q.cos_yaw = cos_yaw;
            q.sin_yaw = sin_yaw;
        });
    };
    // Squared 0.999 and 1.001, to the last bit.
    constexpr double kShort = 0.9994998749374608;
    constexpr double kRest = 1.05e-8;
    ASSERT_EQ(kShort * kShort + kRest * kRest, 0.999);
    constexpr double kLong = 1.000499875062461;
    ASSERT_EQ(kLong * kLong, 1.001);
    EXPECT_TRUE(refused(kShort, kRest));
    EXPECT_FALSE(refused(kShort, 2.0 * kRest));
    EXPECT_TRUE(refused(kLong, 0.0));
    EXPECT_FALSE(refused(std::nextafter(kLong, 0.0), 0.0));
    EXPECT_FALSE(refused(0.0, -1.0));
}

TEST(GateBounds, a_steady_clock_is_neither_negative_nor_half_way_to_its_end) {
    constexpr std::int64_t kHalf = std::numeric_limits<std::int64_t>::max() / 2;
    Terrain floor;
    const auto map = floor.snapshot();
    const Query query = query_at_body(kForward, *map);
    const auto reasons_at = [&](std::int64_t now_ns) {
        map->frame_time_ns = map->pose_time_ns = now_ns;
        seal(*map);
        return ask_at(query, *map, now_ns).reasons;
    };
    EXPECT_TRUE(reasons_at(0).empty());
    EXPECT_TRUE(reasons_at(kHalf).empty());
    EXPECT_EQ(reasons_at(-1), ReasonSet(Reason::clock));
    EXPECT_EQ(reasons_at(kHalf + 1), ReasonSet(Reason::clock));
}

TEST(GateBounds, a_fault_that_has_no_name_is_an_internal_error) {
    Terrain floor;
    const auto map = floor.snapshot();
    const GateHealth health{GateState::ready, ReasonSet(static_cast<Reason>(kReasonCount + 1))};
    ASSERT_FALSE(health.faults.empty());
    const Verdict verdict = decide(rex(), query_at_body(kForward, *map), *map, health, kNowNs);
    EXPECT_EQ(verdict.reasons, ReasonSet(Reason::internal)) << words(verdict);
    EXPECT_EQ(verdict.decision, Decision::error);
}

TEST(GateBounds, a_class_that_the_limits_do_not_know_has_no_movements) {
    Terrain floor;
    const auto map = floor.snapshot();
    for (const int movement_class : {kMovementClassCount, 255}) {
        Machine machine = rex();
        machine.movements[kForward].movement_class = static_cast<MovementClass>(movement_class);
        const Verdict verdict =
            decide(machine, query_at_body(kForward, *map), *map, kReady, kNowNs);
        EXPECT_TRUE(verdict.reasons.contains(Reason::unknown_command)) << words(verdict);
        EXPECT_EQ(verdict.decision, Decision::error);
    }
}

TEST(GateBounds, coordinates_in_metres_are_rounded_to_the_nearest_tenth_of_a_millimetre) {
    struct Case {
        double m;
        std::int64_t tenth_mm;
    };
    const Case cases[] = {{1.23454, 12345},
                          {1.23456, 12346},
                          {-1.23454, -12345},
                          {-1.23456, -12346},
                          {0.00004, 0},
                          {-0.00004, 0},
                          {0.00006, 1},
                          {-0.00006, -1},
                          {0.0, 0},
                          {1e5, 1'000'000'000},
                          {-1e5, -1'000'000'000}};
    for (const Case& c : cases) {
        EXPECT_EQ(make_query(kForward, c.m, 0.0, 1.0, 0.0).x_tenth_mm, c.tenth_mm) << c.m;
        EXPECT_EQ(make_query(kForward, 0.0, c.m, 1.0, 0.0).y_tenth_mm, c.tenth_mm) << c.m;
        EXPECT_EQ(make_query(kForward, 0.0, c.m, 0.6, 0.8).cos_yaw, 0.6);
        EXPECT_EQ(make_query(kForward, c.m, 0.0, 0.6, 0.8).sin_yaw, 0.8);
    }
    for (const double far_m : {1.00001e5, -1.00001e5}) {  // such a pose is invalid
        for (const Query& query : {make_query(kForward, far_m, 0.0, 1.0, 0.0),
                                   make_query(kForward, 0.0, far_m, 1.0, 0.0)}) {
            EXPECT_EQ(query.command, kForward);
            EXPECT_EQ(query.x_tenth_mm, 0);
            EXPECT_EQ(query.y_tenth_mm, 0);
            EXPECT_EQ(query.cos_yaw, 0.0);
        }
    }
}

TEST(GateBounds, a_query_at_the_body_has_its_place_and_heading) {
    Terrain floor;
    const auto map = floor.snapshot();
    map->body_x_tenth_mm = 11;
    map->body_y_tenth_mm = -22;
    map->body_cos_yaw = 0.6;
    map->body_sin_yaw = -0.8;
    const Query query = query_at_body(kLeft, *map);
    EXPECT_EQ(query.command, kLeft);
    EXPECT_EQ(query.x_tenth_mm, 11);
    EXPECT_EQ(query.y_tenth_mm, -22);
    EXPECT_EQ(query.cos_yaw, 0.6);
    EXPECT_EQ(query.sin_yaw, -0.8);
    EXPECT_EQ(query.stance_source, StanceHeight::map);
    EXPECT_FALSE(query.attested.active);
}

TEST(GateBounds, a_verdict_says_which_question_on_which_map_it_answers) {
    Terrain floor;
    floor.height.fill(0.05F);
    const auto map = floor.snapshot();
    Query query = query_at_body(kLeft, *map);
    query.connection = 77;
    query.sequence = 88;
    const Verdict verdict = ask_at(query, *map);
    EXPECT_EQ(verdict.command, kLeft);
    EXPECT_EQ(verdict.connection, 77U);
    EXPECT_EQ(verdict.sequence, 88U);
    EXPECT_EQ(verdict.map_version, 42U);
    EXPECT_EQ(verdict.config_hash, 4711U);
    EXPECT_EQ(verdict.frame_time_ns, kNowNs - 50 * kMs);
    EXPECT_EQ(verdict.pose_time_ns, kNowNs - 10 * kMs);
    EXPECT_EQ(verdict.decided_ns, kNowNs);
    EXPECT_EQ(verdict.evidence.unproven, 0U);
    EXPECT_TRUE(verdict.evidence.stance_known);
    EXPECT_EQ(verdict.evidence.stance_height_tenth_mm, 500);
}

TEST(GateBounds, a_refusal_says_what_was_not_proven_and_lives_for_nothing) {
    Terrain hole;
    hole.box(0.4, 0.5, -0.2, -0.1, -0.3);
    const Verdict verdict = ask(hole, kForward);
    EXPECT_EQ(verdict.valid_until_ns, 0);
    EXPECT_TRUE(verdict.evidence.lacks(Proof::bands_solid));
    EXPECT_TRUE(verdict.evidence.lacks(Proof::right_supported));
    EXPECT_FALSE(verdict.evidence.lacks(Proof::left_supported));
    EXPECT_FALSE(verdict.evidence.lacks(Proof::corridors_clear));
    Terrain nothing;
    nothing.height.fill(kNanF);
    const Verdict blind = ask(nothing, kForward);
    EXPECT_FALSE(blind.evidence.stance_known);
    EXPECT_EQ(blind.evidence.stance_height_tenth_mm, 0);
    EXPECT_TRUE(blind.evidence.lacks(Proof::stance_known));
    EXPECT_EQ(blind.reasons, ReasonSet(Reason::unknown_cells)) << words(blind);
}

TEST(GateBounds, where_no_ground_is_known_under_the_feet_the_rest_is_not_asked) {
    Terrain blind;  // the wall behind would stop a step backwards
    blind.box(-0.2, 0.4, -0.5, 0.5, static_cast<double>(kNanF));
    blind.box(-0.6, -0.5, -0.5, 0.5, 0.7);
    const Verdict verdict = ask(blind, kBackward);
    EXPECT_EQ(verdict.reasons, ReasonSet(Reason::unknown_cells)) << words(verdict);
}

TEST(Findings, a_reason_that_is_none_or_unknown_has_no_place) {
    Findings findings;
    for (const Reason reason : {Reason::none, static_cast<Reason>(kReasonCount + 1)}) {
        findings.deny(reason, {-1, -1, -1, -1, -1, Foot::left, true});
        EXPECT_EQ(findings.worst(reason), nullptr);
    }
    for (int i = 0; i < kReasonCount; ++i)
        EXPECT_EQ(findings.worst(static_cast<Reason>(i)), nullptr) << i;
}

TEST(Findings, the_place_is_the_middle_of_the_cell_and_everything_goes_with_it) {
    Terrain floor;
    const auto map = floor.snapshot();
    Findings findings;
    findings.deny(Reason::slope, {3, 5, 70, 60, 50, Foot::right, true});
    Evidence evidence;
    show_worst_cell(*map, findings, Reason::drop_off, evidence);
    EXPECT_FALSE(evidence.has_worst_cell) << "that was not denied";
    show_worst_cell(*map, findings, Reason::slope, evidence);
    EXPECT_TRUE(evidence.has_worst_cell);
    EXPECT_EQ(evidence.worst_x_tenth_mm, -30'000 + 3 * 250 + 125);
    EXPECT_EQ(evidence.worst_y_tenth_mm, -30'000 + 5 * 250 + 125);
    EXPECT_EQ(evidence.foot, Foot::right);
    EXPECT_TRUE(evidence.overhead);
    EXPECT_EQ(evidence.value_tenth_mm, 70);
    EXPECT_EQ(evidence.limit_tenth_mm, 60);
}

}  // namespace
}  // namespace surefoot::gate::testing
