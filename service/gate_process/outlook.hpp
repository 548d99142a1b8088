// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "service/gate_process/protocol/subscriptions.hpp"
#include "service/gate_process/step_gate.hpp"

namespace surefoot::gate_process {

/// Conditions under which the outlook may be computed now.
struct OutlookDemand {
    bool subscribed = false;      ///< at least one client subscribes to the outlook
    bool question_waits = false;  ///< a client sent bytes that wait; answers have priority
};

/// Computes the gate's answer to every movement of the machine, for display. One call judges one
/// movement, so a question waits for at most one verdict. A complete round is published, at most
/// four times a second. A change of the gate's state restarts the round, so no message mixes two
/// states. Judging allocates nothing, but making the message allocates.
class OutlookRounds {
  public:
    /// Call it every few milliseconds. Asks the gate only if a client subscribes. Waiting bytes
    /// delay a movement by a few calls at most. So one client that floods the gate cannot stop the
    /// outlook of the others.
    [[nodiscard]] std::optional<TopicMessage> next(StepGate& gate,
                                                   const OutlookDemand& demand,
                                                   std::int64_t now_ns);

  private:
    [[nodiscard]] bool gives_way(const OutlookDemand& demand) noexcept;
    [[nodiscard]] bool may_begin(std::int64_t now_ns) noexcept;

    static constexpr std::size_t kMostMovements = Machine::kMovementCodes - 1;
    std::array<Prospect, kMostMovements> prospects_;
    std::size_t judged_ = 0;  ///< movements judged in this round
    gate::GateState state_ = gate::GateState::init;
    std::optional<std::int64_t> began_ns_;  ///< start of this round, or of the last round
    int gave_way_ = 0;                      ///< consecutive calls that gave priority to questions
};

}  // namespace surefoot::gate_process
