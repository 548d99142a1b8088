// SPDX-License-Identifier: Apache-2.0
// Faults that stay, and how an operator ends them.
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/readiness.hpp"
#include "surefoot/gate/readiness_testing.hpp"

namespace surefoot::gate::testing {
namespace {

TEST(Readiness, a_forged_snapshot_is_a_latched_fault) {
    Station station;
    station.become_ready();
    ASSERT_TRUE(station.allows());
    station.readiness.snapshot_forged(station.now_ns);
    EXPECT_EQ(station.readiness.state(), GateState::fault);
    EXPECT_TRUE(station.readiness.latched().contains(Reason::internal));
    station.frames(5.0);
    EXPECT_FALSE(station.allows()) << "until an operator re-arms";
}

TEST(Readiness, ten_seconds_of_disturbance_are_a_fault_that_stays) {
    Station station;
    station.become_ready();
    station.silence(10.5);
    EXPECT_EQ(station.readiness.state(), GateState::fault);
    station.frames(30.0);
    EXPECT_EQ(station.readiness.state(), GateState::fault);
    EXPECT_FALSE(station.allows());
}

TEST(Readiness, what_is_in_doubt_for_good_is_latched_from_every_state) {
    const auto jump = [](Station& s) {
        s.map->body_x_tenth_mm += 10'000;
        s.frame();
    };
    const auto moved = [](Station& s) {
        s.map->camera = CameraState::moved;
        s.frame();
        s.map->camera = CameraState::ok;
    };
    const auto slept = [](Station& s) {
        s.readiness.clocks(s.now_ns, s.now_ns + 100);
        s.readiness.clocks(s.now_ns + kMs, s.now_ns + kMs + 100 + kSecondNs);
    };
    const auto backwards = [](Station& s) { s.readiness.tick(s.now_ns - kSecondNs); };
    const auto canary = [](Station& s) { s.readiness.self_tested(false, s.now_ns); };
    const auto config = [](Station& s) {
        ++s.map->config_hash;
        s.frame();
    };
    const auto damaged = [](Station& s) {
        ++s.map->version;
        s.readiness.observe(*s.map, s.now_ns);  // the checksum no longer fits
    };
    const auto older = [](Station& s) {
        s.map->version -= 2;
        s.frame();
    };
    const std::pair<Reason, void (*)(Station&)> cases[] = {
        {Reason::pose_jump, jump},
        {Reason::mount_moved, moved},
        {Reason::clock, slept},
        {Reason::clock, backwards},
        {Reason::internal, canary},
        {Reason::config, config},
        {Reason::internal, damaged},
        {Reason::internal, older},
    };
    for (const bool ready : {true, false}) {
        for (const auto& [reason, happen] : cases) {
            SCOPED_TRACE(std::string(to_string(reason)) + (ready ? ", ready" : ", warming up"));
            Station station;
            station.become_ready();
            if (!ready) {
                station.silence(0.3);
                ASSERT_EQ(station.readiness.state(), GateState::degraded);
            }
            happen(station);
            EXPECT_EQ(station.readiness.state(), GateState::fault);
            EXPECT_TRUE(station.readiness.health().faults.contains(reason));
            station.frames(15.0);
            EXPECT_EQ(station.readiness.state(), GateState::fault) << "nothing but an act ends it";
            EXPECT_FALSE(station.allows());
            EXPECT_TRUE(station.readiness.rearm(station.now_ns));
            EXPECT_EQ(station.readiness.state(), GateState::warmup);
            EXPECT_FALSE(station.allows()) << "re-arming allows nothing by itself";
            station.frames(1.9);
            EXPECT_FALSE(station.allows());
            station.frames(0.3);
            EXPECT_TRUE(station.allows());
        }
    }
}

TEST(Readiness, a_fault_of_an_earlier_process_lasts_until_somebody_re_arms) {
    Station station;
    station.readiness.resume_fault(0);
    EXPECT_EQ(station.readiness.state(), GateState::init) << "there was none";
    station.readiness.self_tested(true, station.now_ns);
    ReasonSet kept(Reason::pose_jump);
    kept.add(Reason::clock);
    station.readiness.resume_fault(kept.bits());
    EXPECT_EQ(station.readiness.latched(), kept);
    station.frames(5.0);
    EXPECT_EQ(station.readiness.state(), GateState::fault);
    EXPECT_TRUE(station.ask().reasons.contains(Reason::pose_jump));
    ASSERT_TRUE(station.readiness.rearm(station.now_ns));
    station.frames(3.0);
    EXPECT_TRUE(station.allows());
    for (int i = 0; i < kReasonCount; ++i) {  // every one of them
        const ReasonSet one(static_cast<Reason>(i));
        Station again;
        again.readiness.resume_fault(one.bits());
        EXPECT_EQ(again.readiness.latched(), one) << to_string(static_cast<Reason>(i));
    }
    Station damaged;
    damaged.readiness.resume_fault(std::uint64_t{1} << 63U);  // a bit without a meaning here
    EXPECT_EQ(damaged.readiness.latched(), ReasonSet(Reason::internal));
}

TEST(Readiness, rearming_needs_a_fault_a_self_test_and_a_valid_configuration) {
    Station station;
    EXPECT_FALSE(station.readiness.rearm(station.now_ns));
    station.become_ready();
    EXPECT_FALSE(station.readiness.rearm(station.now_ns)) << "there is nothing to leave";
    EXPECT_EQ(station.readiness.state(), GateState::ready);

    Station untested;
    untested.readiness.self_tested(false, untested.now_ns);
    EXPECT_FALSE(untested.readiness.rearm(untested.now_ns));

    ReadinessLimits wrong;
    wrong.warmup_ns = 0;
    Station misconfigured(wrong);
    misconfigured.readiness.self_tested(true, misconfigured.now_ns);
    misconfigured.frames(5.0);
    EXPECT_EQ(misconfigured.readiness.state(), GateState::fault);
    EXPECT_TRUE(misconfigured.readiness.health().faults.contains(Reason::config));
    EXPECT_FALSE(misconfigured.readiness.rearm(misconfigured.now_ns));
}

TEST(Readiness, a_fault_collects_reasons_and_forgets_them_when_an_operator_ends_it) {
    Station station;
    station.become_ready();
    station.readiness.self_tested(false, station.now_ns);
    station.readiness.tick(station.now_ns - 1);
    EXPECT_TRUE(station.readiness.health().faults.contains(Reason::internal));
    EXPECT_TRUE(station.readiness.health().faults.contains(Reason::clock));
    ASSERT_TRUE(station.readiness.rearm(station.now_ns));
    EXPECT_EQ(station.readiness.health().faults, ReasonSet(Reason::frame_stale));
    EXPECT_EQ(station.readiness.health().state, GateState::warmup);
}

TEST(Readiness, after_an_operator_the_maps_may_begin_anew_elsewhere) {
    Station station;
    station.become_ready();
    station.readiness.self_tested(false, station.now_ns);
    ASSERT_TRUE(station.readiness.rearm(station.now_ns));
    station.map->version = 0;
    station.map->config_hash = 5;
    station.map->body_x_tenth_mm = 70'000;
    station.frames(1.9);
    EXPECT_EQ(station.readiness.state(), GateState::warmup);
    station.frames(0.3);
    EXPECT_EQ(station.readiness.state(), GateState::ready);
}

TEST(Readiness, a_machine_that_is_not_valid_is_a_fault_for_good) {
    Station station({}, Machine{});
    EXPECT_EQ(station.readiness.state(), GateState::fault);
    EXPECT_TRUE(station.readiness.health().faults.contains(Reason::config));
    station.readiness.self_tested(true, station.now_ns);
    EXPECT_EQ(station.readiness.state(), GateState::fault);
    EXPECT_FALSE(station.readiness.rearm(station.now_ns));
}

}  // namespace
}  // namespace surefoot::gate::testing
