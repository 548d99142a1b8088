// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "surefoot/camera/frame_source.hpp"
#include "surefoot/eval/maps/map_comparison.hpp"
#include "surefoot/eval/trajectory/trajectory.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {

/// Reported depth against exact depth, over all pixels that the matcher does not itself call
/// doubtful.
struct DepthFigures {
    std::int64_t pixels = 0;
    double within_3_sigma = 0.0;  ///< share of |error| <= 3 sigma_z
    double within_1_sigma = 0.0;
    double median_abs_error_px = 0.0;  ///< of the disparity
    double sigma_at_1_m_m = 0.0;       ///< mean reported sigma_z at 0.95-1.05 m
    double sigma_at_2_m_m = 0.0;       ///< at 1.9-2.1 m
    double doubtful_share = 0.0;       ///< pixels with an outlier probability above one half
};

/// A simulated run against the truth; nothing was aligned before the comparison.
struct TruthFigures {
    eval::MapComparison maps;
    double coverage_within_2_5_m =
        0.0;  ///< share known of the cells that both eyes saw within 2.5 m
    eval::TraversabilityErrors traversability;  ///< of these cells
    eval::TrajectoryErrors trajectory;          ///< alignment none
    DepthFigures depth;
    Trajectory truth_trajectory;
};

/// Height of odom's origin in the world. Odom begins on the ground, which is the world's z = 0, if
/// the ground was found; else at the first body, and then the truth is told from there.
[[nodiscard]] double odom_height_m(const pipeline::Pipeline& pipeline,
                                   const sim::SceneTruth& truth,
                                   const std::vector<FrameReport>& frames);

/// Collects the truth beside a run. Inert when the source is not simulated.
class SimTruth {
  public:
    explicit SimTruth(camera::FrameSource& source);

    /// Keeps the exact depth of a frame that was just rendered until it is compared.
    void remember_depth(const StereoFrame& frame);
    void compare_depth(const StereoFrame& frame, const pipeline::Pipeline& pipeline);
    /// Nothing without a simulated source, or when the body moved before odom was placed.
    [[nodiscard]] std::optional<TruthFigures> figures(const pipeline::Pipeline& pipeline,
                                                      const std::vector<FrameReport>& frames,
                                                      const eval::EvalMapsConfig& config) const;

  private:
    struct RangeMean {
        double sum_m = 0.0;
        std::int64_t count = 0;
    };
    const sim::SceneSource* scene_ = nullptr;
    std::deque<std::pair<int, Image<float>>> depths_;  ///< frame index, exact depth
    std::int64_t compared_ = 0;
    std::int64_t doubtful_ = 0;
    std::int64_t within_3_sigma_ = 0;
    std::int64_t within_1_sigma_ = 0;
    RangeMean near_;
    RangeMean far_;
    std::vector<std::int64_t> error_histogram_ =
        std::vector<std::int64_t>(400, 0);  ///< 0.01 px bins
};

}  // namespace surefoot::app
