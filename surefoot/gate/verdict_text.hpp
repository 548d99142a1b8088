// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/gate/gate.hpp"

namespace surefoot::gate {

/// One sentence for people: what, where as seen from the machine, value and limit, for example
/// "drop of 0.17 m, 0.31 m ahead of the left foot (limit 0.05 m)". Not part of any decision.
[[nodiscard]] std::string text_of(const Verdict& verdict,
                                  const Query& query,
                                  const Machine& machine);

}  // namespace surefoot::gate
