// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Many writes, of which each is tried whatever became of those before; remembers the first
/// failure.
class Writes {
  public:
    void operator+=(Status status) {
        if (!status && first_.ok()) first_ = std::move(status);
    }
    [[nodiscard]] const Status& first() const noexcept { return first_; }

  private:
    Status first_;
};

}  // namespace surefoot::app
