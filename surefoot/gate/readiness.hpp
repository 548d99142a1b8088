// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/machine.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::gate {

/// Times and counts of healthy input before an OK is possible, and limits of the motion.
/// ASSUMPTION: the times come from the hazard analysis. No valid value of a limit disables a rule.
struct ReadinessLimits {
    std::int64_t warmup_ns = 2'000'000'000;  ///< healthy time before the first OK
    std::int32_t warmup_frames = 20;
    std::int64_t warmup_timeout_ns = 60'000'000'000;  ///< a longer warm-up is a fault
    std::int64_t recover_ns = 1'000'000'000;          ///< healthy time before DEGRADED ends
    std::int32_t recover_frames = 10;
    std::int64_t degraded_timeout_ns = 10'000'000'000;
    /// Largest speed of base_link, and the extra motion between two snapshots that pose errors may
    /// cause. A larger motion is a jump of the pose.
    double fastest_m_s = 1.0;
    double fastest_rad_s = 1.5708;
    double jump_m = 0.050;
    double jump_rad = 0.0524;
    /// Largest change of the difference of the clocks() arguments; if larger, the computer slept.
    std::int64_t clock_gap_ns = 100'000'000;

    /// Returns the first problem of the limits as text, or nullptr if they are valid.
    [[nodiscard]] const char* problem() const noexcept;
};

/// State of the gate process:
/// ```
/// INIT     -- self-test passed --> WARMUP; failed --> FAULT
/// WARMUP   -- healthy for 2 s and 20 frames --> READY; after 60 s --> FAULT
/// READY    -- anything unhealthy --> DEGRADED
/// DEGRADED -- healthy for 1 s and 10 frames --> READY; after 10 s --> FAULT
/// READY or DEGRADED -- perception restarted --> WARMUP
/// FAULT    -- an operator re-arms --> WARMUP
/// any      -- a latched reason --> FAULT; stop() --> STOPPING
/// ```
/// One bad sample ends READY. Only an operator's re-arm releases a FAULT; a full warm-up follows.
/// Pure: times are arguments, nothing is allocated. Use it from one thread.
class Readiness {
  public:
    /// An invalid machine or invalid limits lead to FAULT / CONFIG.
    Readiness(const Machine& machine, const ReadinessLimits& limits) noexcept;

    /// Reports the result of the self-test (canaries), at the start and while running.
    void self_tested(bool passed, std::int64_t now_ns) noexcept;
    /// Processes a new snapshot. Latches a fault if its version is not above the previous version.
    void observe(const grid::MapSnapshot& map, std::int64_t now_ns) noexcept;
    /// Reports a snapshot that perception did not make. Latches a fault.
    void snapshot_forged(std::int64_t now_ns) noexcept;
    /// Processes the passing of time. Call it more often than frames are expected.
    void tick(std::int64_t now_ns) noexcept;
    /// Compares the clock that stops while the computer sleeps with the clock that does not stop.
    void clocks(std::int64_t monotonic_ns, std::int64_t boottime_ns) noexcept;
    /// Reports a restart of perception: odom and map are new.
    void perception_restarted(std::int64_t now_ns) noexcept;
    /// Executes an operator's re-arm request. Returns false and changes nothing if there is no
    /// fault, if the self-test has not passed, or if the configuration is invalid.
    [[nodiscard]] bool rearm(std::int64_t now_ns) noexcept;
    /// Restores the fault of an earlier process from its `latched().bits()`; 0 = no fault. A
    /// restart of the process does not clear a FAULT; only a re-arm does.
    void resume_fault(std::uint64_t bits) noexcept;
    /// Enters the final state, because the process ends.
    void stop() noexcept;

    [[nodiscard]] GateState state() const noexcept { return state_; }
    [[nodiscard]] ReasonSet latched() const noexcept { return latched_; }
    /// Returns the state and all present reasons against an OK.
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
    ReasonSet latched_;  ///< latched reasons of FAULT
    ReasonSet present_;  ///< reasons of the last snapshot and of passing time
    Sighting last_;
    std::int64_t now_ns_ = 0;
    std::int64_t entered_ns_ = 0;     ///< time at which the present state began
    std::int64_t well_since_ns_ = 0;  ///< time of first healthy frame; valid if `well_frames_` > 0
    std::int32_t well_frames_ = 0;
    bool tested_ = false;
    bool config_valid_ = false;
    bool clocks_known_ = false;
    std::int64_t slept_ns_ = 0;
};

}  // namespace surefoot::gate
