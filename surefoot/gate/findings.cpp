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

void show_worst_cell(const grid::MapSnapshot& map,
                     const Findings& findings,
                     Reason primary,
                     Evidence& evidence) noexcept {
    const Finding* worst = findings.worst(primary);
    if (worst == nullptr) return;
    const std::int64_t side = map.resolution_tenth_mm;
    evidence.has_worst_cell = true;
    evidence.worst_x_tenth_mm = map.origin_x_tenth_mm + worst->cell_x * side + side / 2;
    evidence.worst_y_tenth_mm = map.origin_y_tenth_mm + worst->cell_y * side + side / 2;
    evidence.foot = worst->foot;
    evidence.overhead = worst->overhead;
    evidence.value_tenth_mm = worst->value_tenth_mm;
    evidence.limit_tenth_mm = worst->limit_tenth_mm;
}

}  // namespace surefoot::gate
