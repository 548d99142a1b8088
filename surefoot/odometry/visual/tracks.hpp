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

/// Observation of a landmark in the present frame.
struct Track {
    int slot = 0;          ///< slot of the landmark in the map
    std::int64_t id = -1;  ///< id of the landmark, because a slot may be reused
    Eigen::Vector2d raw_px = Eigen::Vector2d::Zero();  ///< position in the raw left image
    /// Pixel, moved from its row's exposure to the stamp of the frame; u_right NaN = unknown.
    StereoPixel pixel_px = StereoPixel::Zero();
    double noise_factor = 1.0;  ///< sigma / sigma of an aligned point
    double correlation = 0.0;   ///< correlation with the landmark's patch; 0 = not aligned
};

/// The landmarks that the present frame shows. `FrontEnd` finds them in images, `PointFrontEnd`
/// gets them from another source. Order of calls in a frame: `load`, `follow`, `align`, `select`,
/// at a keyframe `seed`, then `keep`. A frame without `keep` leaves the kept tracks unchanged.
class Tracks {
  public:
    /// `rectifier` must outlive the tracks.
    explicit Tracks(const camera::Rectifier& rectifier) : rectifier_(rectifier) {}
    virtual ~Tracks() = default;

    /// Sets the camera's velocity in the present frame, per second (right perturbation of its
    /// pose). The next `follow` or `align` uses it to move rolling-shutter pixels to the stamp.
    void move(const Vector6& velocity) { velocity_ = velocity; }
    /// Finds the landmarks in the present frame; `T_odom_camera` is the predicted camera pose.
    virtual void follow(const LandmarkMap& map, const Pose& T_odom_camera, Executor& executor) = 0;
    /// Finds the landmarks as precisely as possible. `T_odom_camera` must be good to about a pixel.
    virtual void align(LandmarkMap& map, const Pose& T_odom_camera, Executor& executor) = 0;
    /// Makes a landmark of each new point that has a depth. The map's newest keyframe must be the
    /// present frame. Returns the number of new landmarks.
    virtual int seed(LandmarkMap& map, Executor& executor) = 0;
    /// Makes the present frame the reference from which the next frame is tracked.
    virtual void keep();
    /// Forgets all tracks.
    virtual void clear();
    /// Sharpness of the present frame until `keep`. Meaningful only relative to other frames.
    [[nodiscard]] virtual double sharpness() const = 0;
    /// True if the right camera shows enough structure, or any point, in the present frame.
    [[nodiscard]] virtual bool right_shows_something() const = 0;
    /// True if `align` or `seed` found in the present frame that the cameras are swapped.
    [[nodiscard]] virtual bool cameras_swapped() const { return false; }

    /// Drops the tracks that are not marked.
    void select(std::span<const std::uint8_t> inlier);
    /// Drops tracks of landmarks that the map removed.
    void drop_removed(const LandmarkMap& map);
    /// Lets the map remove landmarks beyond its limit, but no landmark with a track.
    void forget_excess(LandmarkMap& map);

    /// True if the present frame has data to track.
    [[nodiscard]] bool loaded() const noexcept { return loaded_; }
    /// Present tracks, in the order of `matches`.
    [[nodiscard]] const std::vector<Track>& tracks() const noexcept { return tracks_; }
    [[nodiscard]] std::span<const PointMatch> matches(const LandmarkMap& map);
    [[nodiscard]] int kept() const noexcept { return static_cast<int>(kept_.size()); }

  protected:
    /// Pixel of the point at the stamp, computed from its pixel when its row was exposed.
    [[nodiscard]] StereoPixel at_stamp(const StereoPixel& pixel_px,
                                       const Eigen::Vector2d& raw_px,
                                       const Eigen::Vector3d& p_camera) const;

    const camera::Rectifier& rectifier_;
    std::vector<Track> kept_;         ///< tracks of the last kept frame
    std::vector<Track> tracks_;       ///< tracks of the present frame
    std::vector<std::uint8_t> busy_;  ///< one flag per slot: the slot has a track
    bool loaded_ = false;

  private:
    std::vector<PointMatch> matches_;
    Vector6 velocity_ = Vector6::Zero();
};

}  // namespace surefoot::odometry
