// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/surefoot/suite_case.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {

/// What a suite has measured, in its folder: cases.csv has a line for every finished case,
/// bins.csv, steps.csv and verdicts.csv what belongs to it, pictures/ the worst case of each scene.
/// All of it is written when the case is finished, the line of cases.csv last, so that a suite can
/// be stopped at any time and goes on where it was: what has no line there is dropped. The first
/// line binds the files to the conditions. One thread at a time.
class SuiteTable {
  public:
    /// Reads what an earlier call has left; files of other conditions or of another version are a
    /// usage error. `conditions`: hash of everything that the figures depend on.
    [[nodiscard]] static Result<SuiteTable> open(const std::string& folder,
                                                 std::uint64_t conditions);

    [[nodiscard]] bool holds(const SuiteCase& which) const;
    [[nodiscard]] Status add(SuiteResult result);
    /// In the order in which they were finished.
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
    std::map<std::string, std::size_t> places_;  ///< in `results_`, by the key of the case
};

/// The picture of a scene's worst case, as `SuiteTable` keeps it in the folder.
[[nodiscard]] std::string thumbnail_file(const std::string& folder, const std::string& scene);

}  // namespace surefoot::app
