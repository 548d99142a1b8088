// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "service/gate_process/protocol/subscriptions.hpp"
#include "service/gate_process/step_gate.hpp"

namespace surefoot::gate_process {

/// When health and diagnostics are published: at once when the state changes, else health every
/// 400 ms (a listener that hears none for a second knows that the gate is gone) and diagnostics
/// every second, as ROS tools expect them.
class PeriodicTopics {
  public:
    /// Asks the gate for its report. Call it every few milliseconds.
    [[nodiscard]] std::vector<TopicMessage> due(StepGate& gate, std::int64_t now_ns);

  private:
    [[nodiscard]] bool health_is_due(const GateReport& report, std::int64_t now_ns);
    [[nodiscard]] bool diagnostics_are_due(std::int64_t now_ns);

    std::optional<GateReport> last_;  // that was published
    std::int64_t last_health_ns_ = 0;
    std::optional<std::int64_t> last_diagnostics_ns_;
};

}  // namespace surefoot::gate_process
