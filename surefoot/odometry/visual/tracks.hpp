// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/odometry/visual/landmark_map.hpp"
#include "surefoot/odometry/visual/pose_solver.hpp"

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

/// The landmarks that the present frame shows, whatever they are found by: `FrontEnd` finds them in
/// images, `PointFrontEnd` is told. Order of a frame: its own `load`, `follow`, `align`, `select`,
/// at a keyframe `seed`, then `keep`. A frame that is not kept leaves the kept tracks as they were.
class Tracks {
  public:
    /// `rectifier` must outlive the tracks.
    explicit Tracks(const camera::Rectifier& rectifier) : rectifier_(rectifier) {}
    virtual ~Tracks() = default;

    /// How the camera moves at the present frame, per second (right perturbation of its pose):
    /// brings what a rolling shutter sees to the stamp, from the next `follow` or `align` on.
    void move(const Vector6& velocity) { velocity_ = velocity; }
    /// Finds the landmarks in the present frame; `T_odom_camera` is where it is predicted to be.
    virtual void follow(const LandmarkMap& map, const Pose& T_odom_camera, Executor& executor) = 0;
    /// Finds them as well as can be; `T_odom_camera` is good to about a pixel.
    virtual void align(LandmarkMap& map, const Pose& T_odom_camera, Executor& executor) = 0;
    /// Makes landmarks of what has none; the map's newest keyframe is the present frame. Returns
    /// how many.
    virtual int seed(LandmarkMap& map, Executor& executor) = 0;
    /// Makes the present frame the one to follow from.
    virtual void keep();
    /// Forgets all tracks.
    virtual void clear();
    /// Of the present frame until `keep`; means something beside that of another frame only.
    [[nodiscard]] virtual double sharpness() const = 0;
    /// The right eye sees about as much as the left one in the present frame.
    [[nodiscard]] virtual bool right_shows_something() const = 0;
    /// Each eye sees what the other one should, as `align` or `seed` found in the present frame.
    [[nodiscard]] virtual bool cameras_swapped() const { return false; }

    /// Drops the tracks that are not marked.
    void select(std::span<const std::uint8_t> inlier);
    /// Drops tracks of landmarks that the map removed.
    void drop_removed(const LandmarkMap& map);
    /// Lets the map forget landmarks beyond its limit, but none that is tracked.
    void forget_excess(LandmarkMap& map);

    /// The present frame can be looked at.
    [[nodiscard]] bool loaded() const noexcept { return loaded_; }
    /// Present tracks, in the order of `matches`.
    [[nodiscard]] const std::vector<Track>& tracks() const noexcept { return tracks_; }
    [[nodiscard]] std::span<const PointMatch> matches(const LandmarkMap& map);
    [[nodiscard]] int kept() const noexcept { return static_cast<int>(kept_.size()); }

  protected:
    /// A pixel of the point, seen when its row was exposed, as it would have been at the stamp.
    [[nodiscard]] StereoPixel at_stamp(const StereoPixel& pixel_px,
                                       const Eigen::Vector2d& raw_px,
                                       const Eigen::Vector3d& p_camera) const;

    const camera::Rectifier& rectifier_;
    std::vector<Track> kept_;         ///< of the frame that was kept last
    std::vector<Track> tracks_;       ///< of the present frame
    std::vector<std::uint8_t> busy_;  ///< one per slot: has a track
    bool loaded_ = false;

  private:
    std::vector<PointMatch> matches_;
    Vector6 velocity_ = Vector6::Zero();
};

}  // namespace surefoot::odometry
