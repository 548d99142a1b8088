// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/findings.hpp"

namespace surefoot::gate {

void Findings::deny(Reason reason, const Finding& finding) noexcept {
    const auto at = static_cast<std::size_t>(reason);
    deny(reason);
    if (at >= worst_.size() || (has_worst_[at] && worst_[at].severity >= finding.severity)) return;
    worst_[at] = finding;
    has_worst_[at] = true;
}

const Finding* Findings::worst(Reason reason) const noexcept {
    const auto at = static_cast<std::size_t>(reason);
    return at < worst_.size() && has_worst_[at] ? &worst_[at] : nullptr;
}

}  // namespace surefoot::gate
