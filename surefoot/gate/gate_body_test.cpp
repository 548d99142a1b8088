// SPDX-License-Identifier: Apache-2.0
// What stands or hangs in the way of the body and of a lifted foot.
#include <gtest/gtest.h>

#include <string>

#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/verdict_testing.hpp"
#include "surefoot/gate/verdict_text.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(Gate, given_a_table_ahead_then_the_way_is_blocked) {
    Terrain room;
    room.draw({"...777777...",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............",  //
               "............"});
    expect_ok(ask(room, kForward));  // 1.0 m away: one step does not reach it
    room.box(0.6, 1.0, -0.6, 0.6, 0.7);
    const Verdict blocked = ask(room, kForward);
    expect_refused(blocked, Reason::corridor_blocked);
    EXPECT_EQ(blocked.evidence.value_tenth_mm, 7000);
    EXPECT_TRUE(blocked.reasons.contains(Reason::body_clearance));
    expect_ok(ask(room, kBackward));
}

TEST(Gate, given_something_only_the_body_meets_then_body_clearance) {
    Terrain room;
    room.box(0.2, 0.6, 0.325, 0.5, 0.5);  // a wall beside the left foot, within the sway
    const Verdict verdict = ask(room, kForward);
    expect_refused(verdict, Reason::body_clearance);
    EXPECT_FALSE(verdict.reasons.contains(Reason::corridor_blocked)) << words(verdict);
    // A kerb there is lower than the body and outside the path of the foot.
    Terrain kerb;
    kerb.box(0.2, 0.6, 0.325, 0.5, 0.1);
    expect_ok(ask(kerb, kForward));
}

TEST(Gate, given_a_lintel_above_then_body_clearance) {
    Terrain door;
    door.paint(door.clearance, 0.4, 0.6, -0.5, 0.5, 1.9);
    const Verdict verdict = ask(door, kForward);
    expect_refused(verdict, Reason::body_clearance);
    EXPECT_EQ(verdict.evidence.limit_tenth_mm, 20500);
    door.paint(door.clearance, 0.4, 0.6, -0.5, 0.5, 2.1);
    expect_ok(ask(door, kForward));
}

/// A rim that the map shows one cell too far away is still an obstacle.
TEST(Gate, what_the_map_shows_a_cell_beside_its_place_still_counts) {
    const double body_m = 0.4 + 0.33 + 0.05;  // step, half the box, sway
    const auto table_at = [](double x_m) {
        Terrain room;
        room.box(x_m, x_m + 0.2, 0.25, 0.3, 0.7);
        return ask(room, kForward);
    };
    expect_refused(table_at(body_m + 0.02), Reason::body_clearance);
    expect_ok(table_at(body_m + 0.05));
    const auto drop_at = [](double x_m) {
        Terrain room;
        room.box(x_m, 3.0, -3.0, 3.0, -0.3);
        return ask(room, kForward).reasons.contains(Reason::drop_off);
    };
    const double toes_m = 0.4 + 0.057 + 0.183;
    // The band ends at 0.10 m. The map can show ground up to 0.10 m beyond the edge of a drop.
    EXPECT_TRUE(drop_at(toes_m + 0.10 + 0.08));
    EXPECT_FALSE(drop_at(toes_m + 0.10 + 0.12));
}

/// Legs 0.5 m wide up to the hips, above them a frame of 1.0 m.
Machine with_legs_and_frame() {
    Machine machine = rex();
    machine.body.parts[0] = {{0, 0, 4000, 5000}, 1440, 9900};
    machine.body.parts[1] = {{0, 0, 6600, 10000}, 7000, 20500};
    machine.body.count = 2;
    machine.body.sway_tenth_mm = 0;
    return machine;
}
Verdict ask_with(const Machine& machine, Terrain& terrain) {
    const auto map = terrain.snapshot();
    return decide(machine, query_at_body(kForward, *map), *map, kReady, kNowNs);
}

TEST(GateBody, each_part_has_its_own_box_and_heights) {
    const Machine machine = with_legs_and_frame();
    const auto beside = [&](double height_m) {  // 0.35 m to the side: frame, but no leg
        Terrain floor;
        floor.box(-0.1, 0.3, 0.33, 0.40, height_m);
        return ask_with(machine, floor);
    };
    expect_ok(beside(0.68));
    expect_refused(beside(0.69), Reason::not_resolvable);  // 3.4 sigma are 14 mm
    expect_refused(beside(0.72), Reason::body_clearance);
    EXPECT_EQ(beside(0.72).evidence.limit_tenth_mm, 7000);
    const auto far = [&](double height_m) {  // beyond the frame
        Terrain floor;
        floor.box(-0.1, 0.3, 0.55, 0.60, height_m);
        return ask_with(machine, floor);
    };
    expect_ok(far(1.5));
    // Both parts at once: the reported part is the one whose limit is broken by more.
    Terrain wall;
    wall.box(0.5, 0.6, -0.5, 0.5, 1.5);
    expect_refused(ask_with(machine, wall), Reason::corridor_blocked);
    EXPECT_TRUE(ask_with(machine, wall).reasons.contains(Reason::body_clearance));
}

TEST(GateBody, what_hangs_meets_the_part_that_is_as_high_and_is_said_to_hang) {
    const Machine machine = with_legs_and_frame();
    const auto hanging = [&](double y0, double y1, double clearance_m) {
        Terrain floor;
        floor.paint(floor.clearance, -0.1, 0.3, y0, y1, clearance_m + 1e-5);
        return ask_with(machine, floor);
    };
    expect_ok(hanging(0.33, 0.40, 2.06));
    const Verdict frame = hanging(0.33, 0.40, 1.9);
    expect_refused(frame, Reason::body_clearance);
    EXPECT_TRUE(frame.evidence.overhead);
    EXPECT_EQ(frame.evidence.value_tenth_mm, 19'000);
    EXPECT_EQ(frame.evidence.limit_tenth_mm, 20'500);
    Terrain floor;
    floor.paint(floor.clearance, -0.1, 0.3, 0.33, 0.40, 1.9);
    const auto map = floor.snapshot();
    const Query query = query_at_body(kForward, *map);
    EXPECT_NE(text_of(frame, query, machine).find("only 1.90 m of room"), std::string::npos)
        << text_of(frame, query, machine);
    expect_ok(hanging(0.55, 0.60, 0.5));
}

TEST(GateBody, what_hangs_low_meets_a_lifted_foot_where_no_part_of_the_body_comes) {
    Machine machine = with_legs_and_frame();
    machine.body.parts[0].box = machine.body.parts[1].box = {-2000, 0, 1000, 1000};
    const auto hanging = [&](double clearance_m) {  // over the landing toes
        Terrain floor;
        floor.paint(floor.clearance, 0.58, 0.62, 0.1, 0.25, clearance_m);
        return ask_with(machine, floor);
    };
    expect_ok(hanging(0.19));  // legs begin at 0.144, a foot is lifted by 0.04
    const Verdict low = hanging(0.18);
    expect_refused(low, Reason::corridor_blocked);
    EXPECT_TRUE(low.evidence.overhead);
}

}  // namespace
}  // namespace surefoot::gate::testing
