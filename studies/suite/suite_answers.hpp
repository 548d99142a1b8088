// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "studies/suite/suite_case.hpp"
#include "surefoot/eval/report/html_report.hpp"

namespace surefoot::app {

/// Share of the clear-cut safe movements that the gate allowed, over all cases; NaN without such
/// movements.
[[nodiscard]] double allowed_share(std::span<const SuiteResult> results);

/// Bar charts for every noise level: reasons for refusing clear-cut safe movements, proofs that
/// failed for them, and missed hazards.
[[nodiscard]] std::vector<eval::ReportBars> refusal_bars(std::span<const SuiteResult> results);
/// Reasons of the refusals by scene.
[[nodiscard]] eval::ReportTable refusal_table(std::span<const SuiteResult> results);

/// Each step that a walking user requested, with the verdict and the truth.
[[nodiscard]] eval::ReportTable step_table(std::span<const SuiteResult> results);
/// Verdicts about the clear-cut safe steps of walking users.
[[nodiscard]] eval::ReportBars step_bars(std::span<const SuiteResult> results);

}  // namespace surefoot::app
