// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/odometry/visual/tracks.hpp"

namespace surefoot::odometry {

/// Decides whether the camera still stands where it stopped (the anchor). The camera stands
/// under two conditions. The median parallax of the points, corrected for their noise, is
/// small, and the estimated motion is not significant (Mahalanobis distance). The comparison is
/// with the anchor, not with the previous frame, so that slow motion adds up until it is
/// detected.
class StillDetector {
  public:
    explicit StillDetector(double parallax_px) : parallax_px_(parallax_px) {}

    void clear() { anchor_.clear(); }
    /// Returns true if the frame with these tracks stands at the anchor; otherwise makes the frame
    /// the anchor. `residual_px`: rms of the tracks' reprojection errors, per axis.
    [[nodiscard]] bool update(std::span<const Track> tracks,
                              const LandmarkMap& map,
                              const Pose& T_odom_camera,
                              const Matrix6& covariance,
                              double residual_px);

    [[nodiscard]] const Pose& T_odom_camera() const noexcept { return T_odom_camera_; }
    /// Number of frames that stood at the anchor.
    [[nodiscard]] int held() const noexcept { return held_; }

  private:
    struct Mark {
        int slot;
        std::int64_t id;
        Eigen::Vector2d px;
    };
    void set_anchor(std::span<const Track> tracks,
                    const LandmarkMap& map,
                    const Pose& T,
                    const Matrix6& covariance);

    double parallax_px_;
    std::vector<Mark> anchor_;
    std::vector<double> parallax_;
    Pose T_odom_camera_;
    Matrix6 covariance_ = Matrix6::Zero();
    int held_ = 0;
};

}  // namespace surefoot::odometry
