// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/stereo_rig.hpp"

#include <fmt/format.h>

#include <cmath>

#include "surefoot/camera/rig_units.hpp"

namespace surefoot::camera {
namespace {

using Problem = std::optional<std::string>;

/// Largest norm error of a quaternion that was read with seven decimals.
constexpr double kUnitTolerance = 1e-6;
constexpr double kMaxRelativeRotation_deg = 45.0;
/// Limits for rigs marked rectified. Within these limits an error moves a row by less than 0.01 px
/// at 2000 px from the centre.
constexpr double kRectifiedRotation_rad = 5e-6;
constexpr double kRectifiedPixel_px = 1e-3;
constexpr double kDegreesPerRadian = 57.29577951308232;

Problem pose_problem(const Pose& pose, const char* name) {
    if (!pose.all_finite())
        return fmt::format("{} holds a value that is not finite: correct the calibration", name);
    const double norm = pose.rotation.norm();
    if (std::abs(norm - 1.0) > kUnitTolerance) {
        return fmt::format(
            "{} is not rigid: its rotation quaternion has norm {:.6f}, not 1; correct the "
            "calibration",
            name,
            norm);
    }
    return std::nullopt;
}

Problem mounted_problem(const Pose& T_body_sensor, const char* name) {
    if (auto found = pose_problem(T_body_sensor, name)) return found;
    return mount_problem(name, T_body_sensor.translation_m.norm());
}

Problem pair_pose_problem(const Pose& T_left_right) {
    const Eigen::Vector3d& t = T_left_right.translation_m;
    const double length_m = t.norm();
    if (auto found = baseline_problem(length_m)) return found;
    const double angle_deg = log_so3(T_left_right.rotation).norm() * kDegreesPerRadian;
    if (angle_deg > kMaxRelativeRotation_deg) {
        return fmt::format(
            "the cameras are turned {:.1f} deg against each other; at most {} deg can be rectified",
            angle_deg,
            kMaxRelativeRotation_deg);
    }
    if (t.x() < -0.5 * length_m) {
        return fmt::format(
            "the right camera lies {:.3f} m to the left of the left one; "
            "swap the cameras or invert T_left_right",
            -t.x());
    }
    // More than 45 deg from the x axis, the cameras lie above each other rather than side by side.
    if (t.x() * t.x() < 0.5 * length_m * length_m) {
        return fmt::format(
            "baseline ({:.3f}, {:.3f}, {:.3f}) m must point along x of the left camera; "
            "vertical stereo is not supported",
            t.x(),
            t.y(),
            t.z());
    }
    return std::nullopt;
}

Problem ideal_lens_problem(const Camera& camera, const char* name) {
    const auto* pinhole = std::get_if<PinholeRadTan>(&camera.model);
    if (pinhole == nullptr) {
        return fmt::format(
            "the rig is marked rectified but its {} camera has a {} model; give the calibration of "
            "the rectified images, or do not mark the rig rectified",
            name,
            std::holds_alternative<KannalaBrandt>(camera.model) ? "fisheye" : "rational pinhole");
    }
    if (pinhole->has_distortion()) {
        return fmt::format(
            "the rig is marked rectified but its {} camera has distortion "
            "(k1 = {}, k2 = {}, p1 = {}, p2 = {}, k3 = {}); give the calibration of the rectified "
            "images, or do not mark the rig rectified",
            name,
            pinhole->k1,
            pinhole->k2,
            pinhole->p1,
            pinhole->p2,
            pinhole->k3);
    }
    return std::nullopt;
}

Problem equal_intrinsics_problem(const PinholeRadTan& left, const PinholeRadTan& right) {
    const struct {
        const char* name;
        double left, right;
    } rows[] = {
        {"fx_px", left.fx_px, right.fx_px},
        {"fy_px", left.fy_px, right.fy_px},
        {"cx_px", left.cx_px, right.cx_px},
        {"cy_px", left.cy_px, right.cy_px},
    };
    for (const auto& row : rows) {
        if (std::abs(row.left - row.right) > kRectifiedPixel_px) {
            return fmt::format(
                "the rig is marked rectified but {} differs: {} left, {} right; give the "
                "calibration of the rectified images, or do not mark the rig rectified",
                row.name,
                row.left,
                row.right);
        }
    }
    return std::nullopt;
}

Problem rectified_pose_problem(const Pose& T_left_right) {
    const double turn_rad = log_so3(T_left_right.rotation).norm();
    if (turn_rad > kRectifiedRotation_rad) {
        return fmt::format(
            "the rig is marked rectified but its cameras are turned {:.5f} deg "
            "against each other; give the calibration of the rectified images, or do not mark the "
            "rig rectified",
            turn_rad * kDegreesPerRadian);
    }
    const Eigen::Vector3d& t = T_left_right.translation_m;
    if (std::hypot(t.y(), t.z()) > kRectifiedRotation_rad * std::abs(t.x())) {
        return fmt::format(
            "the rig is marked rectified but its baseline ({}, {}, {}) m is not along x; give the "
            "calibration of the rectified images, or do not mark the rig rectified",
            t.x(),
            t.y(),
            t.z());
    }
    return std::nullopt;
}

Problem rectified_problem(const StereoRig& rig) {
    if (auto found = ideal_lens_problem(rig.left, "left")) return found;
    if (!rig.right) return std::nullopt;
    if (auto found = ideal_lens_problem(*rig.right, "right")) return found;
    if (auto found = equal_intrinsics_problem(std::get<PinholeRadTan>(rig.left.model),
                                              std::get<PinholeRadTan>(rig.right->model))) {
        return found;
    }
    return rectified_pose_problem(rig.T_left_right);
}

Problem pair_problem(const StereoRig& rig) {
    if (auto found = rig.right->problem()) return "right camera: " + *found;
    if (rig.left.width != rig.right->width || rig.left.height != rig.right->height) {
        return fmt::format(
            "image sizes differ: left {}x{}, right {}x{} px; both cameras need the same size",
            rig.left.width,
            rig.left.height,
            rig.right->width,
            rig.right->height);
    }
    if (auto found = pose_problem(rig.T_left_right, "T_left_right")) return found;
    return pair_pose_problem(rig.T_left_right);
}

Problem rate_problem(const char* name, double value, double min, double max, const char* unit) {
    if (value >= min && value <= max) return std::nullopt;
    return fmt::format("{} = {} must be between {} and {} {}", name, value, min, max, unit);
}

}  // namespace

std::optional<std::string> StereoRig::problem() const {
    if (auto found = left.problem()) return "left camera: " + *found;
    if (right) {
        if (auto found = pair_problem(*this)) return found;
    }
    if (rectified) {
        if (auto found = rectified_problem(*this)) return found;
    }
    if (T_body_left) {
        if (auto found = mounted_problem(*T_body_left, "T_body_left")) return found;
    }
    if (imu) {
        if (auto found = mounted_problem(imu->T_body_imu, "T_body_imu")) return found;
        if (auto found = rate_problem("imu.rate_hz", imu->rate_hz, 1.0, 1e5, "Hz")) return found;
    }
    if (auto found = rate_problem("rate_hz", rate_hz, 0.0, 1e4, "Hz")) return found;
    return rate_problem("readout_s", readout_s, 0.0, 1.0, "s");
}

Pose StereoRig::body_from_left() const {
    return T_body_left ? *T_body_left : T_body_optical();
}

}  // namespace surefoot::camera
