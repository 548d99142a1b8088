// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "service/gate_process/audit/audit_record.hpp"

namespace surefoot::app {

/// A verdict that the gate gives otherwise than its log says.
struct AuditDifference {
    std::string file;
    std::uint64_t offset = 0;  ///< of its frame [bytes]
    std::uint64_t sequence = 0;
    std::vector<wire::FieldDifference> fields;
};

/// What became of the verdicts of a log when they were decided again.
struct AuditReplay {
    std::uint64_t equal = 0;
    std::uint64_t different = 0;
    std::optional<AuditDifference> first;
};

}  // namespace surefoot::app
