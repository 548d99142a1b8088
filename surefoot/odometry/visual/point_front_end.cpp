// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/point_front_end.hpp"

#include <cmath>

#include "surefoot/core/unknown.hpp"

namespace surefoot::odometry {

PointFrontEnd::PointFrontEnd(const camera::Rectifier& rectifier) : Tracks(rectifier) {}

void PointFrontEnd::load(std::span<const SeenPoint> points) {
    loaded_ = true;
    right_shows_something_ = false;
    tracks_.clear();
    points_.clear();
    for (const SeenPoint& point : points) {
        if (!point.raw_left_px.allFinite()) continue;
        const auto left_px = rectifier_.rectified_from_raw(camera::Side::left, point.raw_left_px);
        if (!left_px) continue;
        right_shows_something_ |= point.raw_right_px.has_value();
        std::optional<StereoPixel> pixel;
        if (point.raw_right_px && point.raw_right_px->allFinite())
            pixel = stereo_pixel(rectifier_, point.raw_left_px, *point.raw_right_px, {});
        points_.push_back({point.id,
                           point.raw_left_px,
                           pixel.value_or(StereoPixel(left_px->x(), left_px->y(), kNan))});
    }
}

void PointFrontEnd::follow(const LandmarkMap& map,
                           const Pose& T_odom_camera,
                           Executor& /*executor*/) {
    const Pose T_camera_odom = T_odom_camera.inverse();
    tracks_.clear();
    busy_.assign(static_cast<std::size_t>(map.slots()), 0);
    for (const Point& point : points_) {
        const auto known = known_.find(point.id);
        if (known == known_.end()) continue;
        const auto [slot, landmark] = known->second;
        auto& busy = busy_[static_cast<std::size_t>(slot)];
        if (busy != 0 || map.at(slot).id != landmark) continue;
        busy = 1;
        const Eigen::Vector3d p_camera = T_camera_odom * map.at(slot).p_odom_m;
        const StereoPixel pixel_px = at_stamp(point.pixel_px, point.raw_px, p_camera);
        tracks_.push_back({slot, landmark, point.raw_px, pixel_px, 1.0, 1.0});
    }
}

void PointFrontEnd::align(LandmarkMap& map, const Pose& T_odom_camera, Executor& executor) {
    follow(map, T_odom_camera, executor);
}

int PointFrontEnd::seed(LandmarkMap& map, Executor& /*executor*/) {
    drop_removed(map);
    std::erase_if(known_, [&](const auto& entry) {
        return map.at(entry.second.slot).id != entry.second.landmark;
    });
    int added = 0;
    for (const Point& point : points_) {
        if (std::isnan(point.pixel_px.z()) || known_.contains(point.id)) continue;
        const StereoPixel pixel_px =
            at_stamp(point.pixel_px, point.raw_px, triangulate(rectifier_.rig(), point.pixel_px));
        const int slot = map.add_point(pixel_px);
        known_[point.id] = {slot, map.at(slot).id};
        tracks_.push_back({slot, map.at(slot).id, point.raw_px, pixel_px, 1.0, 1.0});
        added += 1;
    }
    return added;
}

void PointFrontEnd::clear() {
    Tracks::clear();
    known_.clear();
}

}  // namespace surefoot::odometry
