// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/report.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {

/// Measures how well the sigma of the matcher ranks the disparity errors. The measure is the mean
/// sparsification area (eval::Sparsification::auc) of single frames.
class DepthOrder {
  public:
    /// Evaluates every fifth frame of a rectified source. Skips the frames that were buffered for
    /// the alignment, because the source no longer has their true depth.
    void after_frame(const FrameReport& frame,
                     const sim::SceneSource& source,
                     const pipeline::Pipeline& pipeline);
    /// Returns the mean area; NaN if no frame was evaluated.
    [[nodiscard]] double auc() const;

  private:
    int seen_ = 0;
    int measured_ = 0;
    double sum_ = 0.0;
};

}  // namespace surefoot::app
