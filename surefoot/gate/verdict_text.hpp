// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "surefoot/gate/gate.hpp"

namespace surefoot::gate {

/// Returns one sentence for people: obstacle, its position relative to the machine, value and
/// limit. Example: "drop of 0.17 m, 0.31 m ahead of the left foot (limit 0.05 m)". Decides nothing.
[[nodiscard]] std::string text_of(const Verdict& verdict,
                                  const Query& query,
                                  const Machine& machine);

/// Returns the names of the reasons, in order of precedence.
[[nodiscard]] std::vector<std::string_view> names_of(ReasonSet reasons);
/// Returns the names of the proofs that do not hold.
[[nodiscard]] std::vector<std::string_view> unproven_names(const Evidence& evidence);

}  // namespace surefoot::gate
