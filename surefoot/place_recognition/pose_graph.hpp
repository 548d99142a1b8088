// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/core/pose.hpp"

namespace surefoot::place_recognition {

/// Where the keyframes of a run were in the map: odometry between neighbours, recognitions between
/// any two or with a place whose keyframes do not move. Gauss-Newton over all poses at once
/// (Grisetti et al. 2010) with sparse Cholesky; recognitions count after Cauchy, so that a wrong
/// one among right ones is outvoted. Pose and covariance conventions are those of pose.hpp.
class PoseGraph {
  public:
    /// The first node. Without `hold_first` and any `recognise_fixed` the graph floats, and `solve`
    /// leaves it where it is.
    int add_first(const Pose& T_map_body);
    /// A node after the last one.
    int add_next(const Pose& T_previous_body, const Matrix6& covariance);
    /// The first node stays where it is: the map is that run's odom.
    void hold_first() { first_held_ = true; }
    /// A node was seen from a pose that is known. Returns the number of the recognition.
    int recognise_fixed(int node, const Pose& T_map_body, const Matrix6& covariance);
    /// `to` was seen from `from`.
    int recognise(int from, int to, const Pose& T_from_to, const Matrix6& covariance);
    /// Takes back the recognitions from a number on.
    void forget_from(int recognition);
    /// Moves all poses together, that of a node becoming `T_map_body`: the start of `solve` where
    /// nothing is known of the map yet.
    void place(int node, const Pose& T_map_body);
    /// Best poses of all nodes. False where nothing holds them or the equations cannot be solved;
    /// the poses are then as before.
    bool solve();

    [[nodiscard]] int nodes() const noexcept { return static_cast<int>(poses_.size()); }
    [[nodiscard]] int recognitions() const noexcept {
        return static_cast<int>(recognitions_.size());
    }
    [[nodiscard]] const Pose& T_map_body(int node) const {
        return poses_[static_cast<std::size_t>(node)];
    }
    /// Squared Mahalanobis distance of a recognition from the present poses; 6 on average.
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
