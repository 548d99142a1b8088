// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/suite/suite_case.hpp"

namespace surefoot::app {

/// Sorts by scene, motion model, noise, seed and number of frames. This is the order of every
/// report; the order in which cases finish has no effect.
[[nodiscard]] std::vector<SuiteResult> sorted(std::vector<SuiteResult> results);

/// Median and worst value of every figure over all cases of one group at one noise level.
struct SuiteRow {
    std::string scene;  ///< name of the scene; empty in rows of a motion model
    std::string motion_model;
    double noise = 1.0;
    int cases = 0;
    std::vector<double> median;  ///< one value for each of suite_figures(); NaN = not measured
    std::vector<double> worst;
};
/// Returns one row per scene, motion model and noise level, in the order of first appearance.
[[nodiscard]] std::vector<SuiteRow> summarise(std::span<const SuiteResult> results);
/// Returns one row per motion model and noise level, over all scenes.
[[nodiscard]] std::vector<SuiteRow> summarise_by_motion_model(std::span<const SuiteResult> results);

/// Sums of the map errors of all cases at one noise level.
struct NoiseBins {
    double noise = 1.0;
    int cases = 0;
    std::vector<SuiteBin> bins;
};
/// Returns the summed map errors of each noise level, in ascending order of the noise.
[[nodiscard]] std::vector<NoiseBins> pooled_by_noise(std::span<const SuiteResult> results);

}  // namespace surefoot::app
