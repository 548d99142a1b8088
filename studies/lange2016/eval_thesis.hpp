// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "studies/suite/suite_options.hpp"

namespace surefoot::app {

/// Runs `surefoot eval suite --lange2016`: repeats the experiments of the reference thesis (Lange
/// 2016). Returns the exit code.
int eval_thesis(const EvalSuiteOptions& options);

}  // namespace surefoot::app
