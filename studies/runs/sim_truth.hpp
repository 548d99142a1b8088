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

/// Errors of the reported depth at the trusted pixels (kTrustedOutlierProbability).
struct DepthFigures {
    std::int64_t pixels = 0;
    double within_3_sigma = 0.0;  ///< share of pixels with |disparity error| <= 3 sigma
    double within_1_sigma = 0.0;
    double median_abs_error_px = 0.0;  ///< median |disparity error|
    double sigma_at_1_m_m = 0.0;       ///< mean reported sigma_z at 0.95-1.05 m depth
    double sigma_at_2_m_m = 0.0;       ///< mean reported sigma_z at 1.9-2.1 m depth
    double outlier_share = 0.0;        ///< share of pixels that are not trusted
};

/// Errors of a simulated run. No result is aligned with the truth before the comparison.
struct TruthFigures {
    eval::MapComparison maps;
    /// Share of known cells among the cells that both cameras saw within 2.5 m.
    double coverage_within_2_5_m = 0.0;
    eval::TraversabilityErrors traversability;  ///< rating errors over the same cells
    eval::TrajectoryErrors trajectory;          ///< path errors without alignment
    DepthFigures depth;
    Trajectory truth_trajectory;
};

/// Resamples the exact depth of a raw left image without distortion for the rectified camera. This
/// camera is slightly rotated if the rig differs from the rig of the scene. The depth is along the
/// optical axis of the rectified camera and comes from the nearest raw pixel. Empty for another
/// lens model. The rectified images may be smaller than the raw ones.
[[nodiscard]] Image<float> depth_seen_by(const camera::RectifiedRig& rig,
                                         const camera::StereoRig& raw_rig,
                                         const Image<float>& raw_m);

/// Returns the height of the origin of odom in the world [m]. If the ground was found, odom starts
/// on the ground, which is z = 0 in the world. Otherwise odom starts at the first body pose, and
/// the true height of that pose gives the offset.
[[nodiscard]] double odom_height_m(const pipeline::Pipeline& pipeline,
                                   const sim::SceneTruth& truth,
                                   const std::vector<FrameReport>& frames);

/// Collects the ground truth during a run. Does nothing if the source is not simulated.
class SimTruth {
  public:
    explicit SimTruth(camera::FrameSource& source);

    /// Keeps the exact depth of the frame that was just rendered, until compare_depth().
    void remember_depth(const StereoFrame& frame);
    /// Adds the depth errors of a frame that the pipeline has just processed.
    void compare_depth(const StereoFrame& frame, const pipeline::Pipeline& pipeline);
    /// Returns the errors. Empty for a real source, or if the body moved before odom was placed.
    [[nodiscard]] std::optional<TruthFigures> figures(const pipeline::Pipeline& pipeline,
                                                      const std::vector<FrameReport>& frames,
                                                      const eval::EvalMapsConfig& config) const;

  private:
    struct RangeMean {
        double sum_m = 0.0;
        std::int64_t count = 0;
    };
    const sim::SceneSource* scene_ = nullptr;
    std::deque<std::pair<int, Image<float>>> depths_;  ///< pairs of frame index and exact depth
    std::int64_t compared_ = 0;
    std::int64_t outliers_ = 0;
    std::int64_t within_3_sigma_ = 0;
    std::int64_t within_1_sigma_ = 0;
    RangeMean near_;
    RangeMean far_;
    /// Number of errors in each bin of 0.01 px. The last bin also counts all larger errors.
    std::vector<std::int64_t> error_histogram_ = std::vector<std::int64_t>(400, 0);
};

}  // namespace surefoot::app
