// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/grid/map_snapshot.hpp"
#include "surefoot/ground/ground_calibration.hpp"
#include "surefoot/pipeline/gravity.hpp"

namespace surefoot::pipeline {

struct AlignmentConfig {
    double pitch_deg = 0.0;          ///< pitch below the horizon, used if not measured
    double still_gyro_rad_s = 0.15;  ///< largest turn rate that counts as rest:
                                     ///< MEMS bias (EuRoC 0.08 rad/s) plus noise
    double still_force_m_s2 = 0.3;   ///< largest |mean force - 9.81 m/s^2| at rest
    GravityConfig gravity;           ///< uncertainty of the plane and the accelerometer
    /// The mount counts as moved (mount_monitor.hpp) if base_link leans by over `max_lean_deg` from
    /// its first attitude: for `max_lean_still_s` at rest, or `max_lean_walking_s` in all without
    /// an upright phase; above `max_sway_deg` after 0.5 s. ASSUMPTION, from the simulated REX: it
    /// sways by 5.4 deg, returns within 0.3 deg, and stands leaning for at most 2 s.
    double max_lean_deg = 1.0;
    /// base_link leans more in mid-step, or after a knock of the camera: no step may begin.
    double max_lean_before_step_deg = 0.7;
    double max_sway_deg = 7.0;
    double max_lean_still_s = 4.0;
    double max_lean_walking_s = 12.0;
    double wait_for_exposure_s = 60.0;  ///< longest wait; a camera needed 10-30 s (Lange 2016)
    double wait_for_ground_s = 10.0;    ///< longest search for the vertical (start.hpp)
    double wait_for_search_s = 3.0;     ///< longest search with unknown mounting (start.hpp)
    void describe(ConfigVisitor& visitor);
};

/// Placement of odom. z points against gravity and x along the first heading. The origin lies on
/// the ground under the first base_link if the ground was found, else at the first base_link.
struct Alignment {
    Pose T_odom_body;  ///< pose of the first frame
    grid::GravitySource gravity_source = grid::GravitySource::assumed;
    bool has_ground = false;
    double ground_height_m = 0.0;  ///< height of base_link; 0 without ground
    /// One sigma of the angle between odom's z axis and the vertical, about any horizontal axis.
    /// NaN if gravity is assumed.
    double tilt_sigma_rad = std::numeric_limits<double>::quiet_NaN();
    double ground_lean_rad = 0.0;  ///< tilt of the ground in odom, if an IMU measures gravity
    std::string reason;            ///< sources that were used, and why others were not
};

/// Result of the search for the ground; the text of `Alignment::reason` uses it.
struct GroundView {
    bool searched = false;  ///< true: tilts to `search_down_deg` were searched
    double search_down_deg = 0.0;
    double image_share = 0.0;  ///< image share of the best plane in any frame
    ground::GroundReason reason = ground::GroundReason::few_points;  ///< reason against that plane
};

/// Returns the up direction in base_link of a level machine with the configured pitch.
[[nodiscard]] Eigen::Vector3d assumed_up(const AlignmentConfig& config);

/// Combines the averaged ground plane and the accelerometer by their covariances (gravity.hpp). The
/// source of gravity is `imu` with `up_imu`, else `plane` with an accepted ground plane, else
/// `assumed`. With `plane`, `tilt_sigma_rad` includes the slope of the floor.
///
/// Vision alone cannot detect a wrong baseline, because it scales all lengths alike. If the height
/// of base_link over its ground is known (`expected_height_m`; 0 = unknown) and the measured height
/// differs by over 35 %, the source of gravity becomes `assumed`. Then `reason` states the two
/// heights, and the gate answers ERROR on the map.
[[nodiscard]] Alignment place_odom(const AlignmentConfig& config,
                                   const ground::GroundAlignment& ground,
                                   const std::optional<Direction>& up_imu,
                                   double expected_height_m = 0.0,
                                   const GroundView& look = {});

}  // namespace surefoot::pipeline
