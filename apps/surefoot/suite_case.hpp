// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/suite_bins.hpp"
#include "apps/surefoot/suite_steps.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {

/// One run of the suite: a scene as its seed varies it, seen with a multiple of the nominal noise.
struct SuiteCase {
    std::string scene;
    std::uint64_t seed = 1;
    double noise = 1.0;               ///< factor on the camera's noise amplitudes
    int max_frames = 0;               ///< 0 = the whole path
    double rate_hz = 10.0;            ///< of the camera
    std::string carrier = "trolley";  ///< one of sim::kCarrierNames

    /// "demo_stairs/trolley/seed 3/noise 2": what a finished case is known by.
    [[nodiscard]] std::string name() const;
    friend bool operator==(const SuiteCase&, const SuiteCase&) = default;
};

/// One of sim::kCarriedByNames.
[[nodiscard]] sim::CarriedBy carried_by(const std::string& name);

/// The chain's settings. How high base_link is over its own ground is known of every carrier: it is
/// built so (the trolley is 4 cm lower than the walking machine).
[[nodiscard]] pipeline::PipelineConfig config_on(const sim::SceneTruth& truth,
                                                 const Settings& settings);

/// How a figure is shown to people; files hold SI units and shares of 1.
enum class FigureKind : std::uint8_t { count, share, length_m, percent, pixels, number };

/// What is measured in every case, in the order of `SuiteResult::figures`. `lower_is_better` says
/// which end of a figure is its worst case.
struct SuiteFigure {
    const char* name;
    const char* group;  ///< figures of one group share a table
    FigureKind kind;
    bool lower_is_better;
    const char* meaning;
};
[[nodiscard]] const std::vector<SuiteFigure>& suite_figures();

struct SuiteResult {
    SuiteCase which;
    std::vector<double> figures;   ///< one per suite_figures(); NaN = there was nothing to measure
    std::vector<SuiteBin> bins;    ///< map errors by range and image column
    std::vector<SuiteStep> steps;  ///< of a walking machine
    VerdictTallies tallies;        ///< the wrong answers to the questions at the end of the way
    std::vector<std::uint8_t> thumbnail;  ///< confusion map as PNG; empty where nothing is known,
                                          ///< and of a case that was read from a file

    /// The figure of that name.
    [[nodiscard]] double figure(std::string_view name) const;
};

/// Total order of the cases, the worse first: missed hazards, then unsafe cells called safe, then
/// height errors, then by name.
[[nodiscard]] bool is_worse(const SuiteResult& a, const SuiteResult& b);

/// What all cases of a suite share.
struct SuiteConditions {
    Settings settings;
    Machine machine;
    double reach_m = 0.8;  ///< how far around the last pose the gate is asked
};

/// Simulates the case, runs the whole chain over it and compares with the truth; nothing is
/// aligned. Thread-safe; the result does not depend on what else is running.
[[nodiscard]] Result<SuiteResult> run_suite_case(const SuiteCase& which,
                                                 const SuiteConditions& conditions);

}  // namespace surefoot::app
