// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "apps/surefoot/thesis_case.hpp"
#include "apps/surefoot/thesis_figures.hpp"
#include "apps/surefoot/thesis_plan.hpp"

namespace surefoot::app {

/// A rebuilt data set beside Table 8.2.
struct DatasetFigures {
    ThesisDataset of;
    double length_m = 0.0;  ///< of the ground and all that stands on it, along x
    double width_m = 0.0;
    int objects = 0;
    int stations = 0;
    double points = 0.0;  ///< expected of a scan at full resolution
};

/// Everything that the report knows; what is not finished yet is not there.
struct ThesisResults {
    std::vector<DatasetFigures> datasets;
    std::map<std::string, ThesisFigures> scans;                ///< by scene
    std::map<std::string, std::array<ThesisFigures, 2>> runs;  ///< by name; columns as ThesisColumn
    ThesisFigures courtyard;
    std::vector<std::string> failures;  ///< a sentence for each part that could not be done
};

/// A row of the table with its numbers; NaN = nothing there.
struct FilledRow {
    ThesisRow row;
    double thesis_settings = 0.0;
    double ours = 0.0;
    double scan = 0.0;
    double exact = 0.0;
};
[[nodiscard]] std::vector<FilledRow> filled_rows(const ThesisResults& results, std::uint64_t seed);

/// One self-contained page, pictures first (they are read from the folders of the parts).
[[nodiscard]] std::string thesis_html(const ThesisResults& results,
                                      const ThesisConditions& conditions);
[[nodiscard]] std::string thesis_json(const ThesisResults& results,
                                      const ThesisConditions& conditions);
[[nodiscard]] std::string thesis_csv(const ThesisResults& results,
                                     const ThesisConditions& conditions);
/// The table for people, on stdout.
void print_thesis(const ThesisResults& results, const ThesisConditions& conditions);

}  // namespace surefoot::app
