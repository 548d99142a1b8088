// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "surefoot/core/report.hpp"
#include "surefoot/ground/ground_config.hpp"
#include "surefoot/ground/plane_covariance.hpp"
#include "surefoot/ground/sample_points.hpp"

namespace surefoot::ground {

/// Why a sighting of the ground is accepted or not; the first that applies.
enum class GroundReason : std::uint8_t {
    accepted,
    no_hint,      ///< the expected up direction is zero or not finite
    few_points,   ///< not enough points in range for any plane
    no_plane,     ///< no plane within the tilt limit, below the sensor at an allowed height
    few_inliers,  ///< inlier ratio below its limit
    small,        ///< area or extent below its limit
    not_lowest,   ///< more than a high step below it there is something else
    rough,  ///< scatter of the inliers above its limit, or no surface that ends above and below
};
[[nodiscard]] const char* to_string(GroundReason reason) noexcept;

/// The best ground plane in a set of points. If none was found, `observation` is not accepted and
/// has its default values; a plane that fails a limit is given for diagnosis with accepted = false.
struct GroundSighting {
    GroundObservation observation;  ///< in the frame of the points
    GroundReason reason = GroundReason::few_points;
    double tilt_rad = 0.0;  ///< between normal and hint
    double area_m2 = 0.0;   ///< occupied squares of two voxel sides, seen along the normal
    /// Pixels on it among those that were looked at; 0 where the points are not those of an image.
    double image_share = 0.0;
    /// Zero where the noise of the points is not known.
    PlaneUncertainty uncertainty;
};

/// Finds the ground (RANSAC within the cone of allowed normals, thesis 4.3.1). The ground is
/// *below*: every supported plane is considered, and the lowest wins even if a table top has more
/// points, unless the height of the sensor is known (`expected_height_m`): then the plane that fits
/// it wins, a platform over a lower floor. Where two planes cross between their points (a ramp and
/// the floor before it), or lie no more than a high step apart (a kerb, a landing over treads), the
/// one that begins nearer to the sensor wins.
///
/// `points` in any frame (not finite = left out), `up_hint` roughly up in that frame,
/// `sensor_origin` in that frame: heights are distances from it. The same input and seed give the
/// same bytes.
[[nodiscard]] GroundSighting sight_ground(const GroundConfig& config,
                                          std::span<const Eigen::Vector3d> points,
                                          const Eigen::Vector3d& up_hint,
                                          const Eigen::Vector3d& sensor_origin,
                                          std::uint64_t seed);

/// The same for what a frame saw, with the height of base_link. The noise of the points is known:
/// levels closer together than `tolerance_m` are told apart, and the plane is as true as all points
/// together (`refine_plane`).
[[nodiscard]] GroundSighting observe_ground(const GroundConfig& config,
                                            const FramePoints& seen,
                                            const Eigen::Vector3d& up_hint_body,
                                            std::uint64_t seed);

}  // namespace surefoot::ground
