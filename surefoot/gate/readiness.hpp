// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/machine.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::gate {

/// How long everything must be well before an OK may come, and what no machine does. ASSUMPTION:
/// the times are those of the hazard analysis; none of them has a value that switches a rule off.
struct ReadinessLimits {
    std::int64_t warmup_ns = 2'000'000'000;  ///< all well for so long, and for so many frames
    std::int32_t warmup_frames = 20;
    std::int64_t warmup_timeout_ns = 60'000'000'000;  ///< longer is a fault
    std::int64_t recover_ns = 1'000'000'000;          ///< the same after a disturbance
    std::int32_t recover_frames = 10;
    std::int64_t degraded_timeout_ns = 10'000'000'000;
    /// What base_link moves at most: so fast, and between two snapshots so much on top for the
    /// errors of poses. Beyond it the position jumped.
    double fastest_m_s = 1.0;
    double fastest_rad_s = 1.5708;
    double jump_m = 0.050;
    double jump_rad = 0.0524;
    /// The two clocks of the computer drift apart by less unless it slept.
    std::int64_t clock_gap_ns = 100'000'000;

    /// First reason why they cannot be used, in words; nullptr when they can.
    [[nodiscard]] const char* problem() const noexcept;
};

/// The state of the process around the gate:
/// ```
/// INIT ──self-test──► WARMUP ──all well for 2 s and 20 frames──► READY ◄──1 s, 10 frames──
/// DEGRADED
///   │ fails              │ 60 s                                   └──anything not well──────►┘ │
///   10 s └───────────► FAULT ◄┴──────────── a latched reason, from every state
///   ────────────────────┘
///                   └── an operator re-arms ──► WARMUP
/// ```
/// Inhibits at once, releases slowly: one bad sample leaves READY. FAULT is left by `rearm` alone,
/// which starts nothing but a whole warm-up. Pure: time comes with the calls, nothing is allocated.
/// One thread.
class Readiness {
  public:
    /// Limits or a machine that cannot be used end in FAULT / CONFIG.
    Readiness(const Machine& machine, const ReadinessLimits& limits) noexcept;

    /// Known maps were judged: all verdicts right? At the start, and again while running.
    void self_tested(bool passed, std::int64_t now_ns) noexcept;
    /// A snapshot came, of a newer version than the one before.
    void observe(const grid::MapSnapshot& map, std::int64_t now_ns) noexcept;
    /// A snapshot came that was not made by perception: a latched fault.
    void snapshot_forged(std::int64_t now_ns) noexcept;
    /// Nothing came. To be called more often than frames are expected.
    void tick(std::int64_t now_ns) noexcept;
    /// Steady time without and with the time that the computer slept.
    void clocks(std::int64_t monotonic_ns, std::int64_t boottime_ns) noexcept;
    /// Whoever makes the snapshots began anew: another odom, another map.
    void perception_restarted(std::int64_t now_ns) noexcept;
    /// An operator's explicit act. False, and nothing changes, when there is no fault to leave, the
    /// self-test never passed or the configuration is wrong.
    [[nodiscard]] bool rearm(std::int64_t now_ns) noexcept;
    /// `latched().bits()` of an earlier process of this gate that nobody re-armed, 0 = none: a
    /// FAULT does not end because its process did.
    void resume_fault(std::uint64_t bits) noexcept;
    /// For good: the process ends.
    void stop() noexcept;

    [[nodiscard]] GateState state() const noexcept { return state_; }
    [[nodiscard]] ReasonSet latched() const noexcept { return latched_; }
    /// State and all that speaks against an OK now.
    [[nodiscard]] GateHealth health() const noexcept;

  private:
    struct Sighting {
        bool any = false;
        std::uint64_t version = 0;
        std::uint64_t config_hash = 0;
        std::int64_t frame_time_ns = 0;
        std::int64_t pose_time_ns = 0;
        std::int64_t x_tenth_mm = 0;
        std::int64_t y_tenth_mm = 0;
        std::int64_t z_tenth_mm = 0;
        double cos_yaw = 1.0;
        double sin_yaw = 0.0;
    };

    void enter(GateState state, std::int64_t now_ns) noexcept;
    void latch(Reason reason, std::int64_t now_ns) noexcept;
    void check_succession(const grid::MapSnapshot& map, std::int64_t now_ns) noexcept;
    [[nodiscard]] bool has_jumped(const grid::MapSnapshot& map) const noexcept;
    [[nodiscard]] ReasonSet stale_stamps(std::int64_t now_ns) const noexcept;
    void judge(std::int64_t now_ns) noexcept;
    [[nodiscard]] bool time_runs(std::int64_t now_ns) noexcept;

    Machine machine_;
    ReadinessLimits limits_;
    GateState state_ = GateState::init;
    ReasonSet latched_;  ///< of FAULT
    ReasonSet present_;  ///< of the last snapshot, and of time
    Sighting last_;
    std::int64_t now_ns_ = 0;
    std::int64_t entered_ns_ = 0;     ///< the present state
    std::int64_t well_since_ns_ = 0;  ///< meaningful while `well_frames_` > 0
    std::int32_t well_frames_ = 0;
    bool tested_ = false;
    bool config_valid_ = false;
    bool clocks_known_ = false;
    std::int64_t slept_ns_ = 0;
};

}  // namespace surefoot::gate
