// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "apps/surefoot/suite_case.hpp"

namespace surefoot::app {

/// One self-contained page: the sums, errors by distance and image column, what the gate said to
/// each step, the worst case of every scene as a picture (from `folder`, see thumbnail_file), and
/// the figures of every scene and case. `results` as `sorted` leaves them.
[[nodiscard]] std::string suite_html(std::span<const SuiteResult> results,
                                     const std::string& folder);

}  // namespace surefoot::app
