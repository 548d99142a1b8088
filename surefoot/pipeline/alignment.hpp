// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/grid/map_snapshot.hpp"
#include "surefoot/ground/ground_calibration.hpp"

namespace surefoot::pipeline {

struct AlignmentConfig {
    double pitch_deg = 0.0;            ///< of base_link below the horizon when nothing measures it
    double still_gyro_rad_s = 0.15;    ///< MEMS bias (EuRoC 0.08) plus noise; above it the
                                       ///< accelerometer is not taken for gravity
    double still_force_m_s2 = 0.3;     ///< as above: deviation of the mean force from 9.81
    double plane_imu_limit_deg = 3.0;  ///< plane and gravity farther apart: the floor is a ramp
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
    double wait_for_light_s = 60.0;   ///< at most; the sun warm-up of the thesis took 10-30 s
    double wait_for_ground_s = 10.0;  ///< likewise, for what tells gravity; see start.hpp
    void describe(ConfigVisitor& visitor);
};

/// Where odom lies: z against gravity, origin on the ground under the first base_link if the ground
/// was found, else at that base_link; x along the first heading.
struct Alignment {
    Pose T_odom_body;  ///< of the first frame
    grid::GravitySource gravity_source = grid::GravitySource::assumed;
    bool has_ground = false;
    double ground_height_m = 0.0;  ///< base_link above the ground; 0 without ground
    std::string reason;            ///< one sentence: what was used and what was not, and why
};

/// Gravity direction in base_link measured by the accelerometer while the rig stands still.
[[nodiscard]] std::optional<Eigen::Vector3d> up_from_imu(const AlignmentConfig& config,
                                                         const Pose& T_body_imu,
                                                         std::span<const StereoFrame> frames);

/// Direction of up in base_link that a level machine would have with the configured pitch.
[[nodiscard]] Eigen::Vector3d assumed_up(const AlignmentConfig& config);

/// Combines the averaged ground plane and the accelerometer: tilt from the plane, from the
/// accelerometer when there is no plane or the two disagree (a ramp), else assumed.
///
/// Vision alone cannot tell a wrong baseline: all it sees is larger or smaller by one factor. Where
/// the height of base_link over its ground is known (`expected_height_m`; 0 = unknown) and the
/// plane lies by far elsewhere, the source of gravity is `assumed`, whatever told it, and the
/// reason says so: the gate does not work on such a map.
[[nodiscard]] Alignment place_odom(const AlignmentConfig& config,
                                   const ground::GroundAlignment& ground,
                                   const std::optional<Eigen::Vector3d>& up_imu_body,
                                   double expected_height_m = 0.0);

}  // namespace surefoot::pipeline
