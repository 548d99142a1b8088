// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/core/frame.hpp"
#include "surefoot/odometry/visual/corner_detector.hpp"
#include "surefoot/odometry/visual/klt_tracker.hpp"
#include "surefoot/odometry/visual/stereo_points.hpp"
#include "surefoot/odometry/visual/tracks.hpp"

namespace surefoot::odometry {

struct FrontEndConfig {
    KltConfig klt;
    CornerConfig corners;
    StereoPointConfig stereo;
    double min_correlation = 0.8;  ///< smallest correlation of an aligned patch
    int most_tracks = 240;         ///< largest number of tracks, including those found again
    int most_attempts = 60;        ///< largest number of searches per frame for lost landmarks
};

/// Turns images into tracks of landmarks. Keeps the pyramids of the present frame and of the last
/// frame with good tracks, from which points are tracked.
class FrontEnd final : public Tracks {
  public:
    FrontEnd(const FrontEndConfig& config, const camera::Rectifier& rectifier);

    /// Takes the images of a new frame. Returns false if the left image does not fit the rig.
    [[nodiscard]] bool load(const StereoFrame& frame, Executor& executor);
    /// Tracks the kept points by Lucas-Kanade, starting where `T_odom_camera` predicts them.
    void follow(const LandmarkMap& map, const Pose& T_odom_camera, Executor& executor) override;
    /// Aligns patches in both cameras: of the current tracks, of lost tracks, and of landmarks that
    /// should be visible again.
    void align(LandmarkMap& map, const Pose& T_odom_camera, Executor& executor) override;
    /// Renews the patches that were not found, then detects corners between the tracks. Adds
    /// nothing while the cameras are swapped.
    int seed(LandmarkMap& map, Executor& executor) override;
    /// After this call `left()` is the older image.
    void keep() override;
    /// See ImagePyramid::sharpness.
    [[nodiscard]] double sharpness() const override { return left_.sharpness(); }
    [[nodiscard]] const ImagePyramid& left() const noexcept { return left_; }
    [[nodiscard]] bool right_shows_something() const override { return right_shows_something_; }
    [[nodiscard]] bool cameras_swapped() const override { return cameras_swapped_; }

  private:
    struct Job;
    [[nodiscard]] Track align_one(const LandmarkMap& map, const Pose& T, const Job& job) const;
    void measure_depth(const LandmarkMap& map,
                       const Pose& T,
                       const Landmark& landmark,
                       const Eigen::Vector2d& shift_px,
                       Track& track) const;
    void collect_jobs(const LandmarkMap& map, const Pose& T, std::vector<Job>& jobs);
    [[nodiscard]] bool hardly_any_depth() const;
    [[nodiscard]] bool are_swapped(std::span<const Eigen::Vector2d> raw_left_px,
                                   Executor& executor) const;
    [[nodiscard]] bool rgbd() const noexcept { return !depth_m_.empty(); }

    FrontEndConfig config_;
    ImagePyramid left_;
    ImagePyramid left_kept_;
    GreyImage right_;
    Image<float> depth_m_;
    std::vector<KltRequest> requests_;
    std::vector<KltResult> results_;
    bool right_shows_something_ = false;
    bool left_shows_something_ = false;
    bool cameras_swapped_ = false;  ///< checked in frames with hardly any depth
    int next_attempt_ = 0;          ///< slot at which the next search for landmarks starts
};

}  // namespace surefoot::odometry
