// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <vector>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/odometry/visual/point_frame.hpp"
#include "surefoot/odometry/visual/stereo_points.hpp"
#include "surefoot/odometry/visual/tracks.hpp"

namespace surefoot::odometry {

/// Turns points that were found elsewhere into tracks of landmarks: a point is the landmark that
/// was made of its id, wherever it is seen. Points whose eyes do not fit together (rows, order) and
/// points without a right eye have no depth: they become no landmark, but find one.
class PointFrontEnd final : public Tracks {
  public:
    /// `rectifier` must outlive the front end.
    explicit PointFrontEnd(const camera::Rectifier& rectifier);

    /// Takes the points of a new frame. Pixels that are not finite are left out.
    void load(std::span<const SeenPoint> points);
    /// All points of known landmarks. No prediction is needed.
    void follow(const LandmarkMap& map, const Pose& T_odom_camera, Executor& executor) override;
    /// As `follow`: the points are as good as they come.
    void align(LandmarkMap& map, const Pose& T_odom_camera, Executor& executor) override;
    int seed(LandmarkMap& map, Executor& executor) override;
    void clear() override;
    /// Of points nothing is known: always the same.
    [[nodiscard]] double sharpness() const override { return 1.0; }
    [[nodiscard]] bool right_shows_something() const override { return right_shows_something_; }

  private:
    struct Point {
        std::int64_t id;
        Eigen::Vector2d raw_px;  ///< left
        StereoPixel pixel_px;
    };
    struct Known {
        int slot;
        std::int64_t landmark;  ///< id: a slot may be used again
    };

    std::vector<Point> points_;  ///< of the present frame
    bool right_shows_something_ = false;
    std::map<std::int64_t, Known> known_;  ///< by the point's id; may hold removed landmarks
};

}  // namespace surefoot::odometry
