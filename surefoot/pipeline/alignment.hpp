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
    double pitch_deg = 0.0;          ///< of base_link below the horizon when nothing measures it
    double still_gyro_rad_s = 0.15;  ///< MEMS bias (EuRoC 0.08) plus noise; above it the
                                     ///< accelerometer is not taken for gravity
    double still_force_m_s2 = 0.3;   ///< as above: deviation of the mean force from 9.81
    GravityConfig gravity;           ///< what plane and accelerometer are worth
    /// The mount has moved (mount_monitor.hpp) when base_link leans more than `max_lean_deg` from
    /// how it stood at the start and does so for `max_lean_still_s` at rest, or for
    /// `max_lean_walking_s` without having come home; at once beyond `max_sway_deg`. ASSUMPTION,
    /// after the simulated REX: home within 0.3 deg, sways by 5.4, stands leaning for 2 s at most.
    double max_lean_deg = 1.0;
    /// No step may begin while base_link leans by more: it is in mid-step, or was just knocked.
    double max_lean_before_step_deg = 0.7;
    double max_sway_deg = 7.0;
    double max_lean_still_s = 4.0;
    double max_lean_walking_s = 12.0;
    double wait_for_exposure_s = 60.0;   ///< at most; the sun warm-up of the thesis took 10-30 s
    double wait_for_ground_s = 10.0;  ///< likewise, for what tells gravity; see start.hpp
    double wait_for_search_s = 3.0;   ///< likewise, with a mount that nobody knows; see start.hpp
    void describe(ConfigVisitor& visitor);
};

/// Where odom lies: z against gravity, origin on the ground under the first base_link if the ground
/// was found, else at that base_link; x along the first heading.
struct Alignment {
    Pose T_odom_body;  ///< of the first frame
    grid::GravitySource gravity_source = grid::GravitySource::assumed;
    bool has_ground = false;
    double ground_height_m = 0.0;  ///< base_link above the ground; 0 without ground
    /// One sigma, about any horizontal axis, of the angle between odom's z axis and the vertical.
    /// NaN where gravity is assumed.
    double tilt_sigma_rad = std::numeric_limits<double>::quiet_NaN();
    double ground_lean_rad = 0.0;  ///< of the ground in odom, where an accelerometer tells
    std::string reason;            ///< what was used and what was not, and why
};

/// How the ground was looked for, for the words of `Alignment::reason`.
struct GroundView {
    bool searched = false;  ///< the mount is not known: `ground.search_down_deg` says how far
    double search_down_deg = 0.0;
    double image_share = 0.0;  ///< of the best plane in any frame
    ground::GroundReason reason = ground::GroundReason::few_points;  ///< of that plane
};

/// Direction of up in base_link that a level machine would have with the configured pitch.
[[nodiscard]] Eigen::Vector3d assumed_up(const AlignmentConfig& config);

/// Combines the averaged ground plane and the accelerometer by their covariances (gravity.hpp). The
/// source of gravity is `imu` where there is an accelerometer, else `plane`, else `assumed`. The
/// floor's slope is then part of `tilt_sigma_rad`.
///
/// Vision alone cannot tell a wrong baseline: all it sees is larger or smaller by one factor. Where
/// the height of base_link over its ground is known (`expected_height_m`; 0 = unknown) and the
/// plane lies by far elsewhere, the source of gravity is `assumed`, whatever told it, and the
/// reason says so: the gate does not work on such a map.
[[nodiscard]] Alignment place_odom(const AlignmentConfig& config,
                                   const ground::GroundAlignment& ground,
                                   const std::optional<Direction>& up_imu,
                                   double expected_height_m = 0.0,
                                   const GroundView& look = {});

}  // namespace surefoot::pipeline
