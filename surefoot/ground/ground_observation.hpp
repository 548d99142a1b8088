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

/// Result for an observation of the ground: accepted, or the first reason why not.
enum class GroundReason : std::uint8_t {
    accepted,
    no_hint,      ///< the expected up direction is zero or not finite
    few_points,   ///< not enough points in range for any plane
    no_plane,     ///< no plane within the tilt limit at an allowed height below the sensor
    few_inliers,  ///< inlier ratio or image share below its limit
    small,        ///< area or extent below its limit, or tilt too uncertain
    not_lowest,   ///< many points lie more than a high step below the plane
    rough,        ///< inlier scatter above its limit, or many points just beyond the inliers
};
[[nodiscard]] const char* to_string(GroundReason reason) noexcept;

/// The best ground plane in a set of points. Without a plane, `observation` is not accepted and has
/// default values. A plane that fails a limit is given for diagnosis with accepted = false.
struct GroundSighting {
    GroundObservation observation;  ///< in the frame of the points
    GroundReason reason = GroundReason::few_points;
    double tilt_rad = 0.0;  ///< angle between the normal and `up_hint` (search_ground: z)
    double area_m2 = 0.0;   ///< area of occupied squares (side: 2 voxels), seen along the normal
    /// Share of the examined pixels that lie on the plane; 0 unless search_ground() computes it.
    double image_share = 0.0;
    /// Zero if the noise of the points is unknown.
    PlaneUncertainty uncertainty;
};

/// Finds the ground (RANSAC within the cone of allowed normals; Lange 2016, 4.3.1). If the height
/// is known (`expected_height_m`), the plane that fits it best wins, for example a platform above a
/// lower floor. Otherwise, of two planes more than a high step apart, the lower one wins, even if a
/// table top has more points. Planes may cross between their points (a ramp and the floor before
/// it) or lie at most a high step apart (a kerb, a landing over treads). Of such planes, the one
/// that begins nearer to the sensor wins.
///
/// `points`: in any frame; not finite = left out. `up_hint`: roughly up, in that frame.
/// `sensor_origin`: in that frame; heights are distances from it. The same input and seed give the
/// same bytes.
[[nodiscard]] GroundSighting sight_ground(const GroundConfig& config,
                                          std::span<const Eigen::Vector3d> points,
                                          const Eigen::Vector3d& up_hint,
                                          const Eigen::Vector3d& sensor_origin,
                                          std::uint64_t seed);

/// Does the same with the points of one frame and the height of base_link. The noise of the points
/// is known: levels closer than `tolerance_m` are separated, and the plane is fitted to all points
/// together (`refine_plane`).
[[nodiscard]] GroundSighting observe_ground(const GroundConfig& config,
                                            const FramePoints& seen,
                                            const Eigen::Vector3d& up_hint_body,
                                            std::uint64_t seed);

}  // namespace surefoot::ground
