// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "surefoot/core/frame.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/pipeline/pipeline.hpp"

namespace surefoot::app {

/// Checks the first image pairs of a source: are the cameras swapped, and do the rows of left and
/// right image match? The check stops after the first pair with enough corners, at the latest after
/// five pairs.
class CameraOrderCheck {
  public:
    /// `source`: name of the source in messages.
    explicit CameraOrderCheck(std::string source) : source_(std::move(source)) {}
    /// Call after each frame. Returns an error if left and right camera are swapped. Rows that
    /// differ are logged as a warning unless `quiet`.
    [[nodiscard]] Status check(const pipeline::Pipeline& pipeline,
                               const FrameReport& report,
                               bool quiet = false);

  private:
    std::string source_;
    int left_ = 5;  ///< number of pairs that may still be checked
};

}  // namespace surefoot::app
