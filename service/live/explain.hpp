// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/core/machine.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::app {

/// Writes a picture of the heights around the machine. It shows the feet before and after the step,
/// the body after the step, and the cell that decided the verdict.
[[nodiscard]] Status write_explanation(const std::string& file,
                                       const Machine& machine,
                                       const gate::Query& query,
                                       const grid::MapSnapshot& map,
                                       const gate::Verdict& verdict,
                                       const std::string& text);

}  // namespace surefoot::app
