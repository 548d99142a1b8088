// SPDX-License-Identifier: Apache-2.0
// What must be in order before the gate looks at the ground.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/verdict_testing.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(GateReadiness, ages_are_two_sided) {
    struct Case {
        std::int64_t frame_age_ms;
        std::int64_t pose_age_ms;
        Reason primary;
    };
    const Case cases[] = {{200, 200, Reason::none},
                          {201, 0, Reason::frame_stale},
                          {0, 201, Reason::pose_stale},
                          {-5, -5, Reason::none},
                          {-6, 0, Reason::time_skew},
                          {0, -6, Reason::time_skew},
                          {4999, 10, Reason::frame_stale}};
    for (const Case& c : cases) {
        Terrain floor;
        floor.input.frame_time_ns = kNowNs - c.frame_age_ms * kMs;
        floor.input.pose_time_ns = kNowNs - c.pose_age_ms * kMs;
        const Verdict verdict = ask(floor, kForward);
        EXPECT_EQ(verdict.primary, c.primary)
            << c.frame_age_ms << " " << c.pose_age_ms << " " << words(verdict);
    }
}

TEST(GateReadiness, extreme_stamps_do_not_overflow) {
    constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
    constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
    for (const std::int64_t stamp : {kMin, std::int64_t{0}, kMax}) {
        for (const std::int64_t now : {kMin, std::int64_t{-1}, kNowNs, kMax}) {
            Terrain floor;
            floor.input.frame_time_ns = stamp;
            const auto map = floor.snapshot();
            const Verdict verdict = decide(rex(), query_at_body(kForward, *map), *map, kReady, now);
            EXPECT_EQ(verdict.decision, Decision::error) << stamp << " " << now;
        }
    }
}

TEST(GateReadiness, only_ready_can_say_ok) {
    Terrain floor;
    const auto map = floor.snapshot();
    for (int state = 0; state < 256; ++state) {
        const GateHealth health{static_cast<GateState>(state), {}};
        const Verdict verdict = decide(rex(), query_at_body(kForward, *map), *map, health, kNowNs);
        if (health.state == GateState::ready)
            expect_ok(verdict);
        else
            expect_error(verdict,
                         health.state == GateState::warmup ? Reason::warmup : Reason::not_ready);
    }
}

TEST(GateReadiness, every_raised_fault_is_an_error_under_its_own_name) {
    Terrain floor;
    const auto map = floor.snapshot();
    for (int i = 0; i < kReasonCount; ++i) {
        const auto fault = static_cast<Reason>(i);
        const GateHealth health{GateState::ready, ReasonSet(fault)};
        const Verdict verdict = decide(rex(), query_at_body(kForward, *map), *map, health, kNowNs);
        expect_error(verdict, is_error(fault) ? fault : Reason::internal);
    }
}

TEST(GateReadiness, gravity_must_be_measured) {
    for (int source = 0; source < 5; ++source) {
        Terrain floor;
        floor.input.gravity_source = static_cast<grid::GravitySource>(source);
        const Verdict verdict = ask(floor, kForward);
        if (source == 1 || source == 2)
            expect_ok(verdict);
        else
            expect_error(verdict, Reason::plane_invalid);
    }
}

TEST(GateReadiness, odometry_must_be_healthy) {
    Terrain floor;
    floor.input.health = grid::SnapshotHealth::lost;
    expect_error(ask(floor, kForward), Reason::pose_lost);
    floor.input.health = grid::SnapshotHealth::degraded;
    expect_error(ask(floor, kForward), Reason::not_ready);
    floor.input.health = static_cast<grid::SnapshotHealth>(77);
    expect_error(ask(floor, kForward), Reason::pose_lost);
}

TEST(GateReadiness, the_camera_must_bring_new_and_whole_images) {
    Terrain floor;
    floor.input.camera = CameraState::frozen;
    expect_error(ask(floor, kForward), Reason::frame_frozen);
    floor.input.camera = CameraState::corrupt;
    expect_error(ask(floor, kForward), Reason::frame_corrupt);
    floor.input.camera = CameraState::overexposed;
    expect_error(ask(floor, kForward), Reason::exposure);
    floor.input.camera = CameraState::dark;
    expect_error(ask(floor, kForward), Reason::blind);
    floor.input.camera = CameraState::moved;
    expect_error(ask(floor, kForward), Reason::mount_moved);
    floor.input.camera = CameraState::leaning;
    expect_error(ask(floor, kForward), Reason::plane_invalid);
    for (const int camera : {0, 8, 255}) {
        floor.input.camera = static_cast<CameraState>(camera);
        expect_error(ask(floor, kForward), Reason::not_ready);
    }
    // A freeze begins before its symptoms, so it is the reason even if the map has aged too.
    floor.input.camera = CameraState::frozen;
    floor.input.frame_time_ns = floor.input.pose_time_ns = kNowNs - 1000 * kMs;
    expect_error(ask(floor, kForward), Reason::frame_frozen);
}

TEST(GateReadiness, a_damaged_map_is_an_internal_error) {
    Terrain floor;
    const auto map = floor.snapshot();
    std::int32_t& height = map->height_tenth_mm[cell_at(*map, 0.3, 0.2)];
    height ^= 1;
    const Verdict verdict = ask(*map, kForward);
    expect_error(verdict, Reason::internal);
    EXPECT_TRUE(verdict.evidence.lacks(Proof::cells_intact));
    EXPECT_EQ(verdict.evidence.cells, 0) << "nothing is judged on it";
    height ^= 1;
    expect_ok(ask(*map, kForward));
    map->version ^= 1;
    expect_error(ask(*map, kForward), Reason::internal);
    map->version ^= 1;
    // The verdict does not read cells far from the step; a reader of the whole map does.
    map->height_tenth_mm[cell_at(*map, 2.0, 2.9)] ^= 1;
    expect_ok(ask(*map, kForward));
    EXPECT_TRUE(snapshot_faults(rex(), *map, kNowNs).contains(Reason::internal));
}

/// A changed bit in any cell that decide() may read is detected, or has no effect.
TEST(GateReadiness, no_verdict_is_made_of_a_changed_cell) {
    Terrain floor;
    const auto map = floor.snapshot();
    for (const std::uint8_t command : {kForward, kBackward, kLeft, kTurnRight}) {
        Query query = query_at_body(command, *map);
        query.attested = {true, 0, 0, 6000, 0};
        const Verdict before = decide(rex(), query, *map, kReady, kNowNs);
        expect_ok(before);
        for (std::size_t i = 0; i < 240UL * 240UL; i += 37) {
            map->source[i] = grid::EvidenceSource::unknown;
            map->component[i] ^= 1;
            const Verdict after = decide(rex(), query, *map, kReady, kNowNs);
            map->source[i] = grid::EvidenceSource::measured;
            map->component[i] ^= 1;
            if (after.decision == Decision::error) continue;
            ASSERT_EQ(after.decision, Decision::ok) << "cell " << i << ": " << words(after);
            ASSERT_EQ(after.evidence.known_cells, before.evidence.known_cells) << "cell " << i;
            ASSERT_EQ(after.evidence.attested_cells, before.evidence.attested_cells)
                << "cell " << i;
        }
    }
}

TEST(GateReadiness, numbers_must_be_finite_and_small) {
    Terrain floor;
    const auto map = floor.snapshot();
    const double nan = std::nan("");
    const double inf = std::numeric_limits<double>::infinity();
    const Query bad[] = {make_query(kForward, nan, 0, 1, 0),
                         make_query(kForward, 0, inf, 1, 0),
                         make_query(kForward, 0, 0, nan, 0),
                         make_query(kForward, 0, 0, 1, nan),
                         make_query(kForward, 0, 0, inf, 0),
                         make_query(kForward, 0, 0, 0, 0),
                         make_query(kForward, 0, 0, 0.9, 0),
                         make_query(kForward, 0, 0, 1, 0.1),
                         make_query(kForward, 1e300, 0, 1, 0),
                         make_query(kForward, -1e6, 0, 1, 0)};
    for (const Query& query : bad)
        expect_error(decide(rex(), query, *map, kReady, kNowNs), Reason::bad_number);
}

TEST(GateReadiness, all_256_codes_are_either_configured_or_an_error) {
    Terrain floor;
    const auto map = floor.snapshot();
    Machine four = rex();
    for (std::size_t code = 0; code < four.movements.size(); ++code) {
        if (code != kForward && code != kRight && code != kBackward && code != kLeft)
            four.movements[code] = Movement{};
    }
    for (int code = 0; code < 256; ++code) {
        const auto command = static_cast<std::uint8_t>(code);
        const Query query = query_at_body(command, *map);
        const Verdict all = decide(rex(), query, *map, kReady, kNowNs);
        if (code >= 1 && code <= 26)
            expect_ok(all);
        else
            expect_error(all, Reason::unknown_command);
        const Verdict few = decide(four, query, *map, kReady, kNowNs);
        if (four.movements.size() > command && four.movements[command].configured)
            expect_ok(few);
        else
            expect_error(few, Reason::unknown_command);
    }
}

TEST(GateReadiness, a_class_that_is_off_has_no_movements) {
    Terrain floor;
    const auto map = floor.snapshot();
    Machine machine = rex();
    machine.movements[kForward].movement_class = MovementClass::stair;
    const Query query = query_at_body(kForward, *map);
    expect_error(decide(machine, query, *map, kReady, kNowNs), Reason::unknown_command);
    machine.limits.step[1].enabled = true;
    expect_ok(decide(machine, query, *map, kReady, kNowNs));
}

TEST(GateReadiness, an_error_hides_no_terrain_and_beats_it) {
    Terrain nothing;
    nothing.height.fill(kNanF);
    nothing.input.frame_time_ns = 0;
    expect_error(ask(nothing, kForward), Reason::frame_stale);
}

}  // namespace
}  // namespace surefoot::gate::testing
