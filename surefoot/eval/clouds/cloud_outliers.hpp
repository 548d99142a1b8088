// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/geometry/kd_tree.hpp"

namespace surefoot::eval {

/// Statistical outlier removal (Rusu et al. 2008). A point is an outlier if its mean distance to
/// its neighbours is above mean + `sigmas` * standard deviation of these means over all points. The
/// filter passes once over the cloud. The standard deviation uses the divisor n.
struct OutlierConfig {
    /// Number of averaged neighbours without the point itself, as PCL's MeanK. CloudCompare and
    /// Open3D include the point: their 7 is 6 here.
    int others = 6;
    double sigmas = 4.0;
};

/// Marks the outliers of one cloud. Memory: the k-d tree of the cloud and four bytes a point.
class OutlierFilter {
  public:
    /// Uses at most as many neighbours as `cloud` has.
    OutlierFilter(geometry::KdTree cloud,
                  const OutlierConfig& config,
                  Executor& executor = serial());

    /// Returns true if a point of the cloud is not an outlier. Identifies a point by its
    /// coordinates; returns false for a point that is not in the cloud.
    [[nodiscard]] bool keeps(const Eigen::Vector3f& point_m) const;

    [[nodiscard]] double mean_m() const noexcept { return mean_m_; }
    [[nodiscard]] double std_m() const noexcept { return std_m_; }
    /// A point is an outlier if its mean distance to its neighbours is above this limit.
    [[nodiscard]] double limit_m() const noexcept { return limit_m_; }

  private:
    geometry::KdTree cloud_;
    std::vector<float> to_neighbours_m_;  ///< mean distance of each point, in the order of the tree
    double mean_m_ = 0.0;
    double std_m_ = 0.0;
    double limit_m_ = 0.0;
};

}  // namespace surefoot::eval
