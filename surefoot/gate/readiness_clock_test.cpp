// SPDX-License-Identifier: Apache-2.0
// Clocks, and the stamps of snapshots.
#include <gtest/gtest.h>

#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/readiness.hpp"
#include "surefoot/gate/readiness_testing.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(Readiness, clocks_that_run_together_are_no_fault) {
    Station station;
    station.become_ready();
    for (int i = 0; i < 100; ++i) {
        station.frame();
        station.readiness.clocks(station.now_ns, station.now_ns + 7 * kSecondNs + i * kMs);
    }
    EXPECT_EQ(station.readiness.state(), GateState::ready);
}

TEST(Readiness, time_that_runs_backwards_is_a_fault_whoever_brings_it) {
    const auto tested = [](Station& s) { s.readiness.self_tested(true, s.now_ns - 1); };
    const auto observed = [](Station& s) {
        ++s.map->version;
        ++s.map->config_hash;  // is not looked at
        seal(*s.map);
        s.readiness.observe(*s.map, s.now_ns - 1);
    };
    const auto ticked = [](Station& s) { s.readiness.tick(s.now_ns - 1); };
    const auto restarted = [](Station& s) { s.readiness.perception_restarted(s.now_ns - 1); };
    void (*const cases[])(Station&) = {tested, observed, ticked, restarted};
    for (const auto& happen : cases) {
        Station station;
        station.become_ready();
        station.readiness.tick(station.now_ns);  // a second tick at the same moment does not count
        ASSERT_EQ(station.readiness.state(), GateState::ready);
        happen(station);
        EXPECT_EQ(station.readiness.state(), GateState::fault);
        EXPECT_EQ(station.readiness.health().faults, ReasonSet(Reason::clock));
        EXPECT_FALSE(station.readiness.rearm(station.now_ns - 1)) << "an operator's clock as well";
        EXPECT_EQ(station.readiness.state(), GateState::fault);
        EXPECT_TRUE(station.readiness.rearm(station.now_ns));
    }
    Station untested;  // an earlier passed test does not count
    untested.readiness.tick(untested.now_ns);
    untested.readiness.self_tested(true, untested.now_ns - 1);
    EXPECT_EQ(untested.readiness.state(), GateState::fault);
    EXPECT_FALSE(untested.readiness.rearm(untested.now_ns));
}

TEST(Readiness, a_snapshot_must_be_newer_in_every_stamp) {
    const auto next = [](Station& s, std::int64_t frame_ns, std::int64_t pose_ns, int versions) {
        s.now_ns += 10 * kMs;
        s.map->version += static_cast<std::uint64_t>(versions);
        s.map->frame_time_ns += frame_ns;
        s.map->pose_time_ns += pose_ns;
        seal(*s.map);
        s.readiness.observe(*s.map, s.now_ns);
    };
    struct Case {
        std::int64_t frame_ns, pose_ns;
        int versions;
        bool follows;
    };
    const Case cases[] = {{0, 0, 1, true},
                          {1, 1, 1, true},
                          {-1, 0, 1, false},
                          {0, -1, 1, false},
                          {1, 1, 0, false},
                          {1, 1, -1, false}};
    for (const Case& c : cases) {
        Station station;
        station.become_ready();
        next(station, c.frame_ns, c.pose_ns, c.versions);
        EXPECT_EQ(station.readiness.state(), c.follows ? GateState::ready : GateState::fault)
            << c.frame_ns << " " << c.pose_ns << " " << c.versions;
        if (!c.follows) {
            EXPECT_EQ(station.readiness.health().faults, ReasonSet(Reason::internal));
        }
    }
}

TEST(Readiness, each_stamp_grows_stale_at_its_own_age_and_one_of_the_future_never) {
    Station station;
    station.become_ready();
    ++station.map->version;
    station.map->frame_time_ns = station.now_ns - 40 * kMs;
    station.map->pose_time_ns = station.now_ns - 10 * kMs;
    seal(*station.map);
    station.readiness.observe(*station.map, station.now_ns);
    const std::int64_t start_ns = station.now_ns;
    station.readiness.tick(start_ns + 160 * kMs);
    EXPECT_EQ(station.readiness.state(), GateState::ready);
    station.readiness.tick(start_ns + 160 * kMs + 1);
    EXPECT_EQ(station.readiness.health().faults, ReasonSet(Reason::frame_stale));
    station.readiness.tick(start_ns + 190 * kMs);
    EXPECT_EQ(station.readiness.health().faults, ReasonSet(Reason::frame_stale));
    station.readiness.tick(start_ns + 190 * kMs + 1);
    EXPECT_TRUE(station.readiness.health().faults.contains(Reason::pose_stale));

    Station ahead;
    ahead.become_ready();
    ahead.frame(-kSecondNs);
    EXPECT_EQ(ahead.readiness.health().faults, ReasonSet(Reason::time_skew));
    ahead.readiness.tick(ahead.now_ns + 500 * kMs);
    EXPECT_EQ(ahead.readiness.health().faults, ReasonSet(Reason::time_skew));

    Station silent;  // no snapshot came
    silent.readiness.self_tested(true, silent.now_ns);
    silent.readiness.tick(silent.now_ns);
    EXPECT_TRUE(silent.readiness.health().faults.contains(Reason::frame_stale));
    EXPECT_TRUE(silent.readiness.health().faults.contains(Reason::pose_stale));
}

TEST(Readiness, clocks_may_part_by_their_gap_to_either_side) {
    const std::int64_t gap_ns = ReadinessLimits{}.clock_gap_ns;
    for (const std::int64_t sign : {1, -1}) {
        for (const std::int64_t beyond_ns : {0, 1}) {
            Station station;
            station.become_ready();
            const std::int64_t now_ns = station.now_ns;
            station.readiness.clocks(now_ns, now_ns + 5 * kSecondNs);
            EXPECT_EQ(station.readiness.state(), GateState::ready) << "the first look";
            const std::int64_t parted_ns = 5 * kSecondNs + sign * (gap_ns + beyond_ns);
            station.readiness.clocks(now_ns + kMs, now_ns + kMs + parted_ns);
            EXPECT_EQ(station.readiness.state(),
                      beyond_ns == 0 ? GateState::ready : GateState::fault)
                << sign;
        }
    }
}

}  // namespace
}  // namespace surefoot::gate::testing
