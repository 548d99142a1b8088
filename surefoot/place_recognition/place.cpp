// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/place.hpp"

#include <fmt/format.h>

#include <cmath>

namespace surefoot::place_recognition {
namespace {

constexpr double kUnitTolerance = 1e-6;  ///< tolerance of a quaternion's norm

bool is_rigid(const Pose& T) {
    return T.all_finite() && std::abs(T.rotation.norm() - 1.0) < kUnitTolerance &&
           T.translation_m.cwiseAbs().maxCoeff() <= kMostDistance_m;
}

std::optional<std::string> rig_problem(const camera::RectifiedRig& rig) {
    const auto in = [](double value, double most) { return value > 0.0 && value <= most; };
    if (rig.width < 1 || rig.height < 1 || rig.width > kMostImage_px || rig.height > kMostImage_px)
        return fmt::format("images of {} x {} pixels; each side must be from 1 to {}",
                           rig.width,
                           rig.height,
                           kMostImage_px);
    if (!in(rig.fx_px, 1e5) || !in(rig.fy_px, 1e5))
        return fmt::format("focal lengths of {} and {} px; both must be above 0 and at most 1e5",
                           rig.fx_px,
                           rig.fy_px);
    if (!(std::abs(rig.cx_px) <= 1e5) || !(std::abs(rig.cy_px) <= 1e5))
        return fmt::format("a principal point at ({}, {}) px; both must be from -1e5 to 1e5",
                           rig.cx_px,
                           rig.cy_px);
    if (!in(rig.baseline_m, 10.0))
        return fmt::format("a baseline of {} m; it must be above 0 and at most 10", rig.baseline_m);
    if (!is_rigid(rig.T_body_camera))
        return "a camera pose in base_link that is not finite, not rigid or more than 10 km from "
               "base_link";
    return std::nullopt;
}

std::optional<std::string> view_problem(const View& view) {
    if (auto problem = rig_problem(view.rig)) return problem;
    if (view.features.size() > static_cast<std::size_t>(kMostFeatures))
        return fmt::format(
            "{} features; at most {} are allowed", view.features.size(), kMostFeatures);
    for (const Feature& feature : view.features) {
        const Eigen::Vector3d px = feature.pixel_px.cast<double>();
        const bool inside =
            px.x() >= 0.0 && px.x() < view.rig.width && px.y() >= 0.0 && px.y() < view.rig.height;
        if (!inside || !(px.x() - px.z() > 0.0) || !(px.x() - px.z() <= kMostImage_px))
            return fmt::format(
                "a feature at ({}, {}, {}) px that lies outside its image or has no depth",
                px.x(),
                px.y(),
                px.z());
    }
    return std::nullopt;
}

}  // namespace

std::optional<std::string> Place::problem() const {
    if (keyframes.size() > static_cast<std::size_t>(kMostKeyframes))
        return fmt::format(
            "{} keyframes; at most {} are allowed", keyframes.size(), kMostKeyframes);
    for (std::size_t i = 0; i < keyframes.size(); ++i) {
        auto problem = view_problem(keyframes[i].view);
        if (!problem && !is_rigid(keyframes[i].T_map_body))
            problem =
                "a pose in the map that is not finite, not rigid or more than 10 km from the "
                "origin";
        if (problem) return fmt::format("keyframe {} has {}", i, *problem);
    }
    return std::nullopt;
}

}  // namespace surefoot::place_recognition
