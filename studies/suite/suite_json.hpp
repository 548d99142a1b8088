// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "studies/suite/suite_case.hpp"

// JSON objects of the command line. Their names are a contract (docs/reference/json.md). NaN is
// written as null.
namespace surefoot::app {

/// `results` must be in the order that `sorted` returns.
[[nodiscard]] std::string suite_json(std::span<const SuiteResult> results);

}  // namespace surefoot::app
