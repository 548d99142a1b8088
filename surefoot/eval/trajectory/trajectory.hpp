// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::eval {

/// Motion of the estimated world frame onto the true world frame before positions are compared.
enum class Alignment : std::uint8_t {
    se3,   ///< rotation and translation (Umeyama 1991, without scale)
    yaw,   ///< translation and rotation about z: both world frames have z up
    none,  ///< no change: estimate and truth share one world frame
};

struct EvalTrajectoryConfig {
    Alignment align = Alignment::se3;
    double tolerance_s = 0.010;   ///< largest time difference of a matched pair
    double rpe_interval_s = 0.0;  ///< time span of a relative error; 0 = to the next pair
    void describe(ConfigVisitor& visitor);
};

/// An estimated pose and its true pose, as indices in the two trajectories.
struct PosePair {
    std::size_t estimate = 0;
    std::size_t truth = 0;
    friend bool operator==(const PosePair&, const PosePair&) = default;
};

/// Matches poses nearest in time, one to one: of all pairs within the tolerance the closest comes
/// first (ties: the earlier estimate, then the earlier truth). Sorted by the estimate's time.
[[nodiscard]] std::vector<PosePair> associate(const Trajectory& estimate,
                                              const Trajectory& truth,
                                              double tolerance_s);

/// Returns T_truth_estimate that brings the columns of `estimate_m` closest to those of `truth_m`
/// (least squares; columns correspond). If several rotations are equally good, returns one of them.
[[nodiscard]] Pose align_positions(const Eigen::Matrix3Xd& estimate_m,
                                   const Eigen::Matrix3Xd& truth_m,
                                   Alignment align);

/// Returns the difference between the estimated and the true motion from pair a to pair b: (Q_a^-1
/// Q_b)^-1 (P_a^-1 P_b) with P estimated and Q true.
[[nodiscard]] Pose relative_error(const Trajectory& estimate,
                                  const Trajectory& truth,
                                  const PosePair& a,
                                  const PosePair& b);

/// Errors over the matched poses (Sturm et al. 2012 for ATE and RPE).
struct TrajectoryErrors {
    double ate_rmse_m = 0.0;        ///< rms position error after alignment
    double rpe_trans_rmse_m = 0.0;  ///< rms translation of relative_error
    double rpe_rot_rmse_deg = 0.0;
    /// 100 |t| / path length; t = error of the motion from the first to the last matched pose,
    /// which needs no alignment. NaN if the true path is shorter than 1 mm.
    double drift_percent = 0.0;
    int matched = 0;
    double path_length_m = 0.0;  ///< length of the path through the matched true positions
    double end_error_m = 0.0;    ///< |t|, see drift_percent
    Pose T_truth_estimate;       ///< alignment of the estimate with the truth
    std::vector<PosePair> pairs;
    std::vector<double> position_error_m;  ///< one error per pair, after alignment
};

/// Compares an estimated trajectory with the truth; both give poses of the same body. If the truth
/// has no stamps (KITTI), the caller first assigns the stamps of the estimate. Errors: a pose is
/// not finite; fewer than 3 poses match (2 for yaw and none); no pairs are rpe_interval_s apart.
[[nodiscard]] Result<TrajectoryErrors> evaluate_trajectory(const Trajectory& estimate,
                                                           const Trajectory& truth,
                                                           const EvalTrajectoryConfig& config);

/// Moves every estimated pose into the truth's world: T_truth_estimate * T_estimate_body.
[[nodiscard]] Trajectory transformed(const Pose& T_truth_estimate, const Trajectory& estimate);

}  // namespace surefoot::eval
