// SPDX-License-Identifier: Apache-2.0
// The zone holds every cell that decide() reads: cells outside may have any value.
#include "service/gate_process/query_zone.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "service/gate_process/audit/audit_testing.hpp"

namespace surefoot::gate_process::testing {
namespace {

/// Overwrites every cell outside the zone: ground at floor height on another surface, holes, walls,
/// drops.
void scramble_outside(grid::MapSnapshot& map, const CellBox& zone, Rng& rng) {
    for (std::int32_t iy = 0; iy < map.ny; ++iy) {
        for (std::int32_t ix = 0; ix < map.nx; ++ix) {
            const bool inside =
                ix >= zone.x && ix < zone.x + zone.nx && iy >= zone.y && iy < zone.y + zone.ny;
            if (inside) continue;
            const auto at = static_cast<std::size_t>(iy * map.nx + ix);
            const std::uint64_t bits = rng.next_u64();
            map.source[at] =
                bits % 4 == 0 ? grid::EvidenceSource::unknown : grid::EvidenceSource::measured;
            map.height_tenth_mm[at] = static_cast<std::int32_t>(bits >> 8U & 0xfffU) - 2048;
            map.sigma_tenth_mm[at] = static_cast<std::uint16_t>(bits >> 20U);
            map.drift_tenth_mm[at] = static_cast<std::uint16_t>(bits >> 30U);
            map.clearance_tenth_mm[at] = static_cast<std::uint16_t>(bits >> 40U);
            map.component[at] = static_cast<std::uint16_t>(1 + (bits >> 50U & 7U));
            map.drop_evidence[at] = static_cast<std::uint8_t>(bits >> 56U);
        }
    }
    seal(map);
}

/// The REX with every movement of class stair.
Machine climbing_rex() {
    Machine machine = rex();
    machine.limits.step[static_cast<std::size_t>(MovementClass::stair)].enabled = true;
    for (Movement& movement : machine.movements) movement.movement_class = MovementClass::stair;
    return machine;
}

TEST(QueryZone, cells_outside_of_it_never_change_a_verdict) {
    Rng rng(21);
    int allowed = 0;
    int attested = 0;
    for (int round = 0; round < 400; ++round) {
        Case c = random_case(rng,
                             round % 2 == 1   ? random_machine(rng)
                             : round % 4 == 0 ? rex()
                                              : climbing_rex());
        ASSERT_LT(c.zone().cells(), std::size_t{240} * 240) << "the zone is no window";
        const gate::Verdict before = c.verdict;
        scramble_outside(*c.map, c.zone(), rng);
        c.decide();
        const auto found = differences(before, c.verdict);
        ASSERT_TRUE(found.empty()) << "round " << round << ": " << words(found);
        allowed += c.verdict.decision == gate::Decision::ok ? 1 : 0;
        attested += c.verdict.evidence.attested_cells > 0 ? 1 : 0;
    }
    EXPECT_GT(allowed, 20);  // otherwise the rounds prove nothing
    EXPECT_GT(attested, 20);
}

/// The surface that the attested area extends to lies one cell beside the area. Without this ring a
/// landing there would become DISCONNECTED, or the reverse.
TEST(QueryZone, holds_the_surfaces_beside_the_attested_area) {
    gate::testing::Terrain terrain;
    Case c;
    c.map = terrain.snapshot();
    c.query = gate::query_at_body(gate::testing::kForward, *c.map);
    c.query.attested = {true, -9000, 0, 10'000, 0};
    const CellBox zone = c.zone();
    const std::int64_t left = c.map->origin_x_tenth_mm + zone.x * c.map->resolution_tenth_mm;
    EXPECT_LE(left, -9000 - 10'000 - 250);
    c.query.attested.active = false;
    EXPECT_GT(c.zone().x, zone.x);
}

TEST(QueryZone, is_empty_where_the_gate_does_not_look) {
    Rng rng(22);
    const Case good = [&] {
        Case c = random_case(rng);
        c.query = gate::query_at_body(gate::testing::kForward, *c.map);
        return c;
    }();
    EXPECT_GT(good.zone().cells(), 0U);
    const auto zone_after = [&](auto break_it) {
        Case c;
        c.map = std::make_unique<grid::MapSnapshot>(*good.map);
        c.query = good.query;
        break_it(c);
        return c.zone();
    };
    constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
    const double nan = std::nan("");
    EXPECT_EQ(zone_after([](Case& c) { c.query.command = 0; }), CellBox{});
    EXPECT_EQ(zone_after([](Case& c) { c.query.command = 255; }), CellBox{});
    EXPECT_EQ(zone_after([&](Case& c) { c.query.cos_yaw = nan; }), CellBox{});
    EXPECT_EQ(zone_after([&](Case& c) { c.query.sin_yaw = 1e300; }), CellBox{});
    EXPECT_EQ(zone_after([](Case& c) { c.query.x_tenth_mm = kMax; }), CellBox{});
    EXPECT_EQ(zone_after([](Case& c) { c.query.y_tenth_mm = -kMax; }), CellBox{});
    EXPECT_EQ(zone_after([](Case& c) { c.query.attested = {true, kMax, 0, 100, 0}; }), CellBox{});
    EXPECT_EQ(zone_after([](Case& c) { c.query.attested = {true, 0, 0, -1, 0}; }), CellBox{});
    EXPECT_EQ(zone_after([](Case& c) { c.machine = Machine{}; }), CellBox{});
    EXPECT_EQ(zone_after([](Case& c) { c.map->nx = 257; }), CellBox{});
    EXPECT_EQ(zone_after([](Case& c) { c.map->ny = 0; }), CellBox{});
    EXPECT_EQ(zone_after([](Case& c) { c.map->resolution_tenth_mm = 0; }), CellBox{});
    EXPECT_EQ(zone_after([](Case& c) { c.map->origin_x_tenth_mm = kMax; }), CellBox{});
    EXPECT_EQ(zone_after([](Case& c) { c.query.x_tenth_mm = 900'000; }), CellBox{});  // off the map
}

TEST(QueryZone, a_box_inside_a_map_is_told_from_all_others) {
    const auto owner = std::make_unique<grid::MapSnapshot>();
    grid::MapSnapshot& map = *owner;
    map.nx = 10;
    map.ny = 20;
    map.resolution_tenth_mm = 250;
    EXPECT_TRUE(is_inside({0, 0, 10, 20}, map));
    EXPECT_TRUE(is_inside({9, 19, 1, 1}, map));
    EXPECT_FALSE(is_inside({0, 0, 11, 20}, map));
    EXPECT_FALSE(is_inside({9, 19, 1, 2}, map));
    EXPECT_FALSE(is_inside({-1, 0, 1, 1}, map));
    EXPECT_FALSE(is_inside({0, 0, -1, 1}, map));
    EXPECT_FALSE(is_inside({2'000'000'000, 0, 2'000'000'000, 1}, map));
}

}  // namespace
}  // namespace surefoot::gate_process::testing
