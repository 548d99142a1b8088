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

/// A verdict and what it was made of, but for the machine and the map.
struct Judgement {
    gate::Query query;
    gate::GateHealth health;
    std::int64_t now_ns = 0;
    gate::Verdict verdict;
};

/// How the gate finds the channel of its maps.
enum class ChannelState : std::uint8_t {
    absent,  ///< not there yet
    open,
    lost,   ///< deleted, replaced or cut off; opened again when perception has mended it
    forged  ///< a snapshot was not made by perception: a fault, until an operator re-arms the gate
};

/// The step gate of the gate process: newest snapshot of the channel, state machine, canaries, the
/// operator's word, and decide(). One thread; no clock, all times come with the calls. Needs
/// `poll` every few milliseconds, also while nobody asks.
class Gatekeeper final : public StepGate {
  public:
    /// Called with every verdict about a step; must neither wait nor throw.
    using Audit = std::function<void(const Judgement&, const grid::MapSnapshot&)>;
    /// Called with every act that is to be logged; must neither wait nor throw.
    using AuditAct = std::function<void(const Act&)>;

    /// The channel need not be there yet.
    Gatekeeper(const Machine& machine,
               const gate::ReadinessLimits& limits,
               ChannelAddress channel,
               Audit audit = {},
               AuditAct audit_act = {});

    /// Fetches what is new, lets time pass, asks a canary now and then. `boottime_ns` is steady
    /// time with what the computer slept.
    void poll(std::int64_t now_ns, std::int64_t boottime_ns);
    /// An assured gate gives no OK (Reason::audit) while its log cannot be written.
    void set_log_failing(bool failing) noexcept { log_failing_ = failing; }
    /// Whoever starts the process attests the ground: once, when the gate is first ready, and after
    /// a fault not any more. An attestation that the operator gave before then stays. Refuses a
    /// radius that could never be attested.
    [[nodiscard]] Status attest_when_ready(double radius_m);
    /// The process ends: nothing is OK any more.
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
    /// Of refusals a hundred at once and ten a second in the long run are passed on: nobody fills
    /// the log with them. The act that follows tells how many were left out.
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
    std::array<std::uint8_t, Machine::kMovementCodes> movements_{};  ///< the first movement_count_
    std::size_t movement_count_ = 0;
    ChannelAddress channel_;
    Audit audit_;
    AuditAct audit_act_;
    TokenBucket refusals_{{10, 100}};  ///< that are passed on to the log
    std::uint32_t refusals_left_out_ = 0;
    gate::Readiness readiness_;
    gate::Attestation attestation_;
    std::unique_ptr<gate::Canaries> canaries_;
    std::optional<SnapshotReader> reader_;
    ChannelState channel_state_ = ChannelState::absent;
    std::unique_ptr<grid::MapSnapshot> map_;       ///< the newest whole one
    std::unique_ptr<grid::MapSnapshot> incoming_;  ///< being fetched
    bool has_map_ = false;
    bool waits_ = false;          ///< `incoming_` is ahead of the time of the last call
    std::uint64_t writer_ = 0;    ///< whose map it is
    std::uint64_t given_up_ = 0;  ///< writer that was asked to begin anew: not believed any more
    std::int64_t next_open_ns_ = 0;
    std::int64_t next_canary_ns_ = 0;
    int canary_ = 0;
    std::map<std::uint64_t, std::uint64_t> sequences_;  ///< of each connection, the last one
    double starters_word_m_ = 0.0;                      ///< radius that is still to be vouched for
    bool log_failing_ = false;
    std::uint64_t asked_ = 0;
    std::uint64_t allowed_ = 0;
};

}  // namespace surefoot::gate_process
