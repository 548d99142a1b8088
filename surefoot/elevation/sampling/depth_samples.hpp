// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/depth_image.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/elevation/elevation_config.hpp"
#include "surefoot/elevation/fusion/cell_groups.hpp"
#include "surefoot/elevation/sampling/depth_rows.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::elevation {

/// Converts a depth image into samples of cells, in floats, without a list of points. The result is
/// that of `points_from_depth` and `samples_from_points` with the sensor model `matcher`. Every
/// executor and instruction set gives the same bytes. Not thread-safe.
class DepthSampler {
  public:
    /// True if this class supports the config. Other sensor models and cloud filters need points.
    [[nodiscard]] static bool can(const ElevationConfig& config) noexcept;

    /// Adds the samples of one image, and counts the rejected pixels in `counts`.
    void sample(const ElevationConfig& config,
                const camera::RectifiedRig& rig,
                const Pose& T_odom_body,
                const DepthImage& depth,
                const grid::GridGeometry& geometry,
                Executor& executor,
                CellSamples& samples,
                FusionCounts& counts);

  private:
    static constexpr int kBlockRows = 16;

    void sample_block(int block, const DepthImage& depth, CellSamples& samples);
    [[nodiscard]] DepthRow row_at(int v, const DepthImage& depth, float* padded) const;

    DepthFrame frame_;
    int reach_px_ = 0;
    double fy_px_ = 1.0;
    double cy_px_ = 0.0;
    Eigen::Matrix3d R_odom_camera_ = Eigen::Matrix3d::Identity();
    std::vector<float> nothing_px_;  ///< a row of NaN
    std::vector<float> padded_px_;   ///< per block: a row of disparities, NaN on both sides
    std::vector<RowCounts> counts_;  ///< one entry per block
};

}  // namespace surefoot::elevation
