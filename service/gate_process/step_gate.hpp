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
    std::uint64_t connection = 0;  ///< of the client that asks; never 0, never used again
    std::uint64_t sequence = 0;    ///< grows with every question of a connection
    std::uint8_t command = 0;      ///< joystick code, every value may come
};

/// "Would the machine stand there?" A place in a frame, as `/move_base_simple/goal` names it.
struct GoalQuestion {
    std::uint64_t connection = 0;
    std::string frame_id;  ///< only "odom" is known
    double x_m = 0.0;      ///< base_link
    double y_m = 0.0;
    double yaw_rad = 0.0;
};

/// A verdict and what it says to people. Of a goal it is a picture of the ground, never a
/// permission: its life ends when it begins.
struct Answer {
    gate::Verdict verdict;
    std::string text;
};

/// What the gate would answer to a movement if somebody asked now. A picture for people, never a
/// permission: nobody asked, and its life ends when it begins.
struct Prospect {
    gate::Query query;
    gate::Verdict verdict;
};

/// How the gate is, for topics and pages.
struct GateReport {
    gate::GateHealth health;
    gate::Reason why = gate::Reason::not_ready;  ///< primary reason why no OK can come, or `none`
    std::uint64_t map_version = 0;
    std::int64_t frame_age_ns = -1;  ///< of the last snapshot; -1 = none came yet
    std::int64_t pose_age_ns = -1;
    bool attestation = false;     ///< an operator's attestation is in force
    gate::AttestedArea attested;  ///< its area, in odom; inactive if none is in force
    std::uint64_t asked = 0;
    std::uint64_t allowed = 0;
};

/// What the service asks of the gate, on one thread. Every call returns within a millisecond: none
/// waits for a disk, a network or perception. `now_ns` is the steady clock.
class StepGate {
  public:
    StepGate() = default;
    StepGate(const StepGate&) = delete;
    StepGate& operator=(const StepGate&) = delete;
    virtual ~StepGate() = default;

    /// A sequence that does not grow within its connection is ERROR / SEQ.
    [[nodiscard]] virtual Answer ask_step(const StepQuestion& question, std::int64_t now_ns) = 0;
    [[nodiscard]] virtual Answer ask_goal(const GoalQuestion& question, std::int64_t now_ns) = 0;
    /// Codes of the machine's movements, in order; the same in every call.
    [[nodiscard]] virtual std::span<const std::uint8_t> movements() const noexcept = 0;
    /// Changes nothing that a question meets, is not counted and in no log; allocates nothing.
    [[nodiscard]] virtual Prospect prospect_of(std::uint8_t command,
                                               std::int64_t now_ns) const noexcept = 0;
    /// What a prospect says to people.
    [[nodiscard]] virtual std::string words_of(const Prospect& prospect) const = 0;
    [[nodiscard]] virtual GateReport report(std::int64_t now_ns) = 0;
    /// The operator's explicit act after a fault: back to warm-up. Never starts a motion. The
    /// caller has checked the client's role.
    [[nodiscard]] virtual Status rearm(std::uint64_t connection, std::int64_t now_ns) = 0;
    /// The operator attests that the ground within `radius_m` of base_link carries. An attestation
    /// replaces the one before; a refused one changes nothing. Refused when the area does not hold
    /// both soles, beyond the limit of the machine file (0: attestations are off), and when no pose
    /// is known. The caller has checked the client's role.
    [[nodiscard]] virtual Status attest(std::uint64_t connection,
                                        double radius_m,
                                        std::int64_t now_ns) = 0;
    /// The client is gone: nothing that was answered to it counts any more.
    virtual void forget(std::uint64_t connection) = 0;
    /// For the audit log: what somebody did, or was refused.
    virtual void note(const Act& act) = 0;
};

}  // namespace surefoot::gate_process
