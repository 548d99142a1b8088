// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "service/console/option_settings.hpp"
#include "studies/suite/suite_bins.hpp"
#include "studies/suite/suite_steps.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {

/// One run of the suite: a scene, its seed, and a multiple of the nominal camera noise.
struct SuiteCase {
    std::string scene;
    std::uint64_t seed = 1;
    double noise = 1.0;                    ///< factor on the camera's noise amplitudes
    int max_frames = 0;                    ///< number of frames; 0 = the whole path
    double rate_hz = 10.0;                 ///< frame rate of the camera [Hz]
    std::string motion_model = "trolley";  ///< motion model, one of sim::kMotionModelNames

    /// Returns the unique name of the case, such as "demo_stairs/trolley/seed 3/noise 2".
    [[nodiscard]] std::string name() const;
    friend bool operator==(const SuiteCase&, const SuiteCase&) = default;
};

/// Returns the motion model with this name, one of sim::kMotionModelChoiceNames.
[[nodiscard]] sim::MotionModelChoice motion_model_choice(const std::string& name);

/// Returns the pipeline settings for a scene. The height of base_link above its ground comes from
/// the truth, because the construction of each motion model fixes this height. The trolley is 4 cm
/// lower than the walking machine.
[[nodiscard]] pipeline::PipelineConfig config_on(const sim::SceneTruth& truth,
                                                 const Settings& settings);

/// Unit in which reports show a figure. Files hold SI units, and shares as fractions of 1.
enum class FigureKind : std::uint8_t { count, share, length_m, percent, pixels, number };

/// A figure of the suite. `SuiteResult::figures` has one value for each entry of suite_figures(),
/// in the same order. `lower_is_better` decides which value is the worst.
struct SuiteFigure {
    const char* name;
    const char* group;  ///< table of the report that contains this figure
    FigureKind kind;
    bool lower_is_better;
    const char* meaning;
};
[[nodiscard]] const std::vector<SuiteFigure>& suite_figures();

/// Result of one case.
struct SuiteResult {
    SuiteCase which;
    std::vector<double> figures;   ///< one value for each of suite_figures(); NaN = not measured
    std::vector<SuiteBin> bins;    ///< map errors by range and image column
    std::vector<SuiteStep> steps;  ///< requested steps, only for walking machines
    VerdictTallies tallies;        ///< wrong verdicts at the end of the path
    /// Confusion map as PNG. Empty = no cell is known, or the case was read from a file.
    std::vector<std::uint8_t> thumbnail;

    /// Returns the figure with that name.
    [[nodiscard]] double figure(std::string_view name) const;
};

/// Returns true if case a is worse than case b: by missed hazards, then by unsafe cells rated safe,
/// then by height errors, then by name.
[[nodiscard]] bool is_worse(const SuiteResult& a, const SuiteResult& b);

/// Conditions that all cases of a suite share.
struct SuiteConditions {
    Settings settings;
    Machine machine;
    double reach_m = 0.8;  ///< largest distance of a queried pose from the last pose [m]
    std::string rig;       ///< rig file, or one of sim::rig_presets(); empty = zed_vga
};

/// Simulates the case, runs the whole pipeline and compares the results with the truth, without
/// alignment. Thread-safe. The result does not depend on other threads.
[[nodiscard]] Result<SuiteResult> run_suite_case(const SuiteCase& which,
                                                 const SuiteConditions& conditions);

}  // namespace surefoot::app
