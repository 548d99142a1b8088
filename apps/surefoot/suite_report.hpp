// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "apps/surefoot/suite_case.hpp"

namespace surefoot::app {

/// Median and worst case of every figure over the seeds of one scene at one noise level.
struct SuiteRow {
    std::string scene;
    double noise = 1.0;
    int cases = 0;
    std::vector<double> median;  ///< one per suite_figures(); NaN = nowhere measured
    std::vector<double> worst;
};
/// In the order in which the scenes first appear, then by noise.
[[nodiscard]] std::vector<SuiteRow> summarise(std::span<const SuiteResult> results);

/// One self-contained page: the rows above for every figure, then every case.
[[nodiscard]] std::string suite_html(std::span<const SuiteResult> results);

}  // namespace surefoot::app
