// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "service/gate_process/audit/audit_record.hpp"

namespace surefoot::app {

/// A logged verdict that differs from the verdict of this gate for the same query and map.
struct AuditDifference {
    std::string file;
    std::uint64_t offset = 0;    ///< position of the record's frame in the file [bytes]
    std::uint64_t sequence = 0;  ///< number of that frame in the log
    std::vector<gate_process::FieldDifference> fields;
};

/// Numbers of equal and of different verdicts after each query of an audit log is decided again.
struct AuditReplay {
    std::uint64_t equal = 0;
    std::uint64_t different = 0;
    std::optional<AuditDifference> first;  ///< the first verdict that differs
};

}  // namespace surefoot::app
