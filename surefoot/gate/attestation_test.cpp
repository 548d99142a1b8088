// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/attestation.hpp"

#include <gtest/gtest.h>

#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

/// A map with the blind zone of the camera: unknown within 0.7 m of the machine.
std::unique_ptr<grid::MapSnapshot> blind_zone() {
    Terrain terrain;
    terrain.box(-0.7, 0.7, -0.7, 0.7, static_cast<double>(kNanF));
    return terrain.snapshot();
}

Verdict ask_with(const Attestation& attestation, const grid::MapSnapshot& map) {
    Query query = query_at_body(kForward, map);
    query.attested = attestation.area();
    return decide(rex(), query, map, kReady, kNowNs);
}

TEST(Attestation, without_a_word_the_first_step_is_refused_and_with_it_allowed) {
    const auto map = blind_zone();
    Attestation attestation;
    EXPECT_EQ(ask_with(attestation, *map).primary, Reason::unknown_cells);
    ASSERT_TRUE(attestation.attest(rex(), *map, 10'000, kNowNs));
    EXPECT_TRUE(ask_with(attestation, *map).allows_step(kNowNs))
        << words(ask_with(attestation, *map));
    attestation.revoke();
    EXPECT_EQ(ask_with(attestation, *map).primary, Reason::unknown_cells);
}

TEST(Attestation, is_void_for_good_once_the_machine_has_left) {
    const auto map = blind_zone();
    for (const int axis : {0, 1}) {
        Attestation attestation;
        ASSERT_TRUE(attestation.attest(rex(), *map, 10'000, kNowNs));
        const auto here = std::make_unique<grid::MapSnapshot>(*map);
        std::int64_t& place = axis == 0 ? here->body_x_tenth_mm : here->body_y_tenth_mm;
        place = -10'000;
        attestation.observe(*here, kNowNs);
        EXPECT_TRUE(attestation.area().active);
        place = -10'001;
        attestation.observe(*here, kNowNs);
        EXPECT_FALSE(attestation.area().active);
        place = 0;
        attestation.observe(*here, kNowNs);
        EXPECT_FALSE(attestation.area().active) << "coming back revives nothing";
    }
    Attestation diagonal;
    ASSERT_TRUE(diagonal.attest(rex(), *map, 10'000, kNowNs));
    const auto here = std::make_unique<grid::MapSnapshot>(*map);
    here->body_x_tenth_mm = here->body_y_tenth_mm = 7'100;
    diagonal.observe(*here, kNowNs);
    EXPECT_FALSE(diagonal.area().active);
    // Large distances must not overflow into small ones.
    ASSERT_TRUE(diagonal.attest(rex(), *map, 10'000, kNowNs));
    here->body_x_tenth_mm = std::int64_t{1} << 32;
    diagonal.observe(*here, kNowNs);
    EXPECT_FALSE(diagonal.area().active);
}

// Somebody moves the machine while the lens is covered: the next pose belongs to another place.
TEST(Attestation, is_void_for_good_once_nobody_knew_where_the_machine_was) {
    const auto map = blind_zone();
    const auto here = std::make_unique<grid::MapSnapshot>(*map);
    Attestation attestation;
    ASSERT_TRUE(attestation.attest(rex(), *map, 10'000, kNowNs));
    here->health = grid::SnapshotHealth::degraded;
    attestation.observe(*here, kNowNs);
    EXPECT_TRUE(attestation.area().active);
    for (const auto health : {grid::SnapshotHealth::lost, static_cast<grid::SnapshotHealth>(9)}) {
        const std::int64_t allowed_ns = rex().limits.pose_age_ns;
        ASSERT_TRUE(attestation.attest(rex(), *map, 10'000, kNowNs));
        here->health = health;
        attestation.observe(*here, kNowNs + allowed_ns);
        EXPECT_TRUE(attestation.area().active) << "a frame or two";
        here->health = grid::SnapshotHealth::ok;
        attestation.observe(*here, kNowNs + allowed_ns);
        here->health = health;
        attestation.observe(*here, kNowNs + 2 * allowed_ns);
        EXPECT_TRUE(attestation.area().active);
        attestation.observe(*here, kNowNs + 2 * allowed_ns + 1);
        EXPECT_FALSE(attestation.area().active);
        here->health = grid::SnapshotHealth::ok;
        attestation.observe(*here, kNowNs + 3 * allowed_ns);
        EXPECT_FALSE(attestation.area().active);
        // An attestation during the pose loss is not valid either.
        ASSERT_TRUE(attestation.attest(rex(), *map, 10'000, kNowNs));
        here->health = health;
        attestation.observe(*here, kNowNs + 1);
        here->health = grid::SnapshotHealth::ok;
        attestation.observe(*here, kNowNs + allowed_ns + 1);
        EXPECT_FALSE(attestation.area().active);
        ASSERT_TRUE(attestation.attest(rex(), *map, 10'000, kNowNs));
        attestation.observe(*here, kNowNs + 100 * allowed_ns);
        EXPECT_TRUE(attestation.area().active) << "silence alone is not a lost pose";
    }
}

// The rim of a platform in the blind zone, 0.45 m ahead; the rays pass over it.
TEST(Attestation, covers_no_drop_that_lines_of_sight_showed) {
    Terrain edge;
    edge.box(-3.0, 0.975, -3.0, 3.0, kNanF);
    edge.box(0.975, 3.0, -3.0, 3.0, -1.0);
    grid::Layer free_m(240, 240, kNanF);
    edge.paint(free_m, 0.625, 0.975, -3.0, 3.0, -0.24);
    edge.input.free_above_m = std::as_const(free_m).view();
    const auto map = edge.snapshot();
    Attestation attestation;
    ASSERT_TRUE(attestation.attest(rex(), *map, 10'000, kNowNs));
    const Verdict verdict = ask_with(attestation, *map);
    EXPECT_EQ(verdict.decision, Decision::not_traversable);
    EXPECT_TRUE(verdict.reasons.contains(Reason::drop_off)) << words(verdict);
    EXPECT_TRUE(verdict.reasons.contains(Reason::unknown_cells)) << words(verdict);
    EXPECT_TRUE(verdict.evidence.has_worst_cell);
}

TEST(Attestation, holds_up_to_the_rim_on_every_side) {
    const auto map = blind_zone();
    const auto here = std::make_unique<grid::MapSnapshot>(*map);
    struct Case {
        std::int64_t x, y;
        bool holds;
    };
    // (6'000, 8'000) lies on the rim of 10'000.
    const Case cases[] = {{10'000, 0, true},
                          {10'001, 0, false},
                          {-10'000, 0, true},
                          {-10'001, 0, false},
                          {0, 10'000, true},
                          {0, 10'001, false},
                          {0, -10'000, true},
                          {0, -10'001, false},
                          {6'000, -8'000, true},
                          {6'001, 8'000, false},
                          {-6'000, 8'001, false},
                          {std::int64_t{1} << 32, 0, false},
                          {0, std::int64_t{1} << 32, false}};
    for (const Case& c : cases) {
        Attestation attestation;
        ASSERT_TRUE(attestation.attest(rex(), *map, 10'000, kNowNs));
        here->body_x_tenth_mm = c.x;
        here->body_y_tenth_mm = c.y;
        attestation.observe(*here, kNowNs);
        EXPECT_EQ(attestation.area().active, c.holds) << c.x << " " << c.y;
    }
}

TEST(Attestation, the_area_lies_around_the_machine_wherever_that_is) {
    Terrain floor;
    floor.input.T_odom_body.translation_m = {0.5, -0.25, 1.19};
    const auto map = floor.snapshot();
    Attestation attestation;
    ASSERT_TRUE(attestation.attest(rex(), *map, 3'651, kNowNs));
    EXPECT_TRUE(attestation.area().active);
    EXPECT_EQ(attestation.area().center_x_tenth_mm, 5'000);
    EXPECT_EQ(attestation.area().center_y_tenth_mm, -2'500);
    EXPECT_EQ(attestation.area().radius_tenth_mm, 3'651);
    EXPECT_EQ(attestation.area().height_tenth_mm, 2'000);
    attestation.observe(*map, kNowNs);
    EXPECT_TRUE(attestation.area().active);
    const auto away = std::make_unique<grid::MapSnapshot>(*map);
    away->body_y_tenth_mm = 2'500;  // same distance from the origin of odom, but outside the area
    attestation.observe(*away, kNowNs);
    EXPECT_FALSE(attestation.area().active);
}

TEST(Attestation, nobody_can_attest_more_than_the_machine_file_allows) {
    const auto map = blind_zone();
    Attestation attestation;
    EXPECT_FALSE(attestation.attest(rex(), *map, 10'001, kNowNs));
    EXPECT_FALSE(attestation.attest(rex(), *map, 0, kNowNs));
    EXPECT_FALSE(attestation.attest(rex(), *map, -5, kNowNs));
    EXPECT_FALSE(attestation.attest(Machine{}, *map, 5'000, kNowNs));
    Machine off = rex();
    off.limits.attestation_radius_tenth_mm = 0;
    EXPECT_FALSE(attestation.attest(off, *map, 5'000, kNowNs));
    ASSERT_TRUE(attestation.attest(rex(), *map, 5'000, kNowNs));
    const auto damaged = std::make_unique<grid::MapSnapshot>(*map);
    ++damaged->body_z_tenth_mm;
    EXPECT_FALSE(attestation.attest(rex(), *damaged, 5'000, kNowNs));
    EXPECT_TRUE(attestation.area().active) << "a refused attestation changes nothing";
    EXPECT_EQ(attestation.area().radius_tenth_mm, 5'000);
}

// The corners of the soles lie 0.240 m ahead of base_link and 0.275 m beside it: 0.365 m away.
TEST(Attestation, the_area_holds_both_soles_or_nothing_is_attested) {
    const auto map = blind_zone();
    EXPECT_EQ(least_attested_radius_sq(rex()), 2'400 * 2'400 + 2'750 * 2'750);
    Attestation attestation;
    ASSERT_TRUE(attestation.attest(rex(), *map, 8'000, kNowNs));
    for (const std::int64_t radius : {1, 10, 1'000, 3'649}) {
        EXPECT_FALSE(attestation.attest(rex(), *map, radius, kNowNs)) << radius;
        EXPECT_EQ(attestation.area().radius_tenth_mm, 8'000) << "the one before stays";
    }
    EXPECT_TRUE(attestation.attest(rex(), *map, 3'650, kNowNs));
    EXPECT_EQ(attestation.area().radius_tenth_mm, 3'650);
    Machine wide_right = rex();
    wide_right.right_foot.center_y_tenth_mm -= 500;
    EXPECT_EQ(least_attested_radius_sq(wide_right), 2'400 * 2'400 + 3'250 * 3'250);
}

TEST(Attestation, the_ground_lies_under_the_soles) {
    const auto map = blind_zone();
    Attestation attestation;
    ASSERT_TRUE(attestation.attest(rex(), *map, 5'000, kNowNs));
    EXPECT_EQ(attestation.area().height_tenth_mm, 0);
    EXPECT_EQ(attestation.area().radius_tenth_mm, 5'000);
}

}  // namespace
}  // namespace surefoot::gate::testing
