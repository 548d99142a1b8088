// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/report.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {

/// Does the matcher's sigma know which disparities are wrong? Mean of the sparsification area
/// (eval::Sparsification::auc) of single frames.
class DepthOrder {
  public:
    /// Looks at every fifth of the frames that come straight from the source (the first ones are
    /// buffered, their truth is gone by then).
    void after_frame(const FrameReport& frame,
                     const sim::SceneSource& source,
                     const pipeline::Pipeline& pipeline);
    /// NaN without a frame.
    [[nodiscard]] double auc() const;

  private:
    int seen_ = 0;
    int measured_ = 0;
    double sum_ = 0.0;
};

}  // namespace surefoot::app
