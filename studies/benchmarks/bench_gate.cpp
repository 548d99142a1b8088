// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "service/console/source.hpp"
#include "service/gate_process/audit/audit_log.hpp"
#include "studies/benchmarks/bench_result.hpp"
#include "surefoot/grid/snapshot_builder.hpp"

namespace surefoot::app {
namespace {

/// A disk that accepts every write and stores nothing.
class NoDisk final : public gate_process::AuditDisk {
  public:
    Result<std::vector<Entry>> list() override { return std::vector<Entry>{}; }
    Status create(const std::string&) override { return {}; }
    Written write(std::string_view bytes) override { return {bytes.size(), 0}; }
    Status truncate(std::uint64_t) override { return {}; }
    Status sync() override { return {}; }
    void close() override {}
    Status remove(const std::string&) override { return {}; }
};

/// Times the push of one verdict into the audit log. The time is that of the thread that makes the
/// verdicts.
Result<BenchResult> bench_audit_push(const Machine& machine,
                                     const gate_process::AuditedVerdict& audited) {
    constexpr int kRepeats = 2000;
    gate_process::AuditConfig config;
    config.memory_bytes =
        128U << 20U;  // room for all entries, because a push into a full ring copies nothing
    gate_process::AuditLog log(machine, std::make_unique<NoDisk>(), config);
    if (auto status = log.start(); !status) return status.error();
    const BenchResult result{"gate/audit_push", timed(kRepeats, [&] { log.push(audited); })};
    log.stop();
    if (log.report().lost > 0)
        return input_error("bench gate: verdicts were lost, so the timing means nothing");
    return result;
}

/// Returns level ground of 6 x 6 m. All cells are known with a standard deviation of 3 mm.
Result<std::unique_ptr<grid::MapSnapshot>> level_ground(float drift_m) {
    constexpr int kSide = 240;
    const grid::Layer height_m(kSide, kSide, 0.0F);
    const grid::Layer variance_m2(kSide, kSide, 9e-6F);
    const grid::Layer drifts_m(kSide, kSide, drift_m);
    grid::SnapshotInput input;
    input.geometry = {0.025, kSide, kSide, {-3.0, -3.0}};
    input.height_m = height_m.view();
    input.variance_m2 = variance_m2.view();
    input.drift_m = drifts_m.view();
    input.T_odom_body.translation_m.z() = 0.99;
    input.gravity_source = grid::GravitySource::plane;
    input.tilt_sigma_rad = 0.0;
    input.health = grid::SnapshotHealth::ok;
    input.camera = CameraState::ok;
    auto snapshot = std::make_unique<grid::MapSnapshot>();
    if (auto status = grid::build_snapshot(input, *snapshot); !status) return status.error();
    return snapshot;
}

/// Queries all movements in turn, repeatedly. All verdicts must be OK, because only an OK shows
/// that the gate has checked all the ground that the movement needs.
class Asking {
  public:
    Asking(const Machine& machine, const grid::MapSnapshot& map) : machine_(machine), map_(map) {
        health_.state = gate::GateState::ready;
        for (std::size_t i = 1; i < machine.movements.size(); ++i) {
            const auto code = static_cast<std::uint8_t>(i);
            if (gate::movement_for(machine, code) != nullptr) codes_.push_back(code);
        }
    }

    [[nodiscard]] const std::vector<std::uint8_t>& codes() const noexcept { return codes_; }
    void ask(std::uint8_t code) noexcept {
        query_ = gate::query_at_body(code, map_);
        verdict_ = gate::decide(machine_, query_, map_, health_, map_.frame_time_ns);
        if (verdict_.decision != gate::Decision::ok) ++refused_;
    }
    void ask_next() noexcept { ask(codes_[next_++ % codes_.size()]); }
    [[nodiscard]] std::int64_t refused() const noexcept { return refused_; }
    [[nodiscard]] gate_process::AuditedVerdict last() const noexcept {
        return {query_, health_, map_.frame_time_ns, map_, verdict_};
    }

  private:
    const Machine& machine_;
    const grid::MapSnapshot& map_;
    gate::GateHealth health_;
    std::vector<std::uint8_t> codes_;
    std::size_t next_ = 0;
    std::int64_t refused_ = 0;
    gate::Query query_;
    gate::Verdict verdict_;
};

Timing slower(const Timing& a, const Timing& b) noexcept {
    return a.median_ms < b.median_ms ? b : a;
}

/// Evicts the gate's data from the caches, as image processing on all cores would do.
class OtherMemory {
  public:
    void write() noexcept {
        for (std::size_t i = 0; i < words_.size(); i += kLineWords) words_[i] = words_[i] + 1;
    }

  private:
    static constexpr std::size_t kLineWords = 64 / sizeof(std::uint64_t);
    std::vector<std::uint64_t> words_ = std::vector<std::uint64_t>((128U << 20U) / 8U, 1);
};

}  // namespace

Result<std::vector<BenchResult>> bench_gate(const CommonOptions&, Executor&) {
    constexpr int kQuestions = 5200;  // 200 queries of each movement of the REX
    constexpr int kOfOne = 500;
    constexpr int kCold = 260;
    const auto loaded = load_machine("rex");
    if (!loaded) return loaded.error();
    const Machine& machine = (*loaded)->machine;
    const auto sharp = level_ground(0.001F);
    if (!sharp) return sharp.error();
    // With the largest allowed drift the gate checks wider regions for every query.
    const auto drifted = level_ground(1e-4F * static_cast<float>(machine.limits.drift_tenth_mm));
    if (!drifted) return drifted.error();
    Asking asking(machine, **sharp);
    Asking drifting(machine, **drifted);

    std::vector<BenchResult> results;
    results.push_back({"gate/decide_first", timed_once([&] { asking.ask_next(); })});
    results.push_back({"gate/decide", timed(kQuestions, [&] { asking.ask_next(); })});
    Timing slowest;
    for (const std::uint8_t code : asking.codes())
        slowest = slower(slowest, timed(kOfOne, [&] { asking.ask(code); }));
    results.push_back({"gate/decide_slowest_movement", slowest});
    results.push_back({"gate/decide_drifted", timed(kQuestions, [&] { drifting.ask_next(); })});
    OtherMemory other;
    results.push_back({"gate/decide_cold",
                       timed(
                           kCold, [&] { asking.ask_next(); }, [&] { other.write(); })});
    if (const auto refused = asking.refused() + drifting.refused(); refused > 0) {
        return input_error(fmt::format(
            "bench gate: {} verdicts on level ground were not OK, so the timing means nothing",
            refused));
    }
    auto audit_push = bench_audit_push(machine, asking.last());
    if (!audit_push) return audit_push.error();
    results.push_back(std::move(audit_push).value());
    return results;
}

}  // namespace surefoot::app
