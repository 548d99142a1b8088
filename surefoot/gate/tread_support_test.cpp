// SPDX-License-Identifier: Apache-2.0
// Movements of class stair: treads that are shorter than a foot.
#include "surefoot/gate/tread_support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

constexpr double kRise_m = 0.15;
constexpr double kToe_m = 0.24;
constexpr double kHeel_m = 0.126;
constexpr double kUp_m = 0.42;    ///< length of the step up
constexpr double kDown_m = 0.45;  ///< length of the step back and down
constexpr std::uint8_t kDownAhead = 1;

/// The REX on stairs with a third movement for the way down ahead.
Machine climbing_rex() {
    Machine m = stair_rex();
    m.movements[kDownAhead].movement_class = MovementClass::stair;
    m.movements[kDownAhead].forward_tenth_mm = 4300;
    return m;
}

/// A flight along x. The machine stands on the tread that ends at `near_m`; the next tread is
/// `going_m` deep, and one more follows.
struct Flight {
    double near_m = 0.0;
    double going_m = 0.0;
    double rise_m = kRise_m;  ///< rise of every step, seen from the machine: negative leads down

    void paint(Terrain& t) const {
        const double way = near_m < 0.0 ? -1.0 : 1.0;
        const auto level = [&](double from_m, double to_m, double z_m) {
            t.box(std::min(way * from_m, way * to_m),
                  std::max(way * from_m, way * to_m),
                  -3.0,
                  3.0,
                  z_m);
        };
        const double first_m = std::abs(near_m);
        level(first_m, first_m + going_m, rise_m);
        level(first_m + going_m, 3.0, 2.0 * rise_m);
    }
};

/// Treads that are wide enough for the cells of the corridor beyond them.
const Flight kUpFlight{0.325, 0.400, kRise_m};
const Flight kDownFlight{-0.150, 0.400, -kRise_m};

Terrain terrain_of(const Flight& flight, double drift_m = 0.001) {
    Terrain t;
    t.drift.fill(static_cast<float>(drift_m));
    flight.paint(t);
    return t;
}

Verdict ask_stair(const grid::MapSnapshot& map,
                  std::uint8_t command,
                  const Machine& machine = climbing_rex()) {
    return decide(machine, query_at_body(command, map), map, kReady, kNowNs);
}
Verdict ask_stair(Terrain& terrain, std::uint8_t command) {
    return ask_stair(*terrain.snapshot(), command);
}
Verdict ask_stair(const Flight& flight, std::uint8_t command, double drift_m = 0.001) {
    Terrain t = terrain_of(flight, drift_m);
    return ask_stair(t, command);
}

void expect_refused(const Verdict& verdict, Reason reason) {
    EXPECT_EQ(verdict.decision, Decision::not_traversable) << words(verdict);
    EXPECT_TRUE(verdict.reasons.contains(reason))
        << words(verdict) << " lacks " << to_string(reason);
}

TEST(GateTreads, a_foot_may_stand_on_a_tread_that_does_not_hold_it_whole) {
    // Heels 31 mm beyond the nosing on the way up, 26 mm on the way back and down.
    const Verdict up = ask_stair(kUpFlight, kForward);
    EXPECT_EQ(up.decision, Decision::ok) << words(up);
    const Verdict down = ask_stair(kDownFlight, kBackward);
    EXPECT_EQ(down.decision, Decision::ok) << words(down);
}

TEST(GateTreads, flat_ground_is_a_tread_too) {
    Terrain floor;
    EXPECT_EQ(ask_stair(floor, kForward).decision, Decision::ok);
    EXPECT_EQ(ask_stair(floor, kBackward).decision, Decision::ok);
}

TEST(GateTreads, class_walk_takes_no_stairs) {
    Machine machine = climbing_rex();
    for (const std::uint8_t command : {kForward, kBackward}) {
        machine.movements[command].movement_class = MovementClass::walk;
        Terrain t = terrain_of(command == kForward ? kUpFlight : kDownFlight);
        const auto map = t.snapshot();
        EXPECT_EQ(decide(machine, query_at_body(command, *map), *map, kReady, kNowNs).decision,
                  Decision::not_traversable);
    }
}

TEST(GateTreads, an_edge_a_cell_nearer_is_too_near_to_be_sure_and_two_cells_are_too_many) {
    // Up: the nosing moves under the heel. 31, 56, 81 mm seem to overhang; 73 mm are allowed.
    expect_refused(ask_stair(Flight{0.350, 0.400, kRise_m}, kForward), Reason::edge_margin);
    const Verdict over = ask_stair(Flight{0.375, 0.400, kRise_m}, kForward);
    expect_refused(over, Reason::support_area);
    EXPECT_EQ(over.evidence.limit_tenth_mm, 2928);  // 0.80 of 0.366 m
    EXPECT_NEAR(static_cast<double>(over.evidence.value_tenth_mm), 2850.0, 2.0);
    // Down: the tread is shorter.
    expect_refused(ask_stair(Flight{-0.150, 0.375, -kRise_m}, kBackward), Reason::edge_margin);
    expect_refused(ask_stair(Flight{-0.150, 0.350, -kRise_m}, kBackward), Reason::support_area);
}

TEST(GateTreads, what_is_over_counts_in_all_its_limits) {
    const auto with = [](const std::function<void(Machine&)>& change) {
        Machine machine = climbing_rex();
        change(machine);
        Terrain t = terrain_of(kUpFlight);
        const auto map = t.snapshot();
        return decide(machine, query_at_body(kForward, *map), *map, kReady, kNowNs);
    };
    // 31 mm seem to overhang, 60 mm are allowed: 0.915 and 0.836 of the foot are supported.
    EXPECT_EQ(with([](Machine& m) { m.limits.tread_share_permille = 830; }).decision, Decision::ok);
    expect_refused(with([](Machine& m) { m.limits.tread_share_permille = 840; }),
                   Reason::edge_margin);
    expect_refused(with([](Machine& m) { m.limits.tread_share_permille = 920; }),
                   Reason::support_area);
    EXPECT_EQ(with([](Machine& m) { m.limits.tread_overhang_tenth_mm = 610; }).decision,
              Decision::ok);
    expect_refused(with([](Machine& m) { m.limits.tread_overhang_tenth_mm = 590; }),
                   Reason::edge_margin);
    expect_refused(with([](Machine& m) { m.limits.tread_overhang_tenth_mm = 300; }),
                   Reason::support_area);
    // The ankle 80 mm from the heel, its ground from 55 mm on; then from 15 mm on.
    expect_refused(with([](Machine& m) { m.ankle_from_heel_tenth_mm = 800; }), Reason::edge_margin);
    EXPECT_NE(with([](Machine& m) { m.ankle_from_heel_tenth_mm = 400; }).decision, Decision::ok);
}

TEST(GateTreads, toes_may_hang_over_as_heels_do) {
    // Down and ahead: 20 mm of the toes seem to overhang, 49 mm are allowed.
    Terrain t = terrain_of({0.250, 0.400, -kRise_m});
    const auto map = t.snapshot();
    Machine machine = climbing_rex();
    EXPECT_EQ(ask_stair(*map, kDownAhead, machine).decision, Decision::ok)
        << words(ask_stair(*map, kDownAhead, machine));
    machine.limits.tread_overhang_tenth_mm = 470;
    expect_refused(ask_stair(*map, kDownAhead, machine), Reason::edge_margin);
    machine = climbing_rex();
    machine.ankle_from_heel_tenth_mm = 3000;  // the ground ends 41 mm from the toes
    expect_refused(ask_stair(*map, kDownAhead, machine), Reason::edge_margin);
}

TEST(GateTreads, drift_moves_the_edge) {
    EXPECT_EQ(ask_stair(kUpFlight, kForward, 0.004).decision, Decision::ok);
    expect_refused(ask_stair(kUpFlight, kForward, 0.006), Reason::edge_margin);
    EXPECT_EQ(ask_stair(kDownFlight, kBackward, 0.004).decision, Decision::ok);
    EXPECT_NE(ask_stair(kDownFlight, kBackward, 0.008).decision, Decision::ok);
    expect_refused(ask_stair(kUpFlight, kForward, 0.030), Reason::memory_uncertain);
}

TEST(GateTreads, every_cell_around_the_foot_is_needed) {
    for (const bool up : {true, false}) {
        const std::uint8_t command = up ? kForward : kBackward;
        Terrain t = terrain_of(up ? kUpFlight : kDownFlight);
        const auto map = t.snapshot();
        ASSERT_EQ(ask_stair(*map, command).decision, Decision::ok);
        const double forward_m = up ? kUp_m : -kDown_m;
        for (double x = -kHeel_m - 0.10; x <= kToe_m + 0.10; x += 0.025) {
            for (double y = 0.18 - 0.19; y <= 0.18 + 0.19; y += 0.025) {
                const std::size_t at = cell_at(*map, forward_m + x, y);
                map->source[at] = grid::EvidenceSource::unknown;
                seal(*map);
                expect_refused(ask_stair(*map, command), Reason::unknown_cells);
                map->source[at] = grid::EvidenceSource::measured;
            }
        }
    }
}

TEST(GateTreads, the_band_asks_for_itself_what_the_body_asks_elsewhere) {
    Machine slim = climbing_rex();
    slim.body.parts[2] = {{0, 0, 1000, 1000}, 6200, 20500};
    Terrain t = terrain_of(kUpFlight);
    const auto map = t.snapshot();
    ASSERT_EQ(ask_stair(*map, kForward, slim).decision, Decision::ok);
    const std::size_t at = cell_at(*map, kUp_m + kToe_m + 0.09, 0.18);
    const auto refused = [&](auto& layer, auto value, Reason reason) {
        const auto before = layer[at];
        layer[at] = value;
        seal(*map);
        expect_refused(ask_stair(*map, kForward, slim), reason);
        layer[at] = before;
    };
    refused(map->source, grid::EvidenceSource::unknown, Reason::unknown_cells);
    refused(map->sigma_tenth_mm, std::uint16_t{121}, Reason::not_resolvable);
    refused(map->drift_tenth_mm, std::uint16_t{251}, Reason::memory_uncertain);
}

TEST(GateTreads, evidence_of_a_drop_is_the_last_cell_before_it) {
    Terrain t = terrain_of(kUpFlight);
    const auto map = t.snapshot();
    map->drop_evidence[cell_at(*map, 0.36, 0.18)] = 255;
    seal(*map);
    expect_refused(ask_stair(*map, kForward), Reason::edge_margin);
    map->drop_evidence[cell_at(*map, 0.39, 0.18)] = 255;
    seal(*map);
    expect_refused(ask_stair(*map, kForward), Reason::support_area);
}

TEST(GateTreads, the_tread_beyond_the_nosing_is_within_a_step_and_known) {
    const auto beyond = [](double z_m) {
        Terrain t = terrain_of(kDownFlight);
        t.box(-3.0, -0.55, -3.0, 3.0, z_m);
        return ask_stair(t, kBackward);
    };
    EXPECT_EQ(beyond(-2.0 * kRise_m).decision, Decision::ok);
    expect_refused(beyond(-kRise_m - 0.185), Reason::drop_off);
    expect_refused(beyond(-1.5), Reason::drop_off);
    // Within the limit, but not by 3.4 times its sigma of 4 mm.
    expect_refused(beyond(-kRise_m - 0.170), Reason::not_resolvable);
    expect_refused(beyond(static_cast<double>(kNanF)), Reason::unknown_cells);
}

TEST(GateTreads, ground_is_lower_at_one_end_of_the_foot_alone) {
    // Beside the left foot, where it would land: 40 mm from it and 20 mm below it.
    for (const double y : {0.325, 0.250}) {
        Terrain beside = terrain_of(kUpFlight);
        beside.box(0.325, 3.0, y, 3.0, 0.0);
        expect_refused(ask_stair(beside, kForward), Reason::drop_off);
    }
    // A ridge: lower ahead of the toes too.
    Terrain ridge = terrain_of(kUpFlight);
    ridge.box(0.725, 3.0, -3.0, 3.0, 0.0);
    expect_refused(ask_stair(ridge, kForward), Reason::drop_off);
    // A hole of one cell in a floor, under the ankle, without evidence of a drop around it.
    Terrain floor;
    floor.box(kUp_m + 0.01, kUp_m + 0.02, 0.17, 0.20, -kRise_m);
    const auto map = floor.snapshot();
    map->drop_evidence.fill(0);
    seal(*map);
    expect_refused(ask_stair(*map, kForward), Reason::drop_off);
}

TEST(GateTreads, what_stands_on_the_tread_blocks) {
    // The next riser under the toes, then 40 mm ahead of them.
    expect_refused(ask_stair(Flight{0.325, 0.325, kRise_m}, kForward), Reason::corridor_blocked);
    expect_refused(ask_stair(Flight{0.325, 0.375, kRise_m}, kForward), Reason::corridor_blocked);
    // On the way down the toes would land on the previous nosing.
    expect_refused(ask_stair(Flight{-0.200, 0.400, -kRise_m}, kBackward), Reason::corridor_blocked);
    // A brick beside the heel, lower than the swing clearance in the path of the foot.
    Terrain brick = terrain_of(kUpFlight);
    brick.box(0.50, 0.55, 0.30, 0.32, kRise_m + 0.06);
    expect_refused(ask_stair(brick, kForward), Reason::corridor_blocked);
    // A bump below the sole.
    Terrain bump = terrain_of(kUpFlight);
    bump.box(0.45, 0.50, 0.15, 0.20, kRise_m + 0.03);
    expect_refused(ask_stair(bump, kForward), Reason::roughness);
}

TEST(GateTreads, a_step_higher_than_the_class_is_refused) {
    expect_refused(ask_stair(Flight{0.325, 0.400, 0.185}, kForward), Reason::step_too_high);
    expect_refused(ask_stair(Flight{-0.150, 0.450, -0.185}, kBackward), Reason::step_too_low);
    // The foot cannot pass over obstacles higher than a step plus its clearance.
    Terrain wall = terrain_of(kUpFlight);
    wall.box(0.0, 0.05, 0.285, 0.315, 0.23);
    expect_refused(ask_stair(wall, kForward), Reason::corridor_blocked);
}

TEST(GateTreads, both_feet_land_at_one_height) {
    Terrain t = terrain_of(kUpFlight);
    t.box(0.325, 0.725, -3.0, 0.0, kRise_m - 0.03);
    expect_refused(ask_stair(t, kForward), Reason::roughness);
}

TEST(GateTreads, a_surface_that_is_no_step_away_is_not_connected) {
    // The tread lies behind a gap that is 0.4 m deep.
    Terrain t = terrain_of(kUpFlight);
    t.box(0.245, 0.325, -3.0, 3.0, -0.40);
    expect_refused(ask_stair(t, kForward), Reason::disconnected);
    // A tread that is two steps up.
    expect_refused(ask_stair(Flight{0.325, 0.400, 0.30}, kForward), Reason::disconnected);
}

TEST(GateTreads, the_body_rises_with_the_step) {
    // Room of 2.15 m over the tread, 2.30 m over the floor; the machine and its user take 2.05 m.
    Terrain low = terrain_of(kUpFlight);
    low.paint(low.clearance, -3.0, 3.0, -3.0, 3.0, 2.30)
        .paint(low.clearance, 0.325, 0.725, -3.0, 3.0, 2.15)
        .paint(low.clearance, 0.725, 3.0, -3.0, 3.0, 2.00);
    EXPECT_EQ(ask_stair(low, kForward).decision, Decision::ok) << words(ask_stair(low, kForward));
    low.paint(low.clearance, 0.325, 0.725, -3.0, 3.0, 2.00);
    expect_refused(ask_stair(low, kForward), Reason::body_clearance);
}

TEST(GateTreads, a_body_that_goes_down_keeps_clear_of_what_it_stood_on) {
    Machine machine = climbing_rex();
    Terrain t = terrain_of(kDownFlight);
    const auto map = t.snapshot();
    const Query query = query_at_body(kBackward, *map);
    EXPECT_EQ(decide(machine, query, *map, kReady, kNowNs).decision, Decision::ok);
    machine.body.sway_tenth_mm = 700;  // the legs then reach 25 mm over the nosing that was left
    expect_refused(decide(machine, query, *map, kReady, kNowNs), Reason::body_clearance);
}

/// The nosing at `x_m` as a line across the flight; lower ground towards -x.
grid::SnapshotInput::Edge nosing(double x_m, double upper_m, double across_sigma_m) {
    return {{x_m, 1.0}, {x_m, -1.0}, upper_m, upper_m - kRise_m, 0.002, across_sigma_m};
}

TEST(GateTreads, a_line_at_the_nosing_takes_back_the_doubt_of_a_cell) {
    const auto with = [](const grid::SnapshotInput::Edge& edge, double near_m) {
        Terrain t = terrain_of({near_m, 0.400, kRise_m});
        const std::array<grid::SnapshotInput::Edge, 1> edges{edge};
        t.input.edges = edges;
        return ask_stair(t, kForward);
    };
    // Right of the way from +y to -y at the heel lies -x.
    EXPECT_EQ(with(nosing(0.350, kRise_m, 0.002), 0.350).decision, Decision::ok);
    expect_refused(with(nosing(0.350, kRise_m, 0.006), 0.350), Reason::edge_margin);
    // A line at another height, position or direction, or beside the foot.
    expect_refused(with(nosing(0.350, 0.0, 0.002), 0.350), Reason::edge_margin);
    expect_refused(with(nosing(0.375, kRise_m, 0.002), 0.350), Reason::edge_margin);
    grid::SnapshotInput::Edge turned = nosing(0.350, kRise_m, 0.002);
    std::swap(turned.from_m, turned.to_m);
    expect_refused(with(turned, 0.350), Reason::edge_margin);
    grid::SnapshotInput::Edge beside = nosing(0.350, kRise_m, 0.002);
    beside.to_m.y() = 0.10;
    expect_refused(with(beside, 0.350), Reason::edge_margin);
    beside = nosing(0.350, kRise_m, 0.002);
    beside.from_m.y() = -0.10;
    expect_refused(with(beside, 0.350), Reason::edge_margin);
    // Slanted: the worse side counts.
    grid::SnapshotInput::Edge slanted = nosing(0.350, kRise_m, 0.002);
    slanted.from_m.x() = 0.400;
    slanted.to_m.x() = 0.300;
    expect_refused(with(slanted, 0.350), Reason::edge_margin);
    // A line that runs farther out than the cells removes no more uncertainty.
    expect_refused(with(nosing(0.325, kRise_m, 0.001), 0.375), Reason::support_area);
    // A line that lies farther in never helps, and never reduces the support that cells prove.
    EXPECT_EQ(with(nosing(0.360, kRise_m, 0.001), 0.325).decision, Decision::ok);
}

TEST(GateTreads, a_line_with_broken_numbers_is_no_line) {
    Terrain t = terrain_of({0.350, 0.400, kRise_m});
    const std::array<grid::SnapshotInput::Edge, 1> edges{nosing(0.350, kRise_m, 0.002)};
    t.input.edges = edges;
    const auto map = t.snapshot();
    ASSERT_EQ(ask_stair(*map, kForward).decision, Decision::ok);
    const auto with = [&](auto&& change) {
        const grid::SnapshotEdge before = map->edges[0];
        change(map->edges[0]);
        seal(*map);
        const Verdict verdict = ask_stair(*map, kForward);
        map->edges[0] = before;
        return verdict;
    };
    constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
    expect_refused(with([](auto& e) { e.across_sigma_tenth_mm = -1; }), Reason::edge_margin);
    expect_refused(with([](auto& e) { e.from_y_tenth_mm = kMost; }), Reason::edge_margin);
    expect_refused(with([](auto& e) { e.lower_tenth_mm = kMost; }), Reason::edge_margin);
}

/// Removes evidence from one cell; see gate_property_test.cpp.
void worsen(grid::MapSnapshot& map, Rng& rng) {
    const std::size_t at = cell_at(map, rng.uniform(-0.8, 0.9), rng.uniform(-0.5, 0.5));
    const auto raise = [&rng](std::uint16_t value) {
        return static_cast<std::uint16_t>(std::min<std::uint64_t>(0xffff, value + rng.below(300)));
    };
    switch (rng.below(5)) {
        case 0: map.source[at] = grid::EvidenceSource::unknown; break;
        case 1: map.sigma_tenth_mm[at] = raise(map.sigma_tenth_mm[at]); break;
        case 2: map.drift_tenth_mm[at] = raise(map.drift_tenth_mm[at]); break;
        case 3: map.drop_evidence[at] = 255; break;
        default: map.edge_count = 0; map.edges.fill({});
    }
}

TEST(GateTreads, less_evidence_never_turns_a_refusal_into_ok) {
    Rng rng(31);
    int refused = 0;
    int allowed = 0;
    for (int round = 0; round < 150; ++round) {
        const bool up = rng.below(2) == 0;
        const double way = up ? 1.0 : -1.0;
        const Flight flight{way * ((up ? 0.30 : 0.135) + rng.uniform(0.0, 0.05)),
                            rng.uniform(0.38, 0.50),
                            way * rng.uniform(0.08, 0.17)};
        Terrain t = terrain_of(flight, rng.uniform(0.0, 0.004));
        for (int v = 0; v < 240; ++v) {
            for (int u = 0; u < 240; ++u)
                t.height.at(u, v) += static_cast<float>(0.002 * rng.normal());
        }
        const std::array<grid::SnapshotInput::Edge, 1> edges{
            nosing(flight.near_m, flight.rise_m, rng.uniform(0.001, 0.008))};
        t.input.edges = edges;
        const auto map = t.snapshot();
        const std::uint8_t command = up ? kForward : kBackward;
        Verdict before = ask_stair(*map, command);
        for (int change = 0; change < 5; ++change) {
            worsen(*map, rng);
            seal(*map);
            const Verdict after = ask_stair(*map, command);
            if (before.decision == Decision::ok) {
                ++allowed;
            } else {
                ++refused;
                ASSERT_NE(after.decision, Decision::ok) << "round " << round << words(before);
            }
            before = after;
        }
    }
    EXPECT_GT(refused, 250);
    EXPECT_GT(allowed, 50);
}

/// An OK means that enough of the foot is really supported, for every position of the nosing within
/// its cells and every pose of the machine.
TEST(GateTreads, ok_means_that_the_foot_is_carried_by_the_flight_that_was_drawn) {
    Rng rng(77);
    int allowed = 0;
    for (int round = 0; round < 200; ++round) {
        const double near_m = rng.uniform(0.28, 0.42);
        const double yaw = rng.uniform(-0.12, 0.12);
        const double going_m = rng.uniform(0.40, 0.60);
        // Rows of the flight, turned about the machine by -yaw: it looks along x of the map.
        Terrain t;
        t.drift.fill(0.001F);
        const auto along = [yaw](double x, double y) {
            return std::cos(yaw) * x - std::sin(yaw) * y;
        };
        for (int v = 0; v < 240; ++v) {
            for (int u = 0; u < 240; ++u) {
                const Eigen::Vector2d c = t.geometry.center_m({u, v});
                // A cell shows the highest ground in it, as the map does.
                double z = 0.0;
                for (const double dx : {-0.0125, 0.0125}) {
                    for (const double dy : {-0.0125, 0.0125}) {
                        const double s = along(c.x() + dx, c.y() + dy);
                        z = std::max(z,
                                     s < near_m             ? 0.0
                                     : s < near_m + going_m ? kRise_m
                                                            : 2.0 * kRise_m);
                    }
                }
                t.height.at(u, v) = static_cast<float>(z);
            }
        }
        if (ask_stair(t, kForward).decision != Decision::ok) continue;
        ++allowed;
        for (const double side : {1.0, -1.0}) {
            int carried = 0;
            int points = 0;
            for (double x = -kHeel_m; x <= kToe_m; x += 0.003) {
                for (double y = -0.095; y <= 0.095; y += 0.005) {
                    const double s = along(kUp_m + x, side * 0.18 + y);
                    ++points;
                    carried += s >= near_m ? 1 : 0;
                    ASSERT_LT(s, near_m + going_m) << "round " << round;
                    if (std::abs(x) < 0.025) {
                        ASSERT_GE(s, near_m) << "round " << round;
                    }
                }
            }
            ASSERT_GE(carried, 0.80 * points) << "round " << round << ", nosing " << near_m;
        }
    }
    EXPECT_GT(allowed, 10);
}

}  // namespace
}  // namespace surefoot::gate::testing
