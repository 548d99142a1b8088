// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "surefoot/core/frame.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::app {

/// Asks the first pairs of a source whether the eyes are exchanged and whether their rows match,
/// until one has corners enough; five at most.
class EyesCheck {
  public:
    /// `source`: what messages name.
    explicit EyesCheck(std::string source) : source_(std::move(source)) {}
    /// After each frame. An error where left and right are exchanged; `quiet`: rows that differ are
    /// no warning.
    [[nodiscard]] Status look(const pipeline::Pipeline& pipeline,
                              const FrameReport& report,
                              bool quiet = false);

  private:
    std::string source_;
    int left_ = 5;  ///< pairs that may still be asked
};

}  // namespace surefoot::app
