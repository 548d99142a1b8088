// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "apps/surefoot/suite_case.hpp"
#include "surefoot/eval/report/html_report.hpp"

namespace surefoot::app {

/// Share of the clearly safe movements that the gate allowed, over all cases; NaN without any.
[[nodiscard]] double allowed_share(std::span<const SuiteResult> results);

/// For every noise level: why clearly safe movements were refused, what could not be proven about
/// them, and which hazards were missed.
[[nodiscard]] std::vector<eval::ReportBars> refusal_bars(std::span<const SuiteResult> results);
/// The reasons of the refusals scene by scene.
[[nodiscard]] eval::ReportTable refusal_table(std::span<const SuiteResult> results);

/// Each step that a walking user asked for, beside the truth.
[[nodiscard]] eval::ReportTable step_table(std::span<const SuiteResult> results);
/// What the gate said to the clearly safe ones of them.
[[nodiscard]] eval::ReportBars step_bars(std::span<const SuiteResult> results);

}  // namespace surefoot::app
