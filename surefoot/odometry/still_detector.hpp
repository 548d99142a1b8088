// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "surefoot/odometry/visual/tracks.hpp"

namespace surefoot::odometry {

/// Decides whether the camera still stands where it stopped. The hypothesis "no motion since the
/// anchor" is kept when the points have hardly moved in the image (median parallax, beside what
/// their noise makes of it) and the estimated motion is not significant (Mahalanobis distance).
/// Comparing with the anchor and not with the previous frame lets slow motion add up until it
/// shows.
class StillDetector {
  public:
    explicit StillDetector(double parallax_px) : parallax_px_(parallax_px) {}

    void clear() { anchor_.clear(); }
    /// True when the frame with these inliers stands at the anchor; else it becomes the anchor.
    /// `residual_px`: rms of their reprojection errors, each axis.
    [[nodiscard]] bool update(std::span<const Track> tracks,
                              const LandmarkMap& map,
                              const Pose& T_odom_camera,
                              const Matrix6& covariance,
                              double residual_px);

    [[nodiscard]] const Pose& T_odom_camera() const noexcept { return T_odom_camera_; }
    /// Frames held since the anchor.
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
