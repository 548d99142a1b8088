// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "service/gate_process/sockets/acts.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/gate/gate.hpp"

namespace surefoot::gate_process {

/// "May I make this movement now, from where I stand?"
struct StepQuestion {
    std::uint64_t connection = 0;  ///< id of the asking client; never 0, never reused
    std::uint64_t sequence = 0;    ///< increases with every question of a connection
    std::uint8_t command = 0;      ///< joystick code; any value is accepted
};

/// "Can the machine stand there?" A pose in a frame, as in `/move_base_simple/goal`.
struct GoalQuestion {
    std::uint64_t connection = 0;
    std::string frame_id;  ///< only "odom" is accepted
    double x_m = 0.0;      ///< base_link
    double y_m = 0.0;
    double yaw_rad = 0.0;
};

/// A verdict and its text. For a goal it is for display only and never permits a step: it expires
/// when it begins.
struct Answer {
    gate::Verdict verdict;
    std::string text;
};

/// The gate's answer to a movement that no client asked about. For display only: it never permits a
/// step and expires when it begins.
struct Prospect {
    gate::Query query;
    gate::Verdict verdict;
};

/// State of the gate, for topics and pages.
struct GateReport {
    gate::GateHealth health;
    gate::Reason why = gate::Reason::not_ready;  ///< primary reason against an OK, or `none`
    std::uint64_t map_version = 0;
    std::int64_t frame_age_ns = -1;  ///< age of the last snapshot; -1 = none yet
    std::int64_t pose_age_ns = -1;
    bool attestation = false;     ///< an operator attestation is valid
    gate::AttestedArea attested;  ///< attested area in odom; inactive without an attestation
    std::uint64_t asked = 0;
    std::uint64_t allowed = 0;
};

/// The interface of the service to the gate; use it from one thread. Every call returns within a
/// millisecond and never waits for a disk, a network or perception. `now_ns`: steady clock.
class StepGate {
  public:
    StepGate() = default;
    StepGate(const StepGate&) = delete;
    StepGate& operator=(const StepGate&) = delete;
    virtual ~StepGate() = default;

    /// A sequence that does not increase within its connection gets ERROR / SEQ.
    [[nodiscard]] virtual Answer ask_step(const StepQuestion& question, std::int64_t now_ns) = 0;
    [[nodiscard]] virtual Answer ask_goal(const GoalQuestion& question, std::int64_t now_ns) = 0;
    /// Command codes of the machine's movements in ascending order; constant.
    [[nodiscard]] virtual std::span<const std::uint8_t> movements() const noexcept = 0;
    /// Changes no state that later answers use. Not counted, not logged; allocates nothing.
    [[nodiscard]] virtual Prospect prospect_of(std::uint8_t command,
                                               std::int64_t now_ns) const noexcept = 0;
    /// The text of a prospect.
    [[nodiscard]] virtual std::string words_of(const Prospect& prospect) const = 0;
    [[nodiscard]] virtual GateReport report(std::int64_t now_ns) = 0;
    /// An operator's request after a fault: restarts the warm-up. Never starts a motion. The caller
    /// has checked the client's role.
    [[nodiscard]] virtual Status rearm(std::uint64_t connection, std::int64_t now_ns) = 0;
    /// The operator attests that the ground within `radius_m` of base_link is safe to stand on.
    /// Replaces the previous attestation; a refused one changes nothing. Refused if the area does
    /// not hold both soles, exceeds the machine file's limit (0: attestations are off), or if the
    /// pose is unknown. The caller has checked the client's role.
    [[nodiscard]] virtual Status attest(std::uint64_t connection,
                                        double radius_m,
                                        std::int64_t now_ns) = 0;
    /// The client has disconnected: answers to it are no longer valid.
    virtual void forget(std::uint64_t connection) = 0;
    /// Records an act or a refused act in the audit log.
    virtual void note(const Act& act) = 0;
};

}  // namespace surefoot::gate_process
