// SPDX-License-Identifier: Apache-2.0
#include "sim/rigs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <array>
#include <numbers>

namespace surefoot::sim {
namespace {

/// A mode of a stereo camera with ideal, rectified images.
struct Mode {
    const char* name;
    int width;
    int height;
    double focal_px;
};

/// First-generation ZED: baseline 0.12 m; nominal focal lengths of its two modes used on the
/// machine.
constexpr std::array<Mode, 2> kModes{
    {{"zed_vga", 672, 376, 342.0}, {"zed_hd720", 1280, 720, 684.0}}};
constexpr double kBaseline_m = 0.12;
constexpr double kPitchDown_rad = 32.0 * std::numbers::pi / 180.0;

camera::StereoRig make_rig(const Mode& mode) {
    camera::PinholeRadTan lens;
    lens.fx_px = mode.focal_px;
    lens.fy_px = mode.focal_px;
    lens.cx_px = 0.5 * (mode.width - 1);
    lens.cy_px = 0.5 * (mode.height - 1);
    const Eigen::Vector3d mount_m(0.075, 0.25, 0.05);

    camera::StereoRig rig;
    rig.name = mode.name;
    rig.left = {lens, mode.width, mode.height};
    rig.right = rig.left;
    rig.T_left_right.translation_m = {kBaseline_m, 0.0, 0.0};
    rig.T_body_left = looking_down(mount_m, kPitchDown_rad);
    camera::ImuMount imu;
    imu.T_body_imu.translation_m = mount_m - Eigen::Vector3d(0.0, 0.5 * kBaseline_m, 0.0);
    rig.imu = imu;
    rig.rectified = true;
    return rig;
}

}  // namespace

Pose looking_down(const Eigen::Vector3d& position_body_m, double pitch_down_rad) {
    Pose T_body_left = T_body_optical();
    // A positive turn about y (left) lowers the x axis.
    T_body_left.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(pitch_down_rad, Eigen::Vector3d::UnitY())) *
        T_body_left.rotation;
    T_body_left.translation_m = position_body_m;
    return T_body_left;
}

std::vector<std::string> rig_presets() {
    std::vector<std::string> names;
    names.reserve(kModes.size());
    for (const Mode& mode : kModes) names.emplace_back(mode.name);
    return names;
}

Result<camera::StereoRig> rig_preset(const std::string& name) {
    for (const Mode& mode : kModes) {
        if (name == mode.name) return make_rig(mode);
    }
    return usage_error(
        fmt::format("simulator: no rig is named '{}'; there are: {}. Another rig can be "
                    "given as a file",
                    name,
                    fmt::join(rig_presets(), ", ")));
}

}  // namespace surefoot::sim
