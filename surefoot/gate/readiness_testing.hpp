// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/gate_testing.hpp"
#include "surefoot/gate/readiness.hpp"

/// Shared by the tests of readiness: perception, the gate's state machine and a clock.
namespace surefoot::gate::testing {

inline constexpr std::int64_t kSecondNs = 1'000'000'000;
inline constexpr std::int64_t kFrameNs = kSecondNs / 15;

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

}  // namespace surefoot::gate::testing
