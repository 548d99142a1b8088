// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/suite/suite_case.hpp"

namespace surefoot::app {

/// Sorts by scene, noise, seed and length: the order of every report, independent of the order in
/// which cases finish.
[[nodiscard]] std::vector<SuiteResult> sorted(std::vector<SuiteResult> results);

/// Median and worst case of every figure over the cases of one group at one noise level.
struct SuiteRow {
    std::string scene;  ///< empty in rows of a motion model
    std::string motion_model;
    double noise = 1.0;
    int cases = 0;
    std::vector<double> median;  ///< one per suite_figures(); NaN = measured in no case
    std::vector<double> worst;
};
/// One row per scene and noise level, in the order of their first appearance.
[[nodiscard]] std::vector<SuiteRow> summarise(std::span<const SuiteResult> results);
/// One row per motion model and noise level, over all scenes.
[[nodiscard]] std::vector<SuiteRow> summarise_by_motion_model(std::span<const SuiteResult> results);

/// Map errors of all cases at one noise level, summed.
struct NoiseBins {
    double noise = 1.0;
    int cases = 0;
    std::vector<SuiteBin> bins;
};
/// By noise.
[[nodiscard]] std::vector<NoiseBins> pooled_by_noise(std::span<const SuiteResult> results);

}  // namespace surefoot::app
