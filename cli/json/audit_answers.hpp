// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/audit_replay.hpp"
#include "service/gate_process/audit/audit_reader.hpp"

// These functions write the JSON objects of the command line. The names of the keys are a contract
// (docs/reference/json.md). NaN is written as null.
namespace surefoot::app {

[[nodiscard]] std::string audit_json(const gate_process::AuditSummary& summary);
[[nodiscard]] std::string audit_acts_json(const gate_process::AuditSummary& summary,
                                          const std::vector<gate_process::Act>& acts);
[[nodiscard]] std::string audit_replay_json(const gate_process::AuditSummary& summary,
                                            const AuditReplay& replay);

}  // namespace surefoot::app
