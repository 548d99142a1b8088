// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/core/frame.hpp"
#include "surefoot/odometry/corner_detector.hpp"
#include "surefoot/odometry/klt_tracker.hpp"
#include "surefoot/odometry/landmark_map.hpp"
#include "surefoot/odometry/pose_solver.hpp"
#include "surefoot/odometry/stereo_points.hpp"

namespace surefoot::odometry {

/// A landmark as it is seen in the present frame.
struct Track {
    int slot = 0;          ///< of the landmark in the map
    std::int64_t id = -1;  ///< of the landmark: a slot may be used again
    Eigen::Vector2d raw_px = Eigen::Vector2d::Zero();  ///< in the raw left image
    /// At the stamp of the frame, whenever its row was exposed; u_right is NaN where unknown.
    StereoPixel pixel_px = StereoPixel::Zero();
    double noise_factor = 1.0;  ///< sigma relative to that of an aligned point
    double correlation = 0.0;   ///< with the landmark's patch; 0 = followed but not aligned
};

struct FrontEndConfig {
    KltConfig klt;
    CornerConfig corners;
    StereoPointConfig stereo;
    double min_correlation = 0.8;  ///< of an aligned patch
    int most_tracks = 240;         ///< with those found again
    int most_attempts = 60;        ///< landmarks looked for again per frame
};

/// Turns images into tracks of landmarks. Keeps the pyramids of the present frame and of the last
/// one whose tracks were good, which is where points are followed from.
class FrontEnd {
  public:
    FrontEnd(const FrontEndConfig& config, const camera::Rectifier& rectifier);

    /// Takes the images of a new frame; false when their size is not that of the rig.
    [[nodiscard]] bool load(const StereoFrame& frame, Executor& executor);
    /// The present frame has images that fit the rig.
    [[nodiscard]] bool loaded() const noexcept { return loaded_; }
    /// How the camera moves at the present frame, per second (right perturbation of its pose):
    /// brings what a rolling shutter sees to the stamp, from the next `follow` or `align` on.
    void move(const Vector6& velocity) { velocity_ = velocity; }
    /// Forgets all tracks.
    void clear();
    /// Follows the kept tracks into the present frame, starting where `T_odom_camera` predicts
    /// them.
    void follow(const LandmarkMap& map, const Pose& T_odom_camera, Executor& executor);
    /// Aligns the patches of the followed tracks, of tracks that were lost, and of landmarks that
    /// should be in view again, in both eyes. `T_odom_camera` is good to about a pixel.
    void align(LandmarkMap& map, const Pose& T_odom_camera, Executor& executor);
    /// Looks for corners between the tracks and makes landmarks of those with depth; the map's
    /// newest keyframe is the present frame. Returns how many.
    int seed(LandmarkMap& map, Executor& executor);
    /// Drops the tracks that are not marked.
    void select(std::span<const std::uint8_t> inlier);
    /// Drops tracks of landmarks that the map removed.
    void drop_removed(const LandmarkMap& map);
    /// Lets the map forget landmarks beyond its limit, but none that is tracked.
    void forget_excess(LandmarkMap& map);
    /// Makes the present frame the one to follow from; `left()` is the older image afterwards.
    void keep();

    /// Present tracks, in the order of `matches`.
    [[nodiscard]] const std::vector<Track>& tracks() const noexcept { return tracks_; }
    [[nodiscard]] std::span<const PointMatch> matches(const LandmarkMap& map);
    [[nodiscard]] int kept() const noexcept { return static_cast<int>(kept_.size()); }
    [[nodiscard]] const ImagePyramid& left() const noexcept { return left_; }
    [[nodiscard]] double kept_sharpness() const { return left_kept_.sharpness(); }

  private:
    struct Job;
    [[nodiscard]] Track align_one(const LandmarkMap& map, const Pose& T, const Job& job) const;
    void measure_depth(const LandmarkMap& map,
                       const Pose& T,
                       const Landmark& landmark,
                       const Eigen::Vector2d& shift_px,
                       Track& track) const;
    void collect_jobs(const LandmarkMap& map, const Pose& T, std::vector<Job>& jobs);
    [[nodiscard]] StereoPixel at_stamp(const StereoPixel& pixel_px,
                                       const Eigen::Vector2d& raw_px,
                                       const Eigen::Vector3d& p_camera) const;
    [[nodiscard]] bool rgbd() const noexcept { return !depth_m_.empty(); }

    FrontEndConfig config_;
    const camera::Rectifier& rectifier_;
    ImagePyramid left_;
    ImagePyramid left_kept_;
    GreyImage right_;
    Image<float> depth_m_;
    std::vector<Track> kept_;    ///< in left_kept_
    std::vector<Track> tracks_;  ///< in left_
    std::vector<PointMatch> matches_;
    std::vector<KltRequest> requests_;
    std::vector<KltResult> results_;
    std::vector<std::uint8_t> busy_;  ///< one per slot: has a track
    Vector6 velocity_ = Vector6::Zero();
    bool loaded_ = false;
    int next_attempt_ = 0;  ///< slot from which landmarks are looked for again
};

}  // namespace surefoot::odometry
