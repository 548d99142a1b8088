// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "surefoot/gate/gate.hpp"

// These functions write the JSON objects of the command line. The names of the keys are a contract
// (docs/reference/json.md). NaN is written as null.
namespace surefoot::app {

/// Returns the JSON answer of a verb that failed before it produced a result.
[[nodiscard]] std::string failure_json(const std::string& error, int exit_code);
[[nodiscard]] std::string verdict_json(const gate::Verdict& verdict,
                                       const std::string& text,
                                       const std::vector<std::string>& assumed);

}  // namespace surefoot::app
