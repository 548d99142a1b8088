// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "service/console/option_settings.hpp"
#include "studies/suite/suite_case.hpp"
#include "surefoot/core/result.hpp"

/// The experiments in chapters 8 and 9 of Lange 2016, "Viability of Commercial Depth Sensors for
/// the REX Medical Exoskeleton", as data. Each has a rebuilt scene, the motion model of the camera,
/// the measured figures, and the values of the thesis.
namespace surefoot::app {

/// A data set of Table 8.2 and the scene that rebuilds it.
struct ThesisDataset {
    const char* label;
    const char* project;
    const char* size;
    double million_points = 0.0;
    const char* features;
    const char* scene;
};
[[nodiscard]] std::span<const ThesisDataset> thesis_datasets();

/// A rectangle on the ground: smallest x and y, largest x and y, as scene expressions [m].
using BoxText = std::array<const char*, 4>;

/// An experiment of chapter 9: a camera moves through a place and records it. The recording is
/// mapped, and the map is compared with a laser scan of the place.
struct ThesisRun {
    const char* name;
    const char* figures;  ///< figure numbers in the thesis
    const char* title;
    const char* scene;
    const char* motion_model;
    double rate_hz = 10.0;
    const char* preset;         ///< traversability preset of the thesis for this run
    double map_length_m = 0.0;  ///< side of the map; 0 = value of the settings
    /// Rectangle with the stairs to measure by the histogram of heights; empty = no stairs.
    std::optional<BoxText> stairs = {};
    bool door = false;  ///< true: the scene has the parameters door_x_m, door_y_m
    bool walk = false;  ///< true: ask the gate about each step, and about every movement at the end
};
[[nodiscard]] std::span<const ThesisRun> thesis_runs();

/// Scene whose laser scan is rated without a recording (Fig. 9.14).
inline constexpr const char* kThesisCourtyard = "thesis_d_courtyard";

/// Settings with which a recording is mapped and rated.
enum class ThesisColumn : std::uint8_t {
    ours,
    thesis,  ///< this program with the settings of the thesis
};
inline constexpr const char* kThesisColumnNames[] = {"ours", "thesis_settings"};

/// Applies the settings of the thesis to `settings`: error model, fusion, filters, traversability.
/// The camera driver, visual odometry and code of the thesis are not rebuilt: both columns use the
/// same depth and motion.
[[nodiscard]] Status use_thesis_settings(const char* preset, Settings& settings);

/// One row of the result table. Its columns are: value of the thesis, our program with the settings
/// of the thesis, our program with our settings, laser scan, exact truth.
struct ThesisRow {
    const char* group;
    const char* what;
    const char* run;
    const char* figure;
    FigureKind kind = FigureKind::length_m;
    const char* thesis;           ///< value as printed in the thesis; "-" = not stated
    const char* truth = "";       ///< expression of the scene's parameters; "" = no exact value
    const char* divided_by = "";  ///< run whose figure divides the figure; "" = no ratio
    /// Better measurement for the column "ours"; nullptr = the figure `figure`.
    const char* ours_figure = nullptr;
};
[[nodiscard]] std::span<const ThesisRow> thesis_rows();

}  // namespace surefoot::app
