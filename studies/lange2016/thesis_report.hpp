// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "studies/lange2016/thesis_case.hpp"
#include "studies/lange2016/thesis_figures.hpp"
#include "studies/lange2016/thesis_plan.hpp"

namespace surefoot::app {

/// A rebuilt data set, for comparison with Table 8.2 of the reference thesis (Lange 2016).
struct DatasetFigures {
    ThesisDataset of;
    double length_m = 0.0;  ///< extent along x of ground and objects [m]
    double width_m = 0.0;
    int objects = 0;
    int stations = 0;
    double points = 0.0;  ///< expected points of a scan at full resolution
};

/// All results of the report; unfinished parts are missing.
struct ThesisResults {
    std::vector<DatasetFigures> datasets;
    std::map<std::string, ThesisFigures> scans;  ///< figures by scene
    /// Figures by run name; the array index is a ThesisColumn.
    std::map<std::string, std::array<ThesisFigures, 2>> runs;
    ThesisFigures courtyard;
    std::vector<std::string> failures;  ///< one sentence for each failed part
};

/// A row of the result table with its numbers; NaN = no value.
struct FilledRow {
    ThesisRow row;
    double thesis_settings = 0.0;
    double ours = 0.0;
    double scan = 0.0;
    double exact = 0.0;
};
[[nodiscard]] std::vector<FilledRow> filled_rows(const ThesisResults& results, std::uint64_t seed);

/// Returns one self-contained HTML page, pictures first. Reads the pictures from the part folders.
[[nodiscard]] std::string thesis_html(const ThesisResults& results,
                                      const ThesisConditions& conditions);
[[nodiscard]] std::string thesis_json(const ThesisResults& results,
                                      const ThesisConditions& conditions);
[[nodiscard]] std::string thesis_csv(const ThesisResults& results,
                                     const ThesisConditions& conditions);
/// Prints the table on stdout.
void print_thesis(const ThesisResults& results, const ThesisConditions& conditions);

}  // namespace surefoot::app
