// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Collects the results of several writes. Each write is attempted, even if an earlier one failed.
class Writes {
  public:
    void operator+=(Status status) {
        if (status) return;
        ++failed_;
        if (first_.ok()) first_ = std::move(status);
    }
    /// Returns the first failure. Its message also gives the number of other failures.
    [[nodiscard]] Status first() const {
        if (failed_ < 2) return first_;
        return Error{first_.error().code,
                     first_.error().message + " (and " + std::to_string(failed_ - 1) +
                         (failed_ == 2 ? " other result" : " other results") +
                         " could not be written)"};
    }

  private:
    Status first_;
    int failed_ = 0;
};

}  // namespace surefoot::app
