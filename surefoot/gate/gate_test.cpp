// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/gate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/verdict_testing.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(Gate, a_default_verdict_query_and_health_inhibit) {
    EXPECT_EQ(Verdict{}.decision, Decision::error);
    EXPECT_FALSE(Verdict{}.allows_step(0));
    Terrain floor;
    const auto map = floor.snapshot();
    expect_error(decide(rex(), Query{}, *map, kReady, kNowNs), Reason::bad_number);
    expect_error(decide(rex(), query_at_body(kForward, *map), *map, GateHealth{}, kNowNs),
                 Reason::not_ready);
    expect_error(decide(Machine{}, query_at_body(kForward, *map), *map, kReady, kNowNs),
                 Reason::config);
    const auto nothing = std::make_unique<grid::MapSnapshot>();
    expect_error(decide(rex(), query_at_body(kForward, *map), *nothing, kReady, kNowNs),
                 Reason::internal);
}

TEST(Gate, what_nobody_filled_in_names_no_movement_nobody_and_no_area) {
    const Query query;
    EXPECT_EQ(query.command, 0);
    EXPECT_EQ(query.connection, 0U);
    EXPECT_EQ(query.sequence, 0U);
    const AttestedArea& area = query.attested;
    EXPECT_FALSE(area.active);
    EXPECT_EQ(area.center_x_tenth_mm, 0);
    EXPECT_EQ(area.center_y_tenth_mm, 0);
    EXPECT_EQ(area.radius_tenth_mm, 0);  // active alone it covers nothing
    EXPECT_EQ(area.height_tenth_mm, 0);
}

TEST(Gate, given_a_flat_known_floor_then_every_configured_movement_is_ok) {
    Terrain floor;
    const auto map = floor.snapshot();
    for (int code = 1; code < Machine::kMovementCodes; ++code) {
        const Verdict verdict = ask(*map, static_cast<std::uint8_t>(code));
        expect_ok(verdict);
        EXPECT_EQ(verdict.evidence.known_cells, verdict.evidence.cells);
        EXPECT_EQ(verdict.evidence.attested_cells, 0);
        EXPECT_EQ(verdict.evidence.height_delta_tenth_mm, 0);
        EXPECT_EQ(verdict.map_version, 42U);
        EXPECT_EQ(verdict.config_hash, 4711U);
        EXPECT_EQ(verdict.valid_until_ns, kNowNs + 300 * kMs);
    }
}

TEST(Gate, an_ok_lives_300_ms_and_not_before_it_was_given) {
    Terrain floor;
    const Verdict verdict = ask(floor, kForward);
    EXPECT_TRUE(verdict.allows_step(kNowNs));
    EXPECT_TRUE(verdict.allows_step(kNowNs + 300 * kMs - 1));
    EXPECT_FALSE(verdict.allows_step(kNowNs + 300 * kMs));
    EXPECT_FALSE(verdict.allows_step(kNowNs - 1));
}

TEST(Gate, works_at_any_pose_yaw_and_cell_size) {
    for (const double res_m : {0.0125, 0.02, 0.025, 0.05}) {
        Terrain floor;
        floor.geometry.resolution_m = res_m;
        floor.geometry.origin_m.setConstant(-120.0 * res_m);
        // One cell of 50 mm is a whole patch: nothing is averaged, so its own sigma must be
        // smaller.
        floor.variance.fill(res_m > 0.04 ? 6e-6F : 16e-6F);
        const auto map = floor.snapshot();
        for (int deg = -180; deg < 180; deg += 17) {
            const double yaw = deg * std::numbers::pi / 180.0;
            const Query query = make_query(kForward, 0.0131, -0.0077, std::cos(yaw), std::sin(yaw));
            const Verdict verdict = decide(rex(), query, *map, kReady, kNowNs);
            expect_ok(verdict);
            EXPECT_FALSE(HasFailure()) << "resolution " << res_m << " yaw " << deg;
        }
    }
}

TEST(Gate, the_height_of_the_stance_comes_from_the_map_or_from_the_caller) {
    Terrain low;
    low.height.fill(-0.2F);
    const auto map = low.snapshot();
    Query query = query_at_body(kForward, *map);
    const Verdict by_map = decide(rex(), query, *map, kReady, kNowNs);
    expect_ok(by_map);
    EXPECT_EQ(by_map.evidence.stance_height_tenth_mm, -2000);
    query.stance_source = StanceHeight::given;
    query.stance_height_tenth_mm = -1950;
    expect_ok(decide(rex(), query, *map, kReady, kNowNs));
    query.stance_height_tenth_mm = 0;
    expect_refused(decide(rex(), query, *map, kReady, kNowNs), Reason::drop_off);
    query.stance_source = static_cast<StanceHeight>(9);
    expect_error(decide(rex(), query, *map, kReady, kNowNs), Reason::bad_number);
}

}  // namespace
}  // namespace surefoot::gate::testing
