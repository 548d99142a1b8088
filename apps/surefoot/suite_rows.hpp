// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/surefoot/suite_case.hpp"

namespace surefoot::app {

/// By scene, noise, seed and length: the order of every report, whatever was finished first.
[[nodiscard]] std::vector<SuiteResult> sorted(std::vector<SuiteResult> results);

/// Median and worst case of every figure over the cases of one group at one noise level.
struct SuiteRow {
    std::string scene;  ///< empty in rows of a carrier
    std::string carrier;
    double noise = 1.0;
    int cases = 0;
    std::vector<double> median;  ///< one per suite_figures(); NaN = nowhere measured
    std::vector<double> worst;
};
/// One row per scene and noise, in the order in which they first appear.
[[nodiscard]] std::vector<SuiteRow> summarise(std::span<const SuiteResult> results);
/// One row per carrier and noise, over all scenes.
[[nodiscard]] std::vector<SuiteRow> summarise_by_carrier(std::span<const SuiteResult> results);

/// The map errors of all cases at one noise level, added up.
struct NoiseBins {
    double noise = 1.0;
    int cases = 0;
    std::vector<SuiteBin> bins;
};
/// By noise.
[[nodiscard]] std::vector<NoiseBins> pooled_by_noise(std::span<const SuiteResult> results);

}  // namespace surefoot::app
