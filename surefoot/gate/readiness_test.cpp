// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/readiness.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "surefoot/core/time.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate::testing {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;
constexpr std::int64_t kFrameNs = kSecondNs / 15;

/// Perception at 15 Hz, the state machine of the gate, and their common clock.
class Station {
  public:
    explicit Station(const ReadinessLimits& limits = {}, const Machine& machine = rex())
        : map(Terrain{}.snapshot()), readiness(machine, limits) {
        map->version = 0;
    }
    /// Passes one frame: a newer snapshot, with the stamps of perception.
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
    /// No frames; the gate polls every 10 ms.
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
    /// The present verdict of a query.
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

/// docs/evidence/safety.md and surefoot/gate/README.md state these times; the other tests use them.
TEST(Readiness, the_times_are_those_that_are_promised) {
    const ReadinessLimits limits;
    EXPECT_EQ(limits.warmup_ns, 2 * kSecondNs);
    EXPECT_EQ(limits.warmup_frames, 20);
    EXPECT_EQ(limits.warmup_timeout_ns, 60 * kSecondNs);
    EXPECT_EQ(limits.recover_ns, kSecondNs);
    EXPECT_EQ(limits.recover_frames, 10);
    EXPECT_EQ(limits.degraded_timeout_ns, 10 * kSecondNs);
    EXPECT_EQ(limits.clock_gap_ns, 100 * kMs);
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
    for (int i = 0; i < 100; ++i) {  // new poses, but no new depth
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
        for (const int direction : {0, 1, 2, 3, 4}) {
            Station station;
            station.become_ready();
            const auto step = static_cast<std::int64_t>(std::llround(share * reach_m * 1e4));
            if (direction == 0) station.map->body_x_tenth_mm += step;
            if (direction == 1) station.map->body_y_tenth_mm -= step;
            if (direction == 4) {  // the ground moves too; otherwise it is not under the soles
                station.map->body_z_tenth_mm += step;
                station.map->height_tenth_mm.fill(static_cast<std::int32_t>(step));
            }
            if (direction == 2 || direction == 3) {
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
    station.map->version = 0;  // the count restarts in another odom
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

TEST(Readiness, repeated_frames_count_once_though_none_is_stale) {
    Station station;
    station.readiness.self_tested(true, station.now_ns);
    for (int i = 0; i < 12; ++i) {  // 5.3 Hz, each frame in three maps: 36 maps, but 12 frames
        station.now_ns += 120 * kMs;
        station.frame(0);
        const std::int64_t frame_time_ns = station.map->frame_time_ns;
        for (int again = 0; again < 2; ++again) {
            station.now_ns += kMs;
            ++station.map->version;
            station.map->pose_time_ns = station.now_ns;
            station.map->frame_time_ns = frame_time_ns;
            seal(*station.map);
            station.readiness.observe(*station.map, station.now_ns);
        }
    }
    EXPECT_TRUE(station.readiness.health().faults.empty());
    EXPECT_EQ(station.readiness.state(), GateState::warmup);
}

TEST(Readiness, begins_with_a_reason_against_everything) {
    const Station station;
    EXPECT_EQ(station.readiness.state(), GateState::init);
    EXPECT_EQ(station.readiness.health().faults, ReasonSet(Reason::not_ready));
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

TEST(Readiness, a_machine_that_is_not_valid_is_a_fault_for_good) {
    Station station({}, Machine{});
    EXPECT_EQ(station.readiness.state(), GateState::fault);
    EXPECT_TRUE(station.readiness.health().faults.contains(Reason::config));
    station.readiness.self_tested(true, station.now_ns);
    EXPECT_EQ(station.readiness.state(), GateState::fault);
    EXPECT_FALSE(station.readiness.rearm(station.now_ns));
}

TEST(Readiness, a_new_perception_changes_nothing_before_the_self_test) {
    Station station;
    station.readiness.perception_restarted(station.now_ns);
    EXPECT_EQ(station.readiness.state(), GateState::init);
    EXPECT_TRUE(station.readiness.health().faults.contains(Reason::frame_stale));
    // A restart while the gate is degraded also needs the whole warm-up.
    Station disturbed;
    disturbed.become_ready();
    disturbed.silence(0.5);
    ASSERT_EQ(disturbed.readiness.state(), GateState::degraded);
    disturbed.readiness.perception_restarted(disturbed.now_ns);
    EXPECT_EQ(disturbed.readiness.state(), GateState::warmup);
    EXPECT_EQ(disturbed.readiness.health().faults, ReasonSet(Reason::frame_stale));
}

TEST(Readiness, a_new_perception_while_warming_up_begins_the_count_anew) {
    Station station;
    station.readiness.self_tested(true, station.now_ns);
    station.frames(1.9);
    station.readiness.perception_restarted(station.now_ns);
    station.map->version = 0;
    station.frames(1.9);
    EXPECT_EQ(station.readiness.state(), GateState::warmup);
    station.frames(0.3);
    EXPECT_EQ(station.readiness.state(), GateState::ready);
}

TEST(Readiness, the_times_of_warming_up_and_recovering_are_kept_to_the_frame) {
    ReadinessLimits limits;  // times that frames of 15 Hz do not hit, counts that decide
    limits.warmup_frames = 40;
    limits.recover_frames = 25;
    Station station(limits);
    station.readiness.self_tested(true, station.now_ns);
    for (int i = 0; i < 39; ++i) station.frame();
    EXPECT_EQ(station.readiness.state(), GateState::warmup);
    station.frame();
    EXPECT_EQ(station.readiness.state(), GateState::ready);
    station.map->camera = CameraState::dark;
    station.frame();
    station.map->camera = CameraState::ok;
    for (int i = 0; i < 24; ++i) station.frame();
    EXPECT_EQ(station.readiness.state(), GateState::degraded);
    station.frame();
    EXPECT_EQ(station.readiness.state(), GateState::ready);
}

TEST(Readiness, the_times_count_from_the_first_good_frame_to_the_nanosecond) {
    struct Case {
        GateState from;
        std::int64_t wanted_ns;
    };
    const ReadinessLimits limits;
    for (const Case& c : {Case{GateState::warmup, limits.warmup_ns},
                          Case{GateState::degraded, limits.recover_ns}}) {
        for (const std::int64_t missing_ns : {1, 0}) {
            Station station;
            if (c.from == GateState::warmup) {
                station.readiness.self_tested(true, station.now_ns);
                station.map->camera = CameraState::dark;
            } else {
                station.become_ready();
                station.map->camera = CameraState::dark;
            }
            station.frame();
            station.map->camera = CameraState::ok;
            station.frame();
            const std::int64_t first_ns = station.now_ns;
            while (station.now_ns + 2 * kFrameNs < first_ns + c.wanted_ns) station.frame();
            // More frames than required, but too early.
            while (station.now_ns + 2 * kMs < first_ns + c.wanted_ns) {
                station.now_ns += 2 * kMs - kFrameNs;
                station.frame(0);
            }
            ASSERT_EQ(station.readiness.state(), c.from);
            station.now_ns = first_ns + c.wanted_ns - missing_ns - kFrameNs;
            station.frame(0);
            EXPECT_EQ(station.readiness.state(), missing_ns == 0 ? GateState::ready : c.from);
        }
    }
}

TEST(Readiness, waiting_ends_in_a_fault_only_after_the_time_out) {
    Station station;
    station.readiness.self_tested(true, station.now_ns);
    const std::int64_t begun_ns = station.now_ns;
    const ReadinessLimits limits;
    station.readiness.tick(begun_ns + limits.warmup_timeout_ns);
    EXPECT_EQ(station.readiness.state(), GateState::warmup);
    station.readiness.tick(begun_ns + limits.warmup_timeout_ns + 1);
    EXPECT_EQ(station.readiness.state(), GateState::fault);

    Station disturbed;
    disturbed.become_ready();
    disturbed.map->camera = CameraState::dark;
    disturbed.frame();
    const std::int64_t disturbed_ns = disturbed.now_ns;
    ASSERT_EQ(disturbed.readiness.state(), GateState::degraded);
    disturbed.readiness.tick(disturbed_ns + limits.degraded_timeout_ns);
    EXPECT_EQ(disturbed.readiness.state(), GateState::degraded);
    disturbed.readiness.tick(disturbed_ns + limits.degraded_timeout_ns + 1);
    EXPECT_EQ(disturbed.readiness.state(), GateState::fault);
    EXPECT_TRUE(disturbed.readiness.health().faults.contains(Reason::not_ready));
}

TEST(Readiness, after_a_long_gap_any_heading_is_possible_and_not_any_place) {
    const auto after_s = [](double gap_s, double yaw_rad, std::int64_t shift_tenth_mm) {
        Station station;
        station.become_ready();
        station.now_ns += static_cast<std::int64_t>(gap_s * 1e9) - kFrameNs;
        station.map->body_cos_yaw = std::cos(yaw_rad);
        station.map->body_sin_yaw = std::sin(yaw_rad);
        station.map->body_x_tenth_mm += shift_tenth_mm;
        station.frame();
        return station.readiness.state();
    };
    // 0.0524 rad + 1.5708 rad/s: 1.5 rad after 0.9216 s.
    EXPECT_EQ(after_s(0.90, 1.40, 0), GateState::ready);
    EXPECT_EQ(after_s(0.90, 2.50, 0), GateState::fault);
    EXPECT_EQ(after_s(0.95, 2.50, 0), GateState::ready);
    // 0.05 m + 1 m/s.
    EXPECT_EQ(after_s(0.95, 0.0, 9'990), GateState::ready);
    EXPECT_EQ(after_s(0.95, 0.0, 10'010), GateState::fault);
    EXPECT_EQ(after_s(0.50, 0.3, 5'490), GateState::ready);
    EXPECT_EQ(after_s(0.50, 0.3, 5'510), GateState::fault);
}

TEST(Readiness, a_turn_counts_from_the_heading_before) {
    for (const double before_rad : {0.7, 2.4, -2.4}) {
        for (const double turn_rad : {0.15, -0.15, 0.165, -0.165}) {  // 0.1571 rad within 1/15 s
            Station station;
            const auto look = [&station](double yaw_rad) {
                station.map->body_cos_yaw = std::cos(yaw_rad);
                station.map->body_sin_yaw = std::sin(yaw_rad);
            };
            look(before_rad);
            station.become_ready();
            ASSERT_EQ(station.readiness.state(), GateState::ready);
            look(before_rad + turn_rad);
            station.frame();
            EXPECT_EQ(station.readiness.state(),
                      std::abs(turn_rad) < 0.157 ? GateState::ready : GateState::fault)
                << before_rad << " " << turn_rad;
        }
    }
}

TEST(Readiness, every_limit_has_a_range_and_its_ends_are_inside) {
    constexpr std::int64_t kMinute = 60 * kSecondNs;
    const auto is_usable = [](auto set, auto value) {
        ReadinessLimits limits;
        limits.warmup_timeout_ns = limits.degraded_timeout_ns = 10 * kMinute;
        set(limits, value);
        return limits.problem() == nullptr;
    };
    const auto expect_range = [&](const char* name, auto set, auto low, auto high, auto step) {
        EXPECT_TRUE(is_usable(set, low)) << name;
        EXPECT_TRUE(is_usable(set, high)) << name;
        EXPECT_FALSE(is_usable(set, low - step)) << name;
        EXPECT_FALSE(is_usable(set, high + step)) << name;
    };
    constexpr std::int64_t kOne = 1;
    using Limits = ReadinessLimits;
    expect_range(
        "warm-up",
        [](Limits& l, std::int64_t v) { l.warmup_ns = v; },
        kSecondNs / 2,
        kMinute,
        kOne);
    expect_range(
        "recovery",
        [](Limits& l, std::int64_t v) { l.recover_ns = v; },
        kSecondNs / 2,
        kMinute,
        kOne);
    expect_range(
        "frames", [](Limits& l, int v) { l.warmup_frames = v; }, 5, 10'000, 1);
    expect_range(
        "frames to recover", [](Limits& l, int v) { l.recover_frames = v; }, 5, 10'000, 1);
    expect_range(
        "time-out of the warm-up",
        [](Limits& l, std::int64_t v) { l.warmup_timeout_ns = v; },
        Limits{}.warmup_ns + 1,
        10 * kMinute,
        kOne);
    expect_range(
        "time-out of a disturbance",
        [](Limits& l, std::int64_t v) { l.degraded_timeout_ns = v; },
        Limits{}.recover_ns + 1,
        10 * kMinute,
        kOne);
    expect_range(
        "m/s", [](Limits& l, double v) { l.fastest_m_s = v; }, 0.01, 5.0, 1e-6);
    expect_range(
        "rad/s", [](Limits& l, double v) { l.fastest_rad_s = v; }, 0.01, 10.0, 1e-6);
    expect_range(
        "jump", [](Limits& l, double v) { l.jump_m = v; }, 0.001, 0.1, 1e-6);
    expect_range(
        "turn", [](Limits& l, double v) { l.jump_rad = v; }, 0.001, 0.2, 1e-6);
    expect_range(
        "gap between the clocks",
        [](Limits& l, std::int64_t v) { l.clock_gap_ns = v; },
        kSecondNs / 1000,
        kSecondNs,
        kOne);
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
