// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/alignment.hpp"

#include <fmt/format.h>

#include <cmath>

namespace surefoot::pipeline {
namespace {

constexpr double kGravity_m_s2 = 9.81;
/// Of the known height: far more than a mount or a kerb brings about.
constexpr double kMostHeightShare = 0.35;
constexpr double kDegPerRad = 180.0 / M_PI;

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegPerRad;
}

/// Rotation that takes `up_body` to odom z and keeps the heading of base_link at zero yaw.
Eigen::Quaterniond level(const Eigen::Vector3d& up_body) {
    const Eigen::Vector3d z = up_body.normalized();
    Eigen::Vector3d x = Eigen::Vector3d::UnitX() - z.x() * z;
    // A base_link that looks straight up or down has no heading: take its y axis instead.
    if (x.norm() < 1e-3) x = Eigen::Vector3d::UnitY().cross(z);
    x.normalize();
    Eigen::Matrix3d R_odom_body;
    R_odom_body.row(0) = x.transpose();
    R_odom_body.row(1) = z.cross(x).transpose();
    R_odom_body.row(2) = z.transpose();
    return Eigen::Quaterniond(R_odom_body).normalized();
}

/// Why there is no plane, and what helps.
std::string without_plane(ground::CalibrationReason reason) {
    const char* const advice =
        reason == ground::CalibrationReason::disagreement
            ? "hold the camera still over one level floor while the first frames are taken"
            : "let more level floor be in view of the first frames; where the camera looks steeply "
              "down, give a machine file with the height and pitch of its mount, or set "
              "mount.pitch_deg (and ground.expected_height_m, of base_link)";
    return fmt::format("ground plane: {}: {}", to_string(reason), advice);
}

}  // namespace

void AlignmentConfig::describe(ConfigVisitor& visitor) {
    visitor.number(
        "pitch_deg",
        pitch_deg,
        -90.0,
        90.0,
        "base_link looks this far below the horizon; used when neither plane nor IMU tells");
    visitor.number("still_gyro_rad_s",
                   still_gyro_rad_s,
                   0.0,
                   1.0,
                   "turning faster than this, the accelerometer is not taken for gravity");
    visitor.number("still_force_m_s2",
                   still_force_m_s2,
                   0.0,
                   5.0,
                   "largest deviation of the mean specific force from 9.81 when standing");
    visitor.number(
        "plane_imu_limit_deg",
        plane_imu_limit_deg,
        0.1,
        45.0,
        "plane and accelerometer farther apart than this: the floor is a ramp, gravity wins");
    visitor.number("max_lean_deg",
                   max_lean_deg,
                   0.1,
                   45.0,
                   "base_link may lean so far from how it stood at the start for long");
    visitor.number("max_sway_deg", max_sway_deg, 0.1, 90.0, "farther than any gait leans");
    visitor.number("max_lean_before_step_deg",
                   max_lean_before_step_deg,
                   0.1,
                   20.0,
                   "no step may begin while base_link leans by more");
    visitor.number("max_lean_still_s", max_lean_still_s, 0.1, 600.0, "longest lean at rest");
    visitor.number("max_lean_walking_s",
                   max_lean_walking_s,
                   0.1,
                   600.0,
                   "longest lean in all without having stood upright");
    visitor.number("wait_for_light_s",
                   wait_for_light_s,
                   0.0,
                   600.0,
                   "frames too bright or too dark are waited out so long before odom is placed");
    visitor.number("wait_for_ground_s",
                   wait_for_ground_s,
                   0.0,
                   600.0,
                   "so long the ground is looked for where nothing else tells gravity and "
                   "ground.expected_height_m is known");
}

std::optional<Eigen::Vector3d> up_from_imu(const AlignmentConfig& config,
                                           const Pose& T_body_imu,
                                           std::span<const StereoFrame> frames) {
    Eigen::Vector3d force_sum = Eigen::Vector3d::Zero();
    double gyro_sum = 0.0;
    int samples = 0;
    for (const StereoFrame& frame : frames) {
        for (const ImuSample& sample : frame.imu) {
            force_sum += sample.specific_force_m_s2;
            gyro_sum += sample.angular_velocity_rad_s.norm();
            ++samples;
        }
    }
    constexpr int kMinSamples = 10;
    if (samples < kMinSamples) return std::nullopt;
    const Eigen::Vector3d force = force_sum / samples;
    const bool still = gyro_sum / samples <= config.still_gyro_rad_s &&
                       std::abs(force.norm() - kGravity_m_s2) <= config.still_force_m_s2;
    if (!still) return std::nullopt;
    return (T_body_imu.rotation * force).normalized();
}

Eigen::Vector3d assumed_up(const AlignmentConfig& config) {
    // base_link pitched down by p: x_body = (cos p, 0, -sin p), z_body = (sin p, 0, cos p) in level
    // axes, so up = (0, 0, 1) has the components -sin p along x_body and cos p along z_body.
    const double pitch_rad = config.pitch_deg / kDegPerRad;
    return {-std::sin(pitch_rad), 0.0, std::cos(pitch_rad)};
}

Alignment place_odom(const AlignmentConfig& config,
                     const ground::GroundAlignment& ground,
                     const std::optional<Eigen::Vector3d>& up_imu_body,
                     double expected_height_m) {
    Alignment alignment;
    const double ramp_deg =
        ground.accepted && up_imu_body ? angle_deg(ground.normal_body, *up_imu_body) : 0.0;
    Eigen::Vector3d up_body = assumed_up(config);
    if (ground.accepted && ramp_deg <= config.plane_imu_limit_deg) {
        up_body = ground.normal_body;
        alignment.gravity_source = grid::GravitySource::plane;
        alignment.reason =
            fmt::format("tilt and height from the ground plane, {} sightings agree, {} do not",
                        ground.agreeing,
                        ground.rejected);
    } else if (up_imu_body) {
        up_body = *up_imu_body;
        alignment.gravity_source = grid::GravitySource::imu;
        alignment.reason =
            ground.accepted
                ? fmt::format(
                      "tilt from the accelerometer: the ground leans {:.1f} deg "
                      "(limit {:.1f}), a ramp",
                      ramp_deg,
                      config.plane_imu_limit_deg)
                : fmt::format("tilt from the accelerometer; {}", without_plane(ground.reason));
    } else {
        alignment.reason = fmt::format(
            "tilt assumed from mount.pitch_deg = {:.1f}, and the gate answers ERROR on such a map: "
            "no accelerometer at rest; {}",
            config.pitch_deg,
            without_plane(ground.reason));
    }
    alignment.T_odom_body.rotation = level(up_body);
    if (ground.accepted) {
        // Height along gravity: the point -t up on the plane n . p + h = 0 has t = h / (n . up).
        alignment.has_ground = true;
        alignment.ground_height_m = ground.height_m / ground.normal_body.dot(up_body.normalized());
        alignment.T_odom_body.translation_m.z() = alignment.ground_height_m;
    }
    const double off_m = std::abs(alignment.ground_height_m - expected_height_m);
    if (alignment.has_ground && expected_height_m > 0.0 &&
        off_m > kMostHeightShare * expected_height_m) {
        // Everything else would be off by as much, and nothing else shows it.
        alignment.gravity_source = grid::GravitySource::assumed;
        alignment.reason = fmt::format(
            "the ground lies {:.2f} m below base_link, {:.2f} m are known "
            "(ground.expected_height_m, from the machine file; limit {:.0f} % off): the rig's "
            "baseline or focal length is wrong, or the machine file, or no near ground is in view; "
            "the gate answers ERROR on such a map",
            alignment.ground_height_m,
            expected_height_m,
            100.0 * kMostHeightShare);
    }
    return alignment;
}

}  // namespace surefoot::pipeline
