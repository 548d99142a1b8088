// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/still_detector.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/geometry/statistics.hpp"

namespace surefoot::odometry {
namespace {

/// 99.9 % quantile of a chi-square variable with six degrees of freedom.
constexpr double kChi2Limit = 22.46;
/// Median distance of two measurements of a resting point, relative to the noise of one axis: a
/// factor sqrt(2) for the difference, and sqrt(2 ln 2) for the median of a Rayleigh variable.
constexpr double kMedianOfNoise = 1.67;
constexpr std::size_t kMinShared = 20;  ///< smallest number of points that both frames see

}  // namespace

bool StillDetector::update(std::span<const Track> tracks,
                           const LandmarkMap& map,
                           const Pose& T_odom_camera,
                           const Matrix6& covariance,
                           double residual_px) {
    // Indexes the marks by slot, so that no track searches the list of marks.
    std::vector<const Mark*> by_slot(static_cast<std::size_t>(map.slots()), nullptr);
    for (const Mark& mark : anchor_)
        if (mark.slot < map.slots() && map.at(mark.slot).id == mark.id)
            by_slot[static_cast<std::size_t>(mark.slot)] = &mark;
    parallax_.clear();
    for (const Track& track : tracks)
        if (const Mark* mark = by_slot[static_cast<std::size_t>(track.slot)])
            parallax_.push_back((track.pixel_px.head<2>() - mark->px).norm());
    const Vector6 motion = difference(T_odom_camera_, T_odom_camera);
    const Matrix6 sum = covariance_ + covariance;
    const double most_px = std::hypot(parallax_px_, kMedianOfNoise * residual_px);
    if (parallax_.size() >= kMinShared && upper_median_in_place(parallax_) < most_px &&
        motion.dot(sum.ldlt().solve(motion)) < kChi2Limit) {
        held_ += 1;
        return true;
    }
    set_anchor(tracks, map, T_odom_camera, covariance);
    return false;
}

void StillDetector::set_anchor(std::span<const Track> tracks,
                               const LandmarkMap& map,
                               const Pose& T,
                               const Matrix6& covariance) {
    anchor_.clear();
    for (const Track& track : tracks)
        anchor_.push_back({track.slot, map.at(track.slot).id, track.pixel_px.head<2>()});
    T_odom_camera_ = T;
    covariance_ = covariance;
    held_ = 0;
}

}  // namespace surefoot::odometry
