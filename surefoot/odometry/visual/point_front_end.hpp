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

/// Turns points from another source into tracks of landmarks. A point's id identifies its landmark,
/// wherever the point is seen. Points whose two pixels contradict each other (rows, order) and
/// points without a right pixel have no depth: they track a landmark but never create one.
class PointFrontEnd final : public Tracks {
  public:
    /// `rectifier` must outlive the front end.
    explicit PointFrontEnd(const camera::Rectifier& rectifier);

    /// Takes the points of a new frame. Points whose left pixel is not finite are left out.
    void load(std::span<const SeenPoint> points);
    /// Makes tracks of all points with a known landmark. Needs no prediction.
    void follow(const LandmarkMap& map, const Pose& T_odom_camera, Executor& executor) override;
    /// Works as `follow`, because points cannot be aligned any better.
    void align(LandmarkMap& map, const Pose& T_odom_camera, Executor& executor) override;
    int seed(LandmarkMap& map, Executor& executor) override;
    void clear() override;
    /// Constant, because the sharpness of points is unknown.
    [[nodiscard]] double sharpness() const override { return 1.0; }
    [[nodiscard]] bool right_shows_something() const override { return right_shows_something_; }

  private:
    struct Point {
        std::int64_t id;
        Eigen::Vector2d raw_px;  ///< position in the raw left image
        StereoPixel pixel_px;
    };
    struct Known {
        int slot;
        std::int64_t landmark;  ///< its id, because another landmark may reuse the slot
    };

    std::vector<Point> points_;  ///< points of the present frame
    bool right_shows_something_ = false;
    std::map<std::int64_t, Known> known_;  ///< key: id of the point; may name removed landmarks
};

}  // namespace surefoot::odometry
