// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "service/gate_process/channel/snapshot_channel.hpp"
#include "service/gate_process/sockets/token_bucket.hpp"
#include "service/gate_process/step_gate.hpp"
#include "surefoot/core/machine.hpp"
#include "surefoot/gate/attestation.hpp"
#include "surefoot/gate/canary.hpp"
#include "surefoot/gate/readiness.hpp"

namespace surefoot::gate_process {

/// A verdict and its inputs, without the machine and the map.
struct Judgement {
    gate::Query query;
    gate::GateHealth health;
    std::int64_t now_ns = 0;
    gate::Verdict verdict;
};

/// State of the channel from which the gate reads its maps.
enum class ChannelState : std::uint8_t {
    absent,  ///< the channel file does not exist yet
    open,
    lost,   ///< file deleted, replaced or truncated; reopened after perception repaired it
    forged  ///< a snapshot was not made by perception: a fault until an operator re-arms the gate
};

/// The step gate of the gate process. Joins the newest snapshot of the channel, the state machine,
/// the canaries, the operator's attestation and decide(). Use it from one thread. Times are
/// arguments; it reads no clock. Call `poll` every few milliseconds, even without questions.
class Gatekeeper final : public StepGate {
  public:
    /// Called with every verdict about a step; must not block or throw.
    using Audit = std::function<void(const Judgement&, const grid::MapSnapshot&)>;
    /// Called with every act that belongs into the log; must not block or throw.
    using AuditAct = std::function<void(const Act&)>;

    /// Makes the gate of a machine. The channel may be created later.
    Gatekeeper(const Machine& machine,
               const gate::ReadinessLimits& limits,
               ChannelAddress channel,
               Audit audit = {},
               AuditAct audit_act = {});

    /// Reads new snapshots, advances the time and judges a canary every 250 ms. `boottime_ns`:
    /// steady time that includes the time the computer slept.
    void poll(std::int64_t now_ns, std::int64_t boottime_ns);
    /// A gate that requires a log gives no OK (Reason::audit) while the log cannot be written.
    void set_log_failing(bool failing) noexcept { log_failing_ = failing; }
    /// Attests the ground on behalf of the person who starts the process: once, when the gate is
    /// first ready, and never after a fault. An earlier attestation of the operator stays. Returns
    /// an error for a radius that can never be attested.
    [[nodiscard]] Status attest_when_ready(double radius_m);
    /// Ends the gate with its process: no verdict is OK from now on.
    void stop() noexcept { readiness_.stop(); }

    [[nodiscard]] ChannelState channel_state() const noexcept { return channel_state_; }

    [[nodiscard]] Answer ask_step(const StepQuestion& question, std::int64_t now_ns) override;
    [[nodiscard]] Answer ask_goal(const GoalQuestion& question, std::int64_t now_ns) override;
    [[nodiscard]] std::span<const std::uint8_t> movements() const noexcept override;
    [[nodiscard]] Prospect prospect_of(std::uint8_t command,
                                       std::int64_t now_ns) const noexcept override;
    [[nodiscard]] std::string words_of(const Prospect& prospect) const override;
    [[nodiscard]] GateReport report(std::int64_t now_ns) override;
    [[nodiscard]] Status rearm(std::uint64_t connection, std::int64_t now_ns) override;
    [[nodiscard]] Status attest(std::uint64_t connection,
                                double radius_m,
                                std::int64_t now_ns) override;
    void forget(std::uint64_t connection) override { sequences_.erase(connection); }
    /// Passes on at most 100 acts of outcome `no_right` at once and 10 a second on average, so that
    /// no client can fill the log. The next logged act contains the number of omitted acts.
    void note(const Act& act) override;

  private:
    void fetch(std::int64_t now_ns);
    void open_channel(std::int64_t now_ns);
    [[nodiscard]] SnapshotReader::Read read_channel(std::int64_t now_ns);
    [[nodiscard]] bool has_arrived(SnapshotReader::Read read, std::int64_t now_ns) noexcept;
    void ask_canary(std::int64_t now_ns);
    void give_starters_word(std::int64_t now_ns);
    [[nodiscard]] std::int64_t least_radius_tenth_mm() const;
    [[nodiscard]] Status check_radius(double radius_m) const;
    [[nodiscard]] gate::GateHealth health() const noexcept;
    [[nodiscard]] bool is_in_sequence(const StepQuestion& question);
    [[nodiscard]] Judgement judge(const StepQuestion& question,
                                  bool in_sequence,
                                  std::int64_t now_ns) const noexcept;

    Machine machine_;
    std::array<std::uint8_t, Machine::kMovementCodes> movements_{};  ///< first movement_count_ used
    std::size_t movement_count_ = 0;
    ChannelAddress channel_;
    Audit audit_;
    AuditAct audit_act_;
    TokenBucket refusals_{{10, 100}};  ///< limit of the refused acts that are logged
    std::uint32_t refusals_left_out_ = 0;
    gate::Readiness readiness_;
    gate::Attestation attestation_;
    std::unique_ptr<gate::Canaries> canaries_;
    std::optional<SnapshotReader> reader_;
    ChannelState channel_state_ = ChannelState::absent;
    std::unique_ptr<grid::MapSnapshot> map_;       ///< the newest complete snapshot
    std::unique_ptr<grid::MapSnapshot> incoming_;  ///< the snapshot being read
    bool has_map_ = false;
    bool waits_ = false;          ///< true: the stamp of `incoming_` is later than the last call
    std::uint64_t writer_ = 0;    ///< writer of `map_`
    std::uint64_t given_up_ = 0;  ///< writer that must restart; its maps are rejected
    std::int64_t next_open_ns_ = 0;
    std::int64_t next_canary_ns_ = 0;
    int canary_ = 0;
    std::map<std::uint64_t, std::uint64_t> sequences_;  ///< last sequence of each connection
    double starters_word_m_ = 0.0;  ///< radius still to be attested at the start
    bool log_failing_ = false;
    std::uint64_t asked_ = 0;
    std::uint64_t allowed_ = 0;
};

}  // namespace surefoot::gate_process
