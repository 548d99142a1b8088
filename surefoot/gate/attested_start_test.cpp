// SPDX-License-Identifier: Apache-2.0
// The area that an operator attests at the start.
#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/verdict_testing.hpp"

namespace surefoot::gate::testing {
namespace {

struct AttestedStart : ::testing::Test {
    Terrain floor;
    Query query;
    std::unique_ptr<grid::MapSnapshot> map;

    /// Floor known from 0.6 m ahead on, as at start-up.
    void SetUp() override {
        floor.box(-3.0, 0.6, -3.0, 3.0, static_cast<double>(kNanF));
        rebuild();
        query = query_at_body(kForward, *map);
        query.attested = {true, 0, 0, 8500, 0};
    }
    void rebuild() { map = floor.snapshot(); }
    [[nodiscard]] Verdict ask_now() const { return decide(rex(), query, *map, kReady, kNowNs); }
};

TEST_F(AttestedStart, is_off_by_default_and_the_first_step_is_then_refused) {
    query.attested.active = false;
    expect_refused(ask_now(), Reason::unknown_cells);
}

TEST_F(AttestedStart, lets_the_first_step_go_onto_remembered_floor_and_says_so) {
    const Verdict verdict = ask_now();
    expect_ok(verdict);
    EXPECT_GT(verdict.evidence.attested_cells, 0);
    EXPECT_LT(verdict.evidence.attested_cells, verdict.evidence.known_cells);
}

TEST_F(AttestedStart, is_void_outside_and_too_small_where_it_does_not_reach) {
    // All unknown ground lies in the area, but base_link has just left it.
    Terrain spot;
    spot.box(-0.12, -0.05, 0.12, 0.17, static_cast<double>(kNanF));
    map = spot.snapshot();
    query.attested = {true, -6000, 0, 6000, 0};
    expect_ok(ask_now());
    query.attested = {true, -6001, 0, 6000, 0};
    expect_refused(ask_now(), Reason::unknown_cells);
    rebuild();
    query.attested = {true, 0, 0, 3000, 0};
    expect_refused(ask_now(), Reason::unknown_cells);
}

TEST_F(AttestedStart, never_covers_what_was_measured) {
    floor.box(0.40, 0.45, 0.15, 0.20, 0.3);
    rebuild();
    EXPECT_TRUE(ask_now().reasons.contains(Reason::corridor_blocked)) << words(ask_now());
    floor.box(0.40, 0.45, 0.15, 0.20, -0.3);
    rebuild();
    EXPECT_TRUE(ask_now().reasons.contains(Reason::drop_off)) << words(ask_now());
}

TEST_F(AttestedStart, stands_for_a_measurement_that_is_unsure_and_agrees) {
    // The row of cells at the lower image border: few points, seen from one position.
    const auto row_with = [&](double height_m, std::uint16_t sigma_tenth_mm, double x_m) {
        floor = Terrain();
        floor.box(-3.0, 0.6, -3.0, 3.0, static_cast<double>(kNanF));
        floor.box(x_m, x_m + 0.025, -1.0, 1.0, height_m);
        rebuild();
        for (double y_m = -0.99; y_m < 1.0; y_m += 0.025)
            map->sigma_tenth_mm[cell_at(*map, x_m + 0.01, y_m)] = sigma_tenth_mm;
        seal(*map);
    };
    constexpr std::uint16_t kUnsure = 150;
    row_with(0.0, kUnsure, 0.6);
    expect_ok(ask_now());
    query.attested.radius_tenth_mm = 6000;  // the row lies outside
    EXPECT_TRUE(ask_now().reasons.contains(Reason::not_resolvable)) << words(ask_now());
    query.attested.radius_tenth_mm = 8500;
    row_with(0.015, kUnsure, 0.6);
    expect_ok(ask_now());
    row_with(0.0151, kUnsure, 0.6);
    EXPECT_TRUE(ask_now().reasons.contains(Reason::not_resolvable)) << words(ask_now());
    row_with(-0.0151, kUnsure, 0.6);
    EXPECT_TRUE(ask_now().reasons.contains(Reason::not_resolvable)) << words(ask_now());
    // A cell with a smaller sigma counts as measured, whatever the attestation says.
    row_with(0.0, 79, 0.5);
    const std::int64_t measured = ask_now().evidence.attested_cells;
    row_with(0.0, 80, 0.5);
    EXPECT_GT(ask_now().evidence.attested_cells, measured);
}

TEST_F(AttestedStart, leaves_what_hangs_over_an_unsure_cell_and_evidence_of_a_drop) {
    constexpr std::uint16_t kUnsure = 150;
    const auto unsure_cell = [&] {
        floor = Terrain();
        floor.box(-3.0, 0.4, -3.0, 3.0, static_cast<double>(kNanF));
        rebuild();
        const std::size_t at = cell_at(*map, 0.51, 0.18);
        map->sigma_tenth_mm[at] = kUnsure;
        return at;
    };
    std::size_t at = unsure_cell();
    seal(*map);
    expect_ok(ask_now());
    at = unsure_cell();
    map->clearance_tenth_mm[at] = 10'000;
    seal(*map);
    EXPECT_TRUE(ask_now().reasons.contains(Reason::body_clearance)) << words(ask_now());
    at = unsure_cell();
    map->drop_evidence[at] = 255;
    seal(*map);
    EXPECT_TRUE(ask_now().reasons.contains(Reason::drop_off)) << words(ask_now());
}

TEST_F(AttestedStart, does_not_tie_in_a_floor_at_another_height) {
    query.attested.height_tenth_mm = 450;
    const Verdict verdict = ask_now();
    EXPECT_EQ(verdict.decision, Decision::not_traversable);
    EXPECT_TRUE(verdict.reasons.contains(Reason::disconnected)) << words(verdict);
}

TEST_F(AttestedStart, a_proven_drop_beats_the_word) {
    floor.input.drop_evidence = {};
    const std::size_t at = cell_at(*map, 0.4, 0.18);
    map->drop_evidence[at] = 255;
    seal(*map);
    expect_refused(ask_now(), Reason::drop_off);
}

TEST_F(AttestedStart, must_be_bounded) {
    query.attested.radius_tenth_mm = 10001;
    expect_error(ask_now(), Reason::bad_number);
    query.attested.radius_tenth_mm = 0;
    expect_error(ask_now(), Reason::bad_number);
    query.attested = {true, std::numeric_limits<std::int64_t>::min(), 0, 8500, 0};
    expect_error(ask_now(), Reason::bad_number);
}

}  // namespace
}  // namespace surefoot::gate::testing
