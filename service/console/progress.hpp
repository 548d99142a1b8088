// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace surefoot::app {

/// Counts frames in one line on stderr. Prints nothing if stderr is not a terminal or the label is
/// empty.
class Progress {
  public:
    Progress(std::string label, std::optional<int> total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    void advance(int done);

  private:
    std::string label_;
    std::optional<int> total_;
    bool visible_;
    int last_percent_ = -1;
};

}  // namespace surefoot::app
