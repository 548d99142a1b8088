// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "service/gate_process/protocol/subscriptions.hpp"
#include "service/gate_process/step_gate.hpp"

namespace surefoot::gate_process {

/// Decides when health and diagnostics are published: health within 20 ms of a change of state,
/// else every 400 ms, diagnostics every second, as ROS tools expect. A client without health
/// messages for one second knows that the gate has stopped.
class PeriodicTopics {
  public:
    /// Reads the gate's report and returns the due messages. Call it every few milliseconds.
    [[nodiscard]] std::vector<TopicMessage> due(StepGate& gate, std::int64_t now_ns);

  private:
    [[nodiscard]] bool health_is_due(const GateReport& report, std::int64_t now_ns);
    [[nodiscard]] bool diagnostics_are_due(std::int64_t now_ns);

    std::optional<GateReport> last_;  // last published report
    std::int64_t last_health_ns_ = 0;
    std::optional<std::int64_t> last_diagnostics_ns_;
};

}  // namespace surefoot::gate_process
