// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "service/gate_process/sockets/acts.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/gate/gate.hpp"

namespace surefoot::gate_process {

/// The question "May I make this movement now, from my present pose?"
struct StepQuestion {
    std::uint64_t connection = 0;  ///< id of the asking client; never 0, never reused
    std::uint64_t sequence = 0;    ///< increases with every question of a connection
    std::uint8_t command = 0;      ///< joystick code; any value is accepted
};

/// The question "Can the machine stand there?": a pose, as in `/move_base_simple/goal`.
struct GoalQuestion {
    std::uint64_t connection = 0;
    std::string frame_id;  ///< only "odom" is accepted
    double x_m = 0.0;      ///< base_link
    double y_m = 0.0;
    double yaw_rad = 0.0;
};

/// A verdict and its text. A verdict about a goal is for display only and never permits a step: it
/// expires at the time of the decision.
struct Answer {
    gate::Verdict verdict;
    std::string text;
};

/// The gate's answer to a movement that no client asked about. For display only: the answer never
/// permits a step and expires at the time of the decision.
struct Prospect {
    gate::Query query;
    gate::Verdict verdict;
};

/// State of the gate, for topics and pages.
struct GateReport {
    gate::GateHealth health;
    gate::Reason why = gate::Reason::not_ready;  ///< first reason against OK, or `none`
    std::uint64_t map_version = 0;
    std::int64_t frame_age_ns = -1;  ///< age of the last snapshot; -1 = no snapshot yet
    std::int64_t pose_age_ns = -1;
    bool attestation = false;     ///< true: an operator attestation is valid
    gate::AttestedArea attested;  ///< attested area in odom; inactive without an attestation
    std::uint64_t asked = 0;
    std::uint64_t allowed = 0;
};

/// The interface of the service to the gate. Use it from one thread. Every call except `rearm`
/// returns within 1 ms. No call waits for a disk, a network or perception. `now_ns`: steady clock.
class StepGate {
  public:
    StepGate() = default;
    StepGate(const StepGate&) = delete;
    StepGate& operator=(const StepGate&) = delete;
    virtual ~StepGate() = default;

    /// Answers a question. If the sequence does not increase in its connection: ERROR / SEQ.
    [[nodiscard]] virtual Answer ask_step(const StepQuestion& question, std::int64_t now_ns) = 0;
    [[nodiscard]] virtual Answer ask_goal(const GoalQuestion& question, std::int64_t now_ns) = 0;
    /// Returns the command codes of the machine's movements in ascending order; constant.
    [[nodiscard]] virtual std::span<const std::uint8_t> movements() const noexcept = 0;
    /// Judges a movement for display. Keeps no state for later answers; does not log or allocate.
    [[nodiscard]] virtual Prospect prospect_of(std::uint8_t command,
                                               std::int64_t now_ns) const noexcept = 0;
    /// Returns the text of a prospect.
    [[nodiscard]] virtual std::string words_of(const Prospect& prospect) const = 0;
    [[nodiscard]] virtual GateReport report(std::int64_t now_ns) = 0;
    /// Re-arms the gate for an operator after a fault: restarts the warm-up, never starts a motion.
    /// The caller has checked the client's role.
    [[nodiscard]] virtual Status rearm(std::uint64_t connection, std::int64_t now_ns) = 0;
    /// Attests, for the operator, that the ground within `radius_m` of base_link is safe to stand
    /// on. Replaces the previous attestation; a refusal changes nothing. Refused if the area does
    /// not contain both soles or exceeds the machine file's limit (0: attestations are off), if the
    /// map has a fault, or in FAULT. The caller has checked the client's role.
    [[nodiscard]] virtual Status attest(std::uint64_t connection,
                                        double radius_m,
                                        std::int64_t now_ns) = 0;
    /// Forgets a client that has disconnected, with the last sequence of its questions.
    virtual void forget(std::uint64_t connection) = 0;
    /// Records an act or a refused act in the audit log.
    virtual void note(const Act& act) = 0;
};

}  // namespace surefoot::gate_process
