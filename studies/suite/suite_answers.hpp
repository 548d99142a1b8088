// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "studies/suite/suite_case.hpp"
#include "surefoot/eval/report/html_report.hpp"

namespace surefoot::app {

/// Returns the share of the clear-cut safe movements that the gate allowed, over all cases.
/// `by`: as for refusal_table(). NaN = there are no such movements.
[[nodiscard]] double allowed_share(std::span<const SuiteResult> results, TallyKey by);

/// Returns four bar charts for every noise level: the reasons for refusing clear-cut safe
/// movements, all and those in view, the proofs that failed for them, and the missed hazards.
[[nodiscard]] std::vector<eval::ReportBars> refusal_bars(std::span<const SuiteResult> results);
/// Returns the reasons of the refusals by scene. `by`: TallyKey::reason for all clear-cut safe
/// movements, TallyKey::seen for those in view.
[[nodiscard]] eval::ReportTable refusal_table(std::span<const SuiteResult> results, TallyKey by);

/// Returns each step that a walking user requested, with the verdict and the truth.
[[nodiscard]] eval::ReportTable step_table(std::span<const SuiteResult> results);
/// Returns the verdicts about the clear-cut safe steps of walking users.
[[nodiscard]] eval::ReportBars step_bars(std::span<const SuiteResult> results);

}  // namespace surefoot::app
