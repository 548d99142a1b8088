// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/geometry/kd_tree.hpp"

namespace surefoot::eval {

/// Statistical outlier removal (Rusu et al. 2008): a point whose mean distance to its neighbours is
/// above mean + `sigmas` times the standard deviation of all points' is no part of the cloud. One
/// pass over the whole cloud; the standard deviation is divided by n.
struct OutlierConfig {
    /// Neighbours that are averaged, the point itself not among them: PCL's MeanK. CloudCompare and
    /// Open3D count the point: their 7 is 6 here.
    int others = 6;
    double sigmas = 4.0;
};

/// What is an outlier of one cloud; keeps the cloud's tree and four bytes a point.
class OutlierFilter {
  public:
    /// Of the points of `cloud`; its neighbours are at most those that there are.
    OutlierFilter(geometry::KdTree cloud,
                  const OutlierConfig& config,
                  Executor& executor = serial());

    /// Is a point of the cloud none of its outliers? Points are told by their coordinates: those
    /// that share them share their neighbours. False for what is no point of the cloud.
    [[nodiscard]] bool keeps(const Eigen::Vector3f& point_m) const;

    [[nodiscard]] double mean_m() const noexcept { return mean_m_; }
    [[nodiscard]] double std_m() const noexcept { return std_m_; }
    /// Largest mean distance of what is kept.
    [[nodiscard]] double limit_m() const noexcept { return limit_m_; }

  private:
    geometry::KdTree cloud_;
    std::vector<float> to_neighbours_m_;  ///< mean of each point, in the order of the tree
    double mean_m_ = 0.0;
    double std_m_ = 0.0;
    double limit_m_ = 0.0;
};

}  // namespace surefoot::eval
