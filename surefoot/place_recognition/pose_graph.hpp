// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/core/pose.hpp"

namespace surefoot::place_recognition {

/// Estimates the poses of a run's keyframes in the map. An edge is the odometry between neighbours,
/// or a recognition of another node or of a fixed keyframe. Method: Gauss-Newton over all poses
/// (Grisetti et al. 2010) with sparse Cholesky. Recognitions have Cauchy weights, so correct
/// recognitions outvote a wrong one. Pose and covariance conventions: see pose.hpp.
class PoseGraph {
  public:
    /// Adds the first node. Without `hold_first` or `recognise_fixed` nothing fixes the graph, and
    /// `solve` leaves it unchanged.
    int add_first(const Pose& T_map_body);
    /// Adds a node after the last one.
    int add_next(const Pose& T_previous_body, const Matrix6& covariance);
    /// Fixes the first node at its pose. The map frame is then the odom of this run.
    void hold_first() { first_held_ = true; }
    /// Adds a recognition of a node from a fixed pose. Returns the number of the recognition.
    int recognise_fixed(int node, const Pose& T_map_body, const Matrix6& covariance);
    /// Adds a recognition of node `to` from node `from`.
    int recognise(int from, int to, const Pose& T_from_to, const Matrix6& covariance);
    /// Removes the recognitions from this number on.
    void forget_from(int recognition);
    /// Moves all poses rigidly so that the pose of one node becomes `T_map_body`. Gives `solve` its
    /// start value as long as the pose in the map is unknown.
    void place(int node, const Pose& T_map_body);
    /// Computes the best poses of all nodes. Returns false, with unchanged poses, if nothing fixes
    /// the graph, or if the search fails or diverges.
    bool solve();

    [[nodiscard]] int nodes() const noexcept { return static_cast<int>(poses_.size()); }
    [[nodiscard]] int recognitions() const noexcept {
        return static_cast<int>(recognitions_.size());
    }
    [[nodiscard]] const Pose& T_map_body(int node) const {
        return poses_[static_cast<std::size_t>(node)];
    }
    /// Returns the squared Mahalanobis distance of a recognition from the present poses (mean 6).
    [[nodiscard]] double chi2(int recognition) const;

  private:
    struct Edge {
        int from = -1;  ///< -1: the map itself
        int to = 0;
        Pose T_from_to;
        Matrix6 information = Matrix6::Zero();
        bool robust = false;
    };
    [[nodiscard]] Vector6 error(const Edge& edge) const;
    [[nodiscard]] double cost() const;
    bool step(double& largest);

    bool first_held_ = false;
    std::vector<Pose> poses_;
    std::vector<Edge> motions_;
    std::vector<Edge> recognitions_;
};

}  // namespace surefoot::place_recognition
