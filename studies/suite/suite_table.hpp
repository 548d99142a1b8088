// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "studies/suite/suite_case.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {

/// Results of a suite in its folder. cases.csv has one line for every finished case; bins.csv,
/// steps.csv and verdicts.csv hold the details of the cases; pictures/ holds the worst case of each
/// scene. add() writes the line of cases.csv last, so that an interrupted suite can continue.
/// Details of a case without a line in cases.csv are dropped. The first line of each CSV file has
/// the version and a hash of the conditions. Not thread-safe.
class SuiteTable {
  public:
    /// Reads the results of an earlier call. Usage error if the files belong to other conditions or
    /// another version. `conditions`: hash of all inputs that affect the figures.
    [[nodiscard]] static Result<SuiteTable> open(const std::string& folder,
                                                 std::uint64_t conditions);

    [[nodiscard]] bool holds(const SuiteCase& which) const;
    [[nodiscard]] Status add(SuiteResult result);
    /// Returns the results in the order in which the cases finished.
    [[nodiscard]] const std::vector<SuiteResult>& results() const noexcept { return results_; }

  private:
    [[nodiscard]] bool remember(SuiteResult result);
    [[nodiscard]] SuiteResult* find(const SuiteCase& which);
    [[nodiscard]] Status keep_thumbnail(const SuiteResult& result);

    std::string folder_;
    std::optional<io::AppendFile> cases_file_;
    std::optional<io::AppendFile> bins_file_;
    std::optional<io::AppendFile> steps_file_;
    std::optional<io::AppendFile> verdicts_file_;
    std::vector<SuiteResult> results_;
    std::map<std::string, std::size_t> places_;  ///< index into `results_` for each key of a case
};

/// Returns the file name of the picture with the worst case of a scene.
[[nodiscard]] std::string thumbnail_file(const std::string& folder, const std::string& scene);

}  // namespace surefoot::app
