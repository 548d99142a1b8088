// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "studies/suite/suite_case.hpp"

namespace surefoot::app {

/// Returns one self-contained HTML page: totals, errors by distance and image column, the verdict
/// for each step, and the figures of every scene and case. Also shows the worst case of every scene
/// as a picture from `folder`, see thumbnail_file(). `results` must be in the order of `sorted`.
[[nodiscard]] std::string suite_html(std::span<const SuiteResult> results,
                                     const std::string& folder);

}  // namespace surefoot::app
