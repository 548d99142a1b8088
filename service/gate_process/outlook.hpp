// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "service/gate_process/protocol/subscriptions.hpp"
#include "service/gate_process/step_gate.hpp"

namespace surefoot::gate_process {

/// What speaks for and against a look ahead in this moment.
struct OutlookDemand {
    bool subscribed = false;      ///< somebody listens
    bool question_waits = false;  ///< a client's bytes wait to be read: answers come first
};

/// What the gate would say to every movement of the machine, for pages: round after round, one
/// movement a call, so that no question waits for more than one verdict. A round is published when
/// it is whole, four times a second at most. When the gate's state changes a round begins anew: no
/// message mixes two states. Judging allocates nothing; a message does, like every topic's.
class OutlookRounds {
  public:
    /// Call it every few milliseconds. Without a subscriber the gate is not asked. Bytes that wait
    /// delay a movement by a few calls at most: the flood of one client must not take the picture
    /// from the others.
    [[nodiscard]] std::optional<TopicMessage> next(StepGate& gate,
                                                   const OutlookDemand& demand,
                                                   std::int64_t now_ns);

  private:
    [[nodiscard]] bool gives_way(const OutlookDemand& demand) noexcept;
    [[nodiscard]] bool may_begin(std::int64_t now_ns) noexcept;

    static constexpr std::size_t kMostMovements = Machine::kMovementCodes - 1;
    std::array<Prospect, kMostMovements> prospects_;
    std::size_t judged_ = 0;  ///< of this round
    gate::GateState state_ = gate::GateState::init;
    std::optional<std::int64_t> began_ns_;  ///< this round, or the last one
    int gave_way_ = 0;                      ///< calls in a row
};

}  // namespace surefoot::gate_process
