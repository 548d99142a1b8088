// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/readiness.hpp"

namespace surefoot::gate {
namespace {

/// Returns the difference of two stamps. Unsigned arithmetic cannot overflow.
constexpr std::uint64_t gap(std::int64_t later, std::int64_t earlier) noexcept {
    return static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier);
}

constexpr double magnitude(double value) noexcept {
    return value < 0.0 ? -value : value;
}

}  // namespace

const char* ReadinessLimits::problem() const noexcept {
    constexpr std::int64_t kSecond = 1'000'000'000;
    if (!detail::within(warmup_ns, kSecond / 2, 60 * kSecond) ||
        !detail::within(recover_ns, kSecond / 2, 60 * kSecond))
        return "warmup_ns and recover_ns must be from 500000000 (0.5 s) to 60000000000 (60 s)";
    if (!detail::within(warmup_frames, 5, 10'000) || !detail::within(recover_frames, 5, 10'000))
        return "warmup_frames and recover_frames must be from 5 to 10000";
    if (!(warmup_timeout_ns > warmup_ns && warmup_timeout_ns <= 600 * kSecond) ||
        !(degraded_timeout_ns > recover_ns && degraded_timeout_ns <= 600 * kSecond))
        return "warmup_timeout_ns must be above warmup_ns, degraded_timeout_ns above recover_ns, "
               "and both at most 600 s";
    if (!detail::within(fastest_m_s, 0.01, 5.0) || !detail::within(fastest_rad_s, 0.01, 10.0))
        return "fastest_m_s must be from 0.01 to 5 m/s, and fastest_rad_s from 0.01 to 10 rad/s";
    if (!detail::within(jump_m, 0.001, 0.1) || !detail::within(jump_rad, 0.001, 0.2))
        return "jump_m must be from 0.001 to 0.1 m, and jump_rad from 0.001 to 0.2 rad";
    if (!detail::within(clock_gap_ns, kSecond / 1000, kSecond))
        return "clock_gap_ns must be from 1000000 (1 ms) to 1000000000 (1 s)";
    return nullptr;
}

Readiness::Readiness(const Machine& machine, const ReadinessLimits& limits) noexcept
    : machine_(machine),
      limits_(limits),
      config_valid_(machine.problem() == nullptr && limits.problem() == nullptr) {
    present_.add(Reason::not_ready);
    if (!config_valid_) latch(Reason::config, 0);
}

void Readiness::enter(GateState state, std::int64_t now_ns) noexcept {
    if (state_ == GateState::stopping) return;
    state_ = state;
    entered_ns_ = now_ns;
    well_frames_ = 0;
}

void Readiness::latch(Reason reason, std::int64_t now_ns) noexcept {
    latched_.add(reason);
    if (state_ != GateState::fault) enter(GateState::fault, now_ns);
}

bool Readiness::time_runs(std::int64_t now_ns) noexcept {
    if (now_ns < now_ns_) {
        latch(Reason::clock, now_ns_);
        return false;
    }
    now_ns_ = now_ns;
    return true;
}

void Readiness::self_tested(bool passed, std::int64_t now_ns) noexcept {
    if (!time_runs(now_ns)) return;
    if (!passed) {
        latch(Reason::internal, now_ns);
        return;
    }
    tested_ = true;
    if (state_ == GateState::init) enter(GateState::warmup, now_ns);
}

void Readiness::observe(const grid::MapSnapshot& map, std::int64_t now_ns) noexcept {
    if (!time_runs(now_ns)) return;
    present_ = snapshot_faults(machine_, map, now_ns);
    for (int i = 0; i < kReasonCount; ++i) {
        const auto reason = static_cast<Reason>(i);
        if (present_.contains(reason) && is_latched(reason)) latch(reason, now_ns);
    }
    // The fields of a damaged snapshot have no meaning, so they are not compared with the previous
    // snapshot.
    if (!present_.contains(Reason::internal)) check_succession(map, now_ns);
    judge(now_ns);
}

/// Tests that a snapshot is a valid successor of the previous one.
void Readiness::check_succession(const grid::MapSnapshot& map, std::int64_t now_ns) noexcept {
    if (last_.any) {
        if (map.config_hash != last_.config_hash) latch(Reason::config, now_ns);
        if (map.version <= last_.version || map.frame_time_ns < last_.frame_time_ns ||
            map.pose_time_ns < last_.pose_time_ns)
            latch(Reason::internal, now_ns);
        else if (has_jumped(map))
            latch(Reason::pose_jump, now_ns);
    }
    if (present_.empty() && (!last_.any || map.frame_time_ns > last_.frame_time_ns)) {
        if (well_frames_ == 0) well_since_ns_ = now_ns;
        if (well_frames_ < 1'000'000) ++well_frames_;
    }
    last_ = {true,
             map.version,
             map.config_hash,
             map.frame_time_ns,
             map.pose_time_ns,
             map.body_x_tenth_mm,
             map.body_y_tenth_mm,
             map.body_z_tenth_mm,
             map.body_cos_yaw,
             map.body_sin_yaw};
}

bool Readiness::has_jumped(const grid::MapSnapshot& map) const noexcept {
    constexpr double kTenthMmPerM = 1e4;
    const double time_s = static_cast<double>(gap(map.pose_time_ns, last_.pose_time_ns)) * 1e-9;
    const double reach_m = limits_.fastest_m_s * time_s + limits_.jump_m;
    const double dx_m = static_cast<double>(map.body_x_tenth_mm - last_.x_tenth_mm) / kTenthMmPerM;
    const double dy_m = static_cast<double>(map.body_y_tenth_mm - last_.y_tenth_mm) / kTenthMmPerM;
    const double dz_m = static_cast<double>(map.body_z_tenth_mm - last_.z_tenth_mm) / kTenthMmPerM;
    if (!(dx_m * dx_m + dy_m * dy_m + dz_m * dz_m <= reach_m * reach_m)) return true;
    const double turn_rad = limits_.fastest_rad_s * time_s + limits_.jump_rad;
    constexpr double kQuarter_rad = 1.5;  // from this limit on, every turn is allowed
    if (turn_rad >= kQuarter_rad) return false;
    // sin(x) <= x, so a turn slightly above the limit can stay undetected: up to 5 % more for a
    // limit up to 0.5 rad, up to a right angle for a limit from 1 rad on.
    const double sine = last_.cos_yaw * map.body_sin_yaw - last_.sin_yaw * map.body_cos_yaw;
    const double cosine = last_.cos_yaw * map.body_cos_yaw + last_.sin_yaw * map.body_sin_yaw;
    return !(magnitude(sine) <= turn_rad && cosine > 0.0);
}

void Readiness::snapshot_forged(std::int64_t now_ns) noexcept {
    if (time_runs(now_ns)) latch(Reason::internal, now_ns);
}

void Readiness::tick(std::int64_t now_ns) noexcept {
    if (!time_runs(now_ns)) return;
    present_.add(stale_stamps(now_ns));
    judge(now_ns);
}

ReasonSet Readiness::stale_stamps(std::int64_t now_ns) const noexcept {
    ReasonSet stale;
    const auto is_old = [now_ns](std::int64_t stamp_ns, std::int64_t limit_ns) {
        return stamp_ns <= now_ns && gap(now_ns, stamp_ns) > static_cast<std::uint64_t>(limit_ns);
    };
    if (!last_.any || is_old(last_.frame_time_ns, machine_.limits.frame_age_ns))
        stale.add(Reason::frame_stale);
    if (!last_.any || is_old(last_.pose_time_ns, machine_.limits.pose_age_ns))
        stale.add(Reason::pose_stale);
    return stale;
}

void Readiness::clocks(std::int64_t monotonic_ns, std::int64_t boottime_ns) noexcept {
    const auto slept_ns = static_cast<std::int64_t>(gap(boottime_ns, monotonic_ns));
    if (clocks_known_) {
        const auto gap_ns = static_cast<std::int64_t>(gap(slept_ns, slept_ns_));
        if (!(gap_ns >= -limits_.clock_gap_ns && gap_ns <= limits_.clock_gap_ns))
            latch(Reason::clock, now_ns_);
    }
    clocks_known_ = true;
    slept_ns_ = slept_ns;
}

void Readiness::perception_restarted(std::int64_t now_ns) noexcept {
    if (!time_runs(now_ns)) return;
    last_ = Sighting{};
    present_ = ReasonSet(Reason::frame_stale);
    if (state_ == GateState::ready || state_ == GateState::degraded)
        enter(GateState::warmup, now_ns);
    well_frames_ = 0;
}

void Readiness::judge(std::int64_t now_ns) noexcept {
    const bool well = present_.empty();
    if (!well) well_frames_ = 0;
    const auto well_for = [&](std::int64_t wanted_ns, std::int32_t frames) {
        return well && well_frames_ >= frames && now_ns - well_since_ns_ >= wanted_ns;
    };
    const std::int64_t here_ns = now_ns - entered_ns_;
    switch (state_) {
        case GateState::warmup:
            if (well_for(limits_.warmup_ns, limits_.warmup_frames))
                enter(GateState::ready, now_ns);
            else if (here_ns > limits_.warmup_timeout_ns)
                latch(Reason::warmup, now_ns);
            break;
        case GateState::ready:
            if (!well) enter(GateState::degraded, now_ns);
            break;
        case GateState::degraded:
            if (well_for(limits_.recover_ns, limits_.recover_frames))
                enter(GateState::ready, now_ns);
            else if (here_ns > limits_.degraded_timeout_ns)
                latch(Reason::not_ready, now_ns);
            break;
        case GateState::init:
        case GateState::fault:
        case GateState::stopping: break;
    }
}

bool Readiness::rearm(std::int64_t now_ns) noexcept {
    if (!time_runs(now_ns)) return false;
    if (state_ != GateState::fault || !tested_ || !config_valid_) return false;
    latched_ = ReasonSet{};
    last_ = Sighting{};
    present_ = ReasonSet(Reason::frame_stale);
    enter(GateState::warmup, now_ns);
    return true;
}

void Readiness::resume_fault(std::uint64_t bits) noexcept {
    for (int i = 0; i < kReasonCount; ++i) {
        if ((bits >> static_cast<unsigned>(i) & 1U) != 0) latch(static_cast<Reason>(i), now_ns_);
    }
    if (bits >> static_cast<unsigned>(kReasonCount) != 0) latch(Reason::internal, now_ns_);
}

void Readiness::stop() noexcept {
    enter(GateState::stopping, now_ns_);
}

GateHealth Readiness::health() const noexcept {
    GateHealth health{state_, latched_};
    health.faults.add(present_);
    return health;
}

}  // namespace surefoot::gate
