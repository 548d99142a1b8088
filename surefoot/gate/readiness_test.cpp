// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/readiness.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/time.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;
constexpr std::int64_t kFrameNs = kSecondNs / 15;

/// A perception that publishes at 15 Hz, the gate's state machine behind it, and their clock.
class Station {
  public:
    explicit Station(const ReadinessLimits& limits = {}, const Machine& machine = rex())
        : map(Terrain{}.snapshot()), readiness(machine, limits) {
        map->version = 0;
    }
    /// One frame: a newer snapshot, stamped as perception would.
    void frame(std::int64_t age_ns = 50 * kMs) {
        now_ns += kFrameNs;
        ++map->version;
        map->frame_time_ns = now_ns - age_ns;
        map->pose_time_ns = now_ns - age_ns;
        seal(*map);
        readiness.observe(*map, now_ns);
    }
    void frames(double seconds) {
        const std::int64_t end_ns = now_ns + static_cast<std::int64_t>(seconds * 1e9);
        while (now_ns + kFrameNs <= end_ns) frame();
    }
    /// Nothing comes; the gate looks every 10 ms.
    void silence(double seconds) {
        const std::int64_t end_ns = now_ns + static_cast<std::int64_t>(seconds * 1e9);
        while (now_ns < end_ns) {
            now_ns += 10 * kMs;
            readiness.tick(now_ns);
        }
    }
    void become_ready() {
        readiness.self_tested(true, now_ns);
        frames(3.0);
    }
    /// What a question gets now.
    [[nodiscard]] Verdict ask() const {
        return decide(rex(), query_at_body(kForward, *map), *map, readiness.health(), now_ns + kMs);
    }
    [[nodiscard]] bool allows() const { return ask().allows_step(now_ns + kMs); }

    std::unique_ptr<grid::MapSnapshot> map;
    Readiness readiness;
    std::int64_t now_ns = kNowNs;
};

TEST(Readiness, nothing_is_allowed_before_the_self_test_and_the_whole_warm_up) {
    Station station;
    station.frames(10.0);
    EXPECT_EQ(station.readiness.state(), GateState::init);
    EXPECT_FALSE(station.allows());
    station.readiness.self_tested(true, station.now_ns);
    EXPECT_EQ(station.readiness.state(), GateState::warmup);
    EXPECT_TRUE(station.ask().reasons.contains(Reason::warmup));
}

TEST(Readiness, warm_up_takes_two_seconds_and_twenty_frames) {
    Station station;
    station.readiness.self_tested(true, station.now_ns);
    const std::int64_t start_ns = station.now_ns;
    while (station.readiness.state() == GateState::warmup) station.frame();
    EXPECT_EQ(station.readiness.state(), GateState::ready);
    EXPECT_TRUE(station.allows());
    EXPECT_GE(station.now_ns - start_ns, 2 * kSecondNs);
    EXPECT_LE(station.now_ns - start_ns, 2 * kSecondNs + 2 * kFrameNs);

    // At 5 Hz twenty frames take four seconds.
    Station slow;
    slow.readiness.self_tested(true, slow.now_ns);
    for (int i = 0; i < 19; ++i) {
        slow.now_ns += 2 * kFrameNs;
        slow.frame();
    }
    EXPECT_EQ(slow.readiness.state(), GateState::warmup);
    slow.now_ns += 2 * kFrameNs;
    slow.frame();
    EXPECT_EQ(slow.readiness.state(), GateState::ready);
}

TEST(Readiness, one_bad_sample_while_warming_up_begins_it_anew) {
    Station station;
    station.readiness.self_tested(true, station.now_ns);
    station.frames(1.9);
    station.map->camera = CameraState::overexposed;
    station.frame();
    station.map->camera = CameraState::ok;
    station.frames(1.9);
    EXPECT_EQ(station.readiness.state(), GateState::warmup);
    station.frames(0.3);
    EXPECT_EQ(station.readiness.state(), GateState::ready);
}

TEST(Readiness, a_warm_up_that_does_not_end_is_a_fault_after_a_minute) {
    Station station;
    station.readiness.self_tested(true, station.now_ns);
    station.silence(60.0);
    EXPECT_EQ(station.readiness.state(), GateState::warmup);
    station.silence(0.1);
    EXPECT_EQ(station.readiness.state(), GateState::fault);
    EXPECT_TRUE(station.readiness.health().faults.contains(Reason::warmup));
    station.frames(10.0);
    EXPECT_EQ(station.readiness.state(), GateState::fault);
}

TEST(Readiness, the_same_frame_again_is_not_a_fresh_one) {
    Station station;
    station.readiness.self_tested(true, station.now_ns);
    station.frame();
    const std::int64_t frame_time_ns = station.map->frame_time_ns;
    for (int i = 0; i < 100; ++i) {  // the pose goes on, the depth does not
        station.now_ns += 20 * kMs;
        ++station.map->version;
        station.map->pose_time_ns = station.now_ns;
        station.map->frame_time_ns = frame_time_ns;
        seal(*station.map);
        station.readiness.observe(*station.map, station.now_ns);
    }
    EXPECT_EQ(station.readiness.state(), GateState::warmup);
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

TEST(Readiness, a_walk_is_no_jump_and_the_bounds_hold_both_ways) {
    const ReadinessLimits limits;
    const double reach_m = limits.fastest_m_s * seconds_from_ns(kFrameNs) + limits.jump_m;
    const double turn_rad = limits.fastest_rad_s * seconds_from_ns(kFrameNs) + limits.jump_rad;
    for (const double share : {0.98, 1.02}) {
        for (const int direction : {0, 1, 2, 3}) {
            Station station;
            station.become_ready();
            const auto step = static_cast<std::int64_t>(std::llround(share * reach_m * 1e4));
            if (direction == 0) station.map->body_x_tenth_mm += step;
            if (direction == 1) station.map->body_y_tenth_mm -= step;
            if (direction >= 2) {
                const double yaw_rad = share * turn_rad * (direction == 2 ? 1.0 : -1.0);
                station.map->body_cos_yaw = std::cos(yaw_rad);
                station.map->body_sin_yaw = std::sin(yaw_rad);
            }
            station.frame();
            EXPECT_EQ(station.readiness.state(), share < 1.0 ? GateState::ready : GateState::fault)
                << "direction " << direction;
        }
    }
    Station about;
    about.become_ready();
    about.map->body_cos_yaw = -1.0;  // sin is 0 as for no turn at all
    about.frame();
    EXPECT_EQ(about.readiness.state(), GateState::fault);
}

TEST(Readiness, a_new_perception_means_a_new_warm_up) {
    Station station;
    station.become_ready();
    station.readiness.perception_restarted(station.now_ns);
    EXPECT_EQ(station.readiness.state(), GateState::warmup);
    station.map->version = 0;  // counts anew, in another odom
    station.map->body_x_tenth_mm = -5000;
    station.frames(1.9);
    EXPECT_EQ(station.readiness.state(), GateState::warmup);
    station.frames(0.3);
    EXPECT_EQ(station.readiness.state(), GateState::ready);

    station.silence(11.0);
    station.readiness.perception_restarted(station.now_ns);
    station.map->version = 0;
    station.frames(5.0);
    EXPECT_EQ(station.readiness.state(), GateState::fault) << "a restart is no operator";
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

TEST(Readiness, clocks_that_run_together_are_no_fault) {
    Station station;
    station.become_ready();
    for (int i = 0; i < 100; ++i) {
        station.frame();
        station.readiness.clocks(station.now_ns, station.now_ns + 7 * kSecondNs + i * kMs);
    }
    EXPECT_EQ(station.readiness.state(), GateState::ready);
}

TEST(Readiness, no_limit_can_switch_a_rule_off) {
    EXPECT_EQ(ReadinessLimits{}.problem(), nullptr);
    const auto refused = [](auto change) {
        ReadinessLimits limits;
        change(limits);
        return limits.problem() != nullptr;
    };
    EXPECT_TRUE(refused([](auto& l) { l.warmup_ns = 0; }));
    EXPECT_TRUE(refused([](auto& l) { l.recover_ns = 0; }));
    EXPECT_TRUE(refused([](auto& l) { l.warmup_frames = 0; }));
    EXPECT_TRUE(refused([](auto& l) { l.recover_frames = 0; }));
    EXPECT_TRUE(refused([](auto& l) { l.warmup_timeout_ns = INT64_MAX; }));
    EXPECT_TRUE(refused([](auto& l) { l.warmup_timeout_ns = l.warmup_ns; }));
    EXPECT_TRUE(refused([](auto& l) { l.degraded_timeout_ns = INT64_MAX; }));
    EXPECT_TRUE(refused([](auto& l) { l.degraded_timeout_ns = l.recover_ns; }));
    EXPECT_TRUE(refused([](auto& l) { l.fastest_m_s = 100.0; }));
    EXPECT_TRUE(refused([](auto& l) { l.fastest_rad_s = std::nan(""); }));
    EXPECT_TRUE(refused([](auto& l) { l.jump_m = 10.0; }));
    EXPECT_TRUE(refused([](auto& l) { l.jump_rad = 3.0; }));
    EXPECT_TRUE(refused([](auto& l) { l.clock_gap_ns = INT64_MAX; }));
}

}  // namespace
}  // namespace surefoot::gate::testing
