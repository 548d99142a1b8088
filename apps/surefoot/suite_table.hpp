// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/surefoot/suite_case.hpp"

namespace surefoot::app {

/// cases.csv of a suite: one line a finished case, written when it is finished, so that a suite can
/// be stopped at any time and goes on where it was. The first line binds it to the settings.
class SuiteTable {
  public:
    /// Reads what an earlier call has left; a file of other settings or another version's figures
    /// is a usage error. A last line that was cut off is dropped.
    [[nodiscard]] static Result<SuiteTable> open(const std::string& path,
                                                 std::uint64_t settings_hash);

    [[nodiscard]] bool holds(const SuiteCase& which) const;
    [[nodiscard]] Status add(const SuiteResult& result);
    [[nodiscard]] const std::vector<SuiteResult>& results() const noexcept { return results_; }

  private:
    std::string path_;
    std::string head_;
    std::vector<SuiteResult> results_;
};

}  // namespace surefoot::app
