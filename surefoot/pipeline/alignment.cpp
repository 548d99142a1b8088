// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/alignment.hpp"

#include <fmt/format.h>

#include <cmath>

#include "surefoot/core/angles.hpp"

namespace surefoot::pipeline {
namespace {

/// Largest accepted difference between measured and known height, as a share of the known height.
/// No mount and no kerb explains a larger difference.
constexpr double kMostHeightShare = 0.35;

/// Returns the rotation that turns `up_body` to odom z and sets the heading of base_link to zero.
Eigen::Quaterniond level(const Eigen::Vector3d& up_body) {
    const Eigen::Vector3d z = up_body.normalized();
    Eigen::Vector3d x = Eigen::Vector3d::UnitX() - z.x() * z;
    // If base_link points straight up or down, its x axis has no heading. Use its y axis instead.
    if (x.norm() < 1e-3) x = Eigen::Vector3d::UnitY().cross(z);
    x.normalize();
    Eigen::Matrix3d R_odom_body;
    R_odom_body.row(0) = x.transpose();
    R_odom_body.row(1) = z.cross(x).transpose();
    R_odom_body.row(2) = z.transpose();
    return Eigen::Quaterniond(R_odom_body).normalized();
}

double angle_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Returns the text that names the defect of the best plane of a search.
const char* obstacle(ground::GroundReason reason) {
    switch (reason) {
        case ground::GroundReason::rough: return ", too uneven for a plane";
        case ground::GroundReason::not_lowest: return ", but something lies far below it";
        default: return "";
    }
}

/// Returns the text that names the cause of a missing plane and the correction.
std::string without_plane(ground::CalibrationReason reason, const GroundView& look) {
    if (reason == ground::CalibrationReason::disagreement)
        return fmt::format(
            "ground plane: {}: hold the camera still over one level floor while the first frames "
            "are taken",
            to_string(reason));
    if (look.searched)
        return fmt::format(
            "ground plane: {}: tilt 0-{:.0f} deg was searched; {:.0f} % of the image looks like "
            "floor{}: point the camera lower so that more level floor is in view of the first "
            "frames, or give mount.pitch_deg or a machine file",
            to_string(reason),
            look.search_down_deg,
            100.0 * look.image_share,
            obstacle(look.reason));
    return fmt::format(
        "ground plane: {}: show more level floor in the first frames, or give a machine file with "
        "the height and pitch of the mount, or set mount.pitch_deg (and "
        "ground.expected_height_m, the height of base_link)",
        to_string(reason));
}

std::string sightings(const ground::GroundAlignment& ground) {
    return fmt::format("{} observations agree, {} do not", ground.agreeing, ground.rejected);
}

/// Finds the up direction from the available sources; sets the source, the uncertainty and the
/// reason.
Direction find_up(const AlignmentConfig& config,
                  const ground::GroundAlignment& ground,
                  const std::optional<Direction>& up_imu,
                  const GroundView& look,
                  Alignment& alignment) {
    const Direction normal{ground.normal_body, ground.uncertainty.normal_covariance};
    Direction up{assumed_up(config), {}};
    if (up_imu && ground.accepted) {
        const FusedUp fused = fuse_up(config.gravity, normal, *up_imu);
        up = fused.up;
        alignment.gravity_source = grid::GravitySource::imu;
        alignment.ground_lean_rad = angle_rad(normal.unit_body, up.unit_body);
        alignment.tilt_sigma_rad = up.sigma_rad();
        alignment.reason = fmt::format(
            "tilt from the accelerometer and the ground plane, 1 sigma {:.2f} deg; the ground "
            "leans {:.2f} deg and is built level with a probability of {:.0f} %; height from the "
            "plane, {}",
            kDegPerRad * alignment.tilt_sigma_rad,
            kDegPerRad * alignment.ground_lean_rad,
            100.0 * fused.level_probability,
            sightings(ground));
    } else if (up_imu) {
        up = *up_imu;
        alignment.gravity_source = grid::GravitySource::imu;
        alignment.tilt_sigma_rad = up.sigma_rad();
        alignment.reason = fmt::format("tilt from the accelerometer, 1 sigma {:.2f} deg; {}",
                                       kDegPerRad * alignment.tilt_sigma_rad,
                                       without_plane(ground.reason, look));
    } else if (ground.accepted) {
        up = up_from_plane(config.gravity, normal);
        alignment.gravity_source = grid::GravitySource::plane;
        alignment.tilt_sigma_rad = up.sigma_rad();
        alignment.reason = fmt::format(
            "tilt and height from the ground plane, {}{}; the plane itself is known within "
            "{:.2f} deg, but its slope is unknown: 1 sigma of the vertical {:.1f} deg, which the "
            "gate subtracts from its tilt limit (use an IMU to measure the vertical)",
            sightings(ground),
            look.searched
                ? fmt::format(" (mounting unknown: tilt 0-{:.0f} deg was searched, {:.0f} "
                              "% of the image is ground)",
                              look.search_down_deg,
                              100.0 * look.image_share)
                : "",
            kDegPerRad * normal.sigma_rad(),
            kDegPerRad * alignment.tilt_sigma_rad);
    } else {
        alignment.reason = fmt::format(
            "tilt assumed from mount.pitch_deg = {:.1f}, so the gate answers ERROR on"
            " this map: no accelerometer measured gravity at rest; {}",
            config.pitch_deg,
            without_plane(ground.reason, look));
    }
    return up;
}

}  // namespace

void AlignmentConfig::describe(ConfigVisitor& visitor) {
    visitor.number(
        "pitch_deg",
        pitch_deg,
        -90.0,
        90.0,
        "pitch of base_link below the horizon; used if neither a ground plane nor an IMU measures "
        "the pitch");
    visitor.number("still_gyro_rad_s",
                   still_gyro_rad_s,
                   0.0,
                   1.0,
                   "largest turn rate at which the machine counts as standing still, so that the "
                   "accelerometer measures gravity");
    visitor.number(
        "still_force_m_s2",
        still_force_m_s2,
        0.0,
        5.0,
        "largest difference between the mean specific force and 9.81 m/s2 at which the machine "
        "counts as standing still");
    visitor.group("gravity", gravity);
    visitor.number(
        "max_lean_deg",
        max_lean_deg,
        0.1,
        45.0,
        "limit of the lean of base_link, measured from its first attitude; the mount counts "
        "as moved if the lean stays above this limit");
    visitor.number(
        "max_sway_deg",
        max_sway_deg,
        0.1,
        90.0,
        "lean of base_link that counts as a moved mount after 0.5 s; set it above the lean of any "
        "gait");
    visitor.number("max_lean_before_step_deg",
                   max_lean_before_step_deg,
                   0.1,
                   20.0,
                   "largest lean of base_link at which a step may begin");
    visitor.number(
        "max_lean_still_s",
        max_lean_still_s,
        0.1,
        600.0,
        "longest lean above mount.max_lean_deg while the machine stands still; after a longer lean "
        "the mount counts as moved");
    visitor.number(
        "max_lean_walking_s",
        max_lean_walking_s,
        0.1,
        600.0,
        "longest total lean above mount.max_lean_deg since the last upright phase; after a "
        "longer total lean the mount counts as moved");
    visitor.number("wait_for_exposure_s",
                   wait_for_exposure_s,
                   0.0,
                   600.0,
                   "longest wait for well-exposed frames before the odom frame is placed");
    visitor.number("wait_for_ground_s",
                   wait_for_ground_s,
                   0.0,
                   600.0,
                   "longest search for the ground if no other source gives gravity and "
                   "ground.expected_height_m is known");
    visitor.number("wait_for_search_s",
                   wait_for_search_s,
                   0.0,
                   10.0,
                   "longest search for the ground if the mounting of the camera is unknown; if no "
                   "ground is found, the first frames place the odom frame");
}

Eigen::Vector3d assumed_up(const AlignmentConfig& config) {
    // base_link is pitched down by p. In level axes x_body = (cos p, 0, -sin p) and z_body = (sin
    // p, 0, cos p). So up = (0, 0, 1) has the components -sin p along x_body and cos p along
    // z_body.
    const double pitch_rad = config.pitch_deg / kDegPerRad;
    return {-std::sin(pitch_rad), 0.0, std::cos(pitch_rad)};
}

Alignment place_odom(const AlignmentConfig& config,
                     const ground::GroundAlignment& ground,
                     const std::optional<Direction>& up_imu,
                     double expected_height_m,
                     const GroundView& look) {
    Alignment alignment;
    const Direction up = find_up(config, ground, up_imu, look, alignment);
    alignment.T_odom_body.rotation = level(up.unit_body);
    if (ground.accepted) {
        // Height along gravity: the point -t up on the plane n . p + h = 0 has t = h / (n . up).
        alignment.has_ground = true;
        alignment.ground_height_m = ground.height_m / ground.normal_body.dot(up.unit_body);
        alignment.T_odom_body.translation_m.z() = alignment.ground_height_m;
    }
    const double off_m = std::abs(alignment.ground_height_m - expected_height_m);
    if (alignment.has_ground && expected_height_m > 0.0 &&
        off_m > kMostHeightShare * expected_height_m) {
        // All lengths would be wrong by the same factor, and no other test detects this error.
        alignment.gravity_source = grid::GravitySource::assumed;
        alignment.tilt_sigma_rad = std::numeric_limits<double>::quiet_NaN();
        alignment.reason = fmt::format(
            "the ground lies {:.2f} m below base_link, but {:.2f} m are expected "
            "(ground.expected_height_m, from the machine file; largest difference {:.0f} %): "
            "check the rig's baseline, its focal length and the machine file, and "
            "show near ground; the gate answers ERROR on this map",
            alignment.ground_height_m,
            expected_height_m,
            100.0 * kMostHeightShare);
    }
    return alignment;
}

}  // namespace surefoot::pipeline
