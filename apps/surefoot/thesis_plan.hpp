// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/suite_case.hpp"
#include "surefoot/core/result.hpp"

/// The experiments of Lange 2016, "Viability of Commercial Depth Sensors for the REX Medical
/// Exoskeleton", chapters 8 and 9, as data: which rebuilt place, who carries the camera, what is
/// read off, and what the thesis has for it.
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

/// A part of the ground as expressions of the scene's parameters: smallest and largest x and y [m].
using BoxText = std::array<const char*, 4>;

/// A recording of chapter 9: a camera carried through a place, mapped, compared with its laser
/// scan.
struct ThesisRun {
    const char* name;
    const char* figures;  ///< of the thesis
    const char* title;
    const char* scene;
    const char* carrier;
    double rate_hz = 10.0;
    const char* preset;         ///< traversability of the thesis there
    double map_length_m = 0.0;  ///< 0 = as set
    /// Where stairs are, to be measured by the histogram of heights; nothing: there are none.
    std::optional<BoxText> stairs = {};
    bool door = false;  ///< the scene has door_x_m, door_y_m
    bool walk = false;  ///< the gate is asked about each step, and about every movement at the end
};
[[nodiscard]] std::span<const ThesisRun> thesis_runs();

/// A place whose laser scan alone is rated (Fig. 9.14).
inline constexpr const char* kThesisCourtyard = "thesis_d_courtyard";

/// What maps and rates.
enum class ThesisColumn : std::uint8_t {
    ours,
    thesis,  ///< the same program with the settings of the thesis
};
inline constexpr const char* kThesisColumnNames[] = {"ours", "thesis_settings"};

/// Settings of the thesis on top of `settings`: error model, fusion, filters, traversability. Its
/// camera driver, tracker and code are not rebuilt: both columns see the same depth and motion.
[[nodiscard]] Status use_thesis_settings(const char* preset, Settings& settings);

/// One line of the table: thesis, its settings here, ours, laser scan, exact.
struct ThesisRow {
    const char* group;
    const char* what;
    const char* run;
    const char* figure;
    FigureKind kind = FigureKind::length_m;
    const char* thesis;                 ///< as it is printed there; "-" = not stated
    const char* truth = "";             ///< expression of the scene's parameters; "" = none
    const char* divided_by = "";        ///< a run: the row is the ratio of the two
    const char* ours_figure = nullptr;  ///< where ours has a better way to know it
};
[[nodiscard]] std::span<const ThesisRow> thesis_rows();

}  // namespace surefoot::app
