// SPDX-License-Identifier: Apache-2.0
// Warming up, recovering, and a perception that begins anew.
#include <gtest/gtest.h>

#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/readiness.hpp"
#include "surefoot/gate/readiness_testing.hpp"

namespace surefoot::gate::testing {
namespace {

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

}  // namespace
}  // namespace surefoot::gate::testing
