// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/readiness.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/readiness_testing.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(Readiness, nothing_is_allowed_before_the_self_test_and_the_whole_warm_up) {
    Station station;
    station.frames(10.0);
    EXPECT_EQ(station.readiness.state(), GateState::init);
    EXPECT_FALSE(station.allows());
    station.readiness.self_tested(true, station.now_ns);
    EXPECT_EQ(station.readiness.state(), GateState::warmup);
    EXPECT_TRUE(station.ask().reasons.contains(Reason::warmup));
}

TEST(Readiness, ground_that_is_not_where_the_soles_are_is_no_ground) {
    for (const auto& [height_m, believed] : {std::pair{0.0, true},
                                             {0.099, true},  // a step of 20 mm and 80 mm of knee
                                             {-0.099, true},
                                             {0.101, false},
                                             {-0.101, false},
                                             {0.96, false}}) {  // a table top under both feet
        Terrain terrain;
        terrain.height.fill(static_cast<float>(height_m));
        Station station;
        station.map = terrain.snapshot();
        station.map->version = 0;
        station.become_ready();
        EXPECT_EQ(station.allows(), believed) << height_m;
        EXPECT_EQ(station.readiness.health().faults.contains(Reason::plane_invalid), !believed)
            << height_m;
        // The ground returns to the height of the soles.
        terrain.height.fill(0.0F);
        const std::uint64_t version = station.map->version;
        station.map = terrain.snapshot();
        station.map->version = version;
        station.frames(5.0);
        EXPECT_TRUE(station.allows()) << height_m;
    }
    // Unmeasured ground has no height to compare with, except from an operator: the cells decide.
    Terrain unseen;
    unseen.box(-0.5, 0.5, -0.5, 0.5, static_cast<double>(kNanF));
    EXPECT_TRUE(snapshot_faults(rex(), *unseen.snapshot(), kNowNs).empty());
}

TEST(Readiness, every_disturbance_inhibits_at_once_and_is_released_after_a_second) {
    struct Case {
        Reason reason;
        void (*disturb)(grid::MapSnapshot&);
        void (*mend)(grid::MapSnapshot&);
    };
    const Case cases[] = {
        {Reason::blind,
         [](auto& m) { m.camera = CameraState::dark; },
         [](auto& m) { m.camera = CameraState::ok; }},
        {Reason::frame_frozen,
         [](auto& m) { m.camera = CameraState::frozen; },
         [](auto& m) { m.camera = CameraState::ok; }},
        {Reason::pose_lost,
         [](auto& m) { m.health = grid::SnapshotHealth::lost; },
         [](auto& m) { m.health = grid::SnapshotHealth::ok; }},
        {Reason::not_ready,
         [](auto& m) { m.health = grid::SnapshotHealth::degraded; },
         [](auto& m) { m.health = grid::SnapshotHealth::ok; }},
        {Reason::plane_invalid,
         [](auto& m) { m.gravity_source = grid::GravitySource::assumed; },
         [](auto& m) { m.gravity_source = grid::GravitySource::imu; }},
    };
    for (const Case& c : cases) {
        SCOPED_TRACE(to_string(c.reason));
        Station station;
        station.become_ready();
        ASSERT_TRUE(station.allows());
        c.disturb(*station.map);
        station.frame();
        EXPECT_EQ(station.readiness.state(), GateState::degraded);
        EXPECT_TRUE(station.ask().reasons.contains(c.reason)) << words(station.ask());
        c.mend(*station.map);
        station.frames(0.9);
        EXPECT_FALSE(station.allows()) << "released too soon";
        EXPECT_TRUE(station.ask().reasons == ReasonSet(Reason::not_ready)) << words(station.ask());
        station.frames(0.3);
        EXPECT_EQ(station.readiness.state(), GateState::ready);
        EXPECT_TRUE(station.allows());
    }
}

TEST(Readiness, silence_inhibits_within_a_quarter_of_a_second) {
    Station station;
    station.become_ready();
    const std::int64_t last_ns = station.now_ns;
    while (station.readiness.state() == GateState::ready) station.silence(0.01);
    EXPECT_LE(station.now_ns - last_ns, 250 * kMs);
    EXPECT_EQ(station.readiness.state(), GateState::degraded);
    EXPECT_TRUE(station.readiness.health().faults.contains(Reason::frame_stale));
    EXPECT_TRUE(station.readiness.health().faults.contains(Reason::pose_stale));
    station.frames(1.3);
    EXPECT_EQ(station.readiness.state(), GateState::ready);
}

TEST(Readiness, a_machine_in_mid_step_may_not_begin_another_and_nothing_is_wrong) {
    Station station;
    station.become_ready();
    ASSERT_TRUE(station.allows());
    station.map->camera = CameraState::leaning;
    station.frames(60.0);
    EXPECT_EQ(station.readiness.state(), GateState::ready);
    EXPECT_FALSE(station.allows());
    station.map->camera = CameraState::ok;
    station.frame();
    EXPECT_TRUE(station.allows());
}

TEST(Readiness, stopping_is_for_good) {
    Station station;
    station.become_ready();
    station.readiness.stop();
    station.frames(5.0);
    station.readiness.self_tested(false, station.now_ns);
    EXPECT_FALSE(station.readiness.rearm(station.now_ns));
    EXPECT_EQ(station.readiness.state(), GateState::stopping);
    EXPECT_FALSE(station.allows());
}

TEST(Readiness, begins_with_a_reason_against_everything) {
    const Station station;
    EXPECT_EQ(station.readiness.state(), GateState::init);
    EXPECT_EQ(station.readiness.health().faults, ReasonSet(Reason::not_ready));
}

}  // namespace
}  // namespace surefoot::gate::testing
