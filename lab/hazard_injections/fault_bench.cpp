// SPDX-License-Identifier: Apache-2.0
#include "lab/hazard_injections/fault_bench.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <utility>
#include <vector>

namespace surefoot::experiments {
namespace {

constexpr std::int64_t kTick_ns = 10 * kMs;
constexpr std::int64_t kStart_ns = 1'000'000'000'000;
/// Time limit for the gate to become ready.
constexpr std::int64_t kPatience_ns = 30'000'000'000;
/// Shortest time without a fault before the injection, and the largest random time added to it.
constexpr std::int64_t kWell_ns = 120 * kMs;
constexpr std::int64_t kWellMore_ns = 250 * kMs;
constexpr std::uint64_t kClient = 7;
constexpr std::uint64_t kChooser = 8;  ///< client that asks which movements are allowed

std::string channel_path(std::uint64_t seed) {
    const auto folder = std::filesystem::exists("/dev/shm")
                            ? std::filesystem::path("/dev/shm")
                            : std::filesystem::temp_directory_path();
    return (folder / fmt::format("surefoot_fault_bench_{}_{}", ::getpid(), seed)).string();
}

/// Returns true if a movement leads at most 0.2 m forward or backward, as half steps, turns and
/// steps to the side. The feet then stay within 0.6 m of base_link.
bool is_short(const Movement& movement) {
    return movement.forward_tenth_mm <= 2000 && movement.forward_tenth_mm >= -2000;
}

/// Returns the first reason that is more specific than "the gate is not ready".
gate::Reason cause_of(const gate::Verdict& verdict) {
    for (int i = 0; i < gate::kReasonCount; ++i) {
        const auto reason = static_cast<gate::Reason>(i);
        if (verdict.reasons.contains(reason) && reason != gate::Reason::not_ready) return reason;
    }
    return verdict.primary;
}

}  // namespace

gate::ReadinessLimits fast_warm_up() {
    gate::ReadinessLimits limits;
    limits.warmup_ns = 500 * kMs;
    limits.warmup_frames = 5;
    return limits;
}

GateBench::GateBench(const Machine& machine,
                     const gate::ReadinessLimits& limits,
                     const Plan& plan,
                     std::uint64_t seed)
    : machine_(machine),
      limits_(limits),
      plan_(plan),
      rng_(mix_seed(seed, 1)),
      path_(channel_path(seed)),
      now_ns_(kStart_ns),
      next_tick_ns_(kStart_ns + kTick_ns),
      end_ns_(kStart_ns + kPatience_ns) {
    auto writer = gate_process::SnapshotWriter::create({path_, {}});
    if (!writer) {  // without shared memory the program ends with an error
        fmt::print(stderr, "{}\n", writer.error().message);
        std::exit(1);
    }
    writer_.emplace(std::move(*writer));
    start_gate();
    if (plan_.from_the_start) {
        watching_ = true;
        end_ns_ = kStart_ns + plan_.lasts_ns;
        if (plan_.faulty) fault_ns_ = kStart_ns;
    }
}

GateBench::~GateBench() {
    std::error_code gone;
    std::filesystem::remove(path_, gone);
}

void GateBench::start_gate() {
    keeper_ = std::make_unique<gate_process::Gatekeeper>(
        machine_,
        limits_,
        gate_process::ChannelAddress{path_, {}},
        [this](const auto& judgement, const grid::MapSnapshot& map) {
            if (audit_) audit_(judgement, map);
        });
}

void GateBench::restart_gate() {
    start_gate();
}

void GateBench::pass_until(std::int64_t time_ns) {
    while (next_tick_ns_ <= time_ns && !is_over()) {
        now_ns_ = next_tick_ns_;
        next_tick_ns_ += kTick_ns;
        tick();
    }
    if (!is_over()) now_ns_ = std::max(now_ns_, time_ns);
}

void GateBench::tick() {
    const bool faulty = is_faulty(now_ns_);
    if (faulty && !begun_) {
        begun_ = true;
        if (begin_) begin_();
    }
    const std::int64_t read_ns = now_ns_ + clock_step_ns_;
    keeper_->poll(read_ns, read_ns + slept_ns_);
    if (!watching_ && keeper_->report(read_ns).health.state == gate::GateState::ready)
        begin_watching();
    if (watching_) count(ask_ ? ask_(read_ns, faulty) : ask_step(read_ns));
}

void GateBench::begin_watching() {
    watching_ = true;
    if (plan_.attestation_radius_m > 0.0)
        std::ignore = keeper_->attest(kChooser, plan_.attestation_radius_m, now_ns_);
    std::vector<std::uint8_t> commands;
    for (std::uint8_t code = 1; code < Machine::kMovementCodes; ++code) {
        const Movement& movement = machine_.movements[code];
        const bool wanted = plan_.forward_only ? movement.forward_tenth_mm > 1900
                                               : plan_.any_movement || is_short(movement);
        if (movement.configured && wanted) commands.push_back(code);
    }
    // The client uses the first allowed movement in a random order.
    std::uint64_t asked = 0;
    while (!commands.empty() && command_ == 0) {
        const std::size_t i = rng_.below(commands.size());
        const auto answer = keeper_->ask_step({kChooser, ++asked, commands[i]}, now_ns_);
        if (answer.verdict.allows_step(now_ns_)) command_ = commands[i];
        commands.erase(commands.begin() + static_cast<std::ptrdiff_t>(i));
    }
    std::int64_t at_ns =
        now_ns_ + kWell_ns +
        static_cast<std::int64_t>(rng_.below(static_cast<std::uint64_t>(kWellMore_ns)));
    if (plan_.fault_ns_since_start > 0) at_ns = kStart_ns + plan_.fault_ns_since_start;
    if (plan_.faulty) fault_ns_ = at_ns;
    end_ns_ = at_ns + plan_.lasts_ns;
}

GateBench::Heard GateBench::ask_step(std::uint64_t sequence,
                                     std::uint8_t command,
                                     std::int64_t now_ns) {
    const gate_process::Answer answer = keeper_->ask_step({kClient, sequence, command}, now_ns);
    return {answer.verdict.allows_step(now_ns), cause_of(answer.verdict)};
}

GateBench::Heard GateBench::ask_step(std::int64_t now_ns) {
    return ask_step(++sequence_, command_, now_ns);
}

void GateBench::count(const Heard& heard) {
    if (!is_faulty(now_ns_)) {
        ++outcome_.asked_before;
        outcome_.allowed_before += heard.allowed ? 1 : 0;
        return;
    }
    const std::int64_t since_ns = now_ns_ - fault_ns_;
    ++outcome_.asked_after;
    if (heard.allowed) {
        outcome_.last_allowed_ns = since_ns;
        if (outcome_.latency_ns || since_ns >= plan_.deadline_ns) ++outcome_.allowed_late;
    } else if (!outcome_.latency_ns) {
        outcome_.latency_ns = since_ns;
        outcome_.reason = heard.reason;
        if (plan_.watched_on_ns > 0) end_ns_ = std::min(end_ns_, now_ns_ + plan_.watched_on_ns);
    }
}

}  // namespace surefoot::experiments
