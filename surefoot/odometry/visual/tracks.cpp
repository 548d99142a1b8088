// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/tracks.hpp"

namespace surefoot::odometry {
namespace {

/// A landmark that agreed with this many poses belongs to the static scene. A landmark that has
/// just appeared may belong to a person who walks in, however many such landmarks there are.
constexpr int kEstablished = 5;
constexpr double kNewVote = 0.2;

}  // namespace

StereoPixel Tracks::at_stamp(const StereoPixel& pixel_px,
                             const Eigen::Vector2d& raw_px,
                             const Eigen::Vector3d& p_camera) const {
    const double offset_s = rectifier_.row_offset_s(raw_px.y());
    if (offset_s == 0.0) return pixel_px;
    return pixel_px - pixel_motion(rectifier_.rig(), p_camera, velocity_, offset_s);
}

void Tracks::keep() {
    kept_ = tracks_;
}

void Tracks::clear() {
    kept_.clear();
    tracks_.clear();
}

void Tracks::select(std::span<const std::uint8_t> inlier) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < tracks_.size(); ++i)
        if (inlier[i] != 0) tracks_[kept++] = tracks_[i];
    tracks_.resize(kept);
}

void Tracks::drop_removed(const LandmarkMap& map) {
    const auto gone = [&](const Track& track) { return map.at(track.slot).id != track.id; };
    std::erase_if(tracks_, gone);
    std::erase_if(kept_, gone);
}

void Tracks::forget_excess(LandmarkMap& map) {
    busy_.assign(static_cast<std::size_t>(map.slots()), 0);
    for (const Track& track : tracks_) busy_[static_cast<std::size_t>(track.slot)] = 1;
    map.limit(busy_);
    drop_removed(map);
}

std::span<const PointMatch> Tracks::matches(const LandmarkMap& map) {
    matches_.clear();
    for (const Track& track : tracks_) {
        const Landmark& landmark = map.at(track.slot);
        matches_.push_back({landmark.p_odom_m,
                            landmark.covariance_m2,
                            track.pixel_px,
                            track.noise_factor,
                            landmark.agreed >= kEstablished ? 1.0 : kNewVote});
    }
    return matches_;
}

}  // namespace surefoot::odometry
