// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/rigs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "surefoot/core/nearest_names.hpp"

namespace surefoot::sim {
namespace {

constexpr double kPitchDown_rad = 32.0 * std::numbers::pi / 180.0;

Eigen::Vector3d armrest_m() {
    return {0.075, 0.25, 0.05};
}

/// One mode of a stereo camera with ideal, rectified images.
struct Mode {
    const char* name;
    int width;
    int height;
    double focal_px;
    double rate_hz;
};

/// First-generation ZED. The small mode has a calibrated focal length of 341.9 px and bins 4 pixels
/// of 2 um to one. HD720 bins 2 pixels. HD1080 and HD2K are crops of the full sensor. So the focal
/// lengths have the ratio 1 : 2 : 4 : 4. Rates are the highest of each mode. ASSUMPTION: nominal
/// focal length 342 px.
constexpr std::array<Mode, 4> kModes{{{"zed_vga", 672, 376, 342.0, 100.0},
                                      {"zed_hd720", 1280, 720, 684.0, 60.0},
                                      {"zed_hd1080", 1920, 1080, 1368.0, 30.0},
                                      {"zed_hd2k", 2208, 1242, 1368.0, 15.0}}};
constexpr double kZedBaseline_m = 0.12;
constexpr const char* kRolling = "_rolling";

/// Returns the rig on the armrest with an IMU midway between its cameras.
camera::StereoRig mounted(const char* name, const camera::Camera& camera, double baseline_m) {
    camera::StereoRig rig;
    rig.name = name;
    rig.left = camera;
    rig.right = camera;
    rig.T_left_right.translation_m = {baseline_m, 0.0, 0.0};
    rig.T_body_left = looking_down(armrest_m(), kPitchDown_rad);
    camera::ImuMount imu;
    imu.T_body_imu.translation_m = armrest_m() - Eigen::Vector3d(0.0, 0.5 * baseline_m, 0.0);
    rig.imu = imu;
    return rig;
}

camera::StereoRig zed(const Mode& mode, bool rolling) {
    camera::PinholeRadTan lens;
    lens.fx_px = mode.focal_px;
    lens.fy_px = mode.focal_px;
    lens.cx_px = 0.5 * (mode.width - 1);
    lens.cy_px = 0.5 * (mode.height - 1);
    camera::StereoRig rig = mounted(mode.name, {lens, mode.width, mode.height}, kZedBaseline_m);
    rig.rectified = true;
    if (rolling) {
        rig.name += kRolling;
        // ASSUMPTION: no data sheet gives the read-out time. It cannot be longer than the frame
        // period of the fastest rate, and such sensors read out without a pause.
        rig.readout_s = 1.0 / mode.rate_hz;
    }
    return rig;
}

/// DUO MLX: 752x480, baseline 30 mm, 170 deg, global shutter, IMU of 6 axes at 100 Hz. ASSUMPTION:
/// 170 deg from corner to corner with angles proportional to the distance from the centre (f =
/// 446.06 px / 85 deg). A lens of 2 mm on pixels of 6 um would have f = 333 px.
camera::StereoRig duo_mlx() {
    constexpr int kWidth = 752;
    constexpr int kHeight = 480;
    constexpr double kHalfView_rad = 85.0 * std::numbers::pi / 180.0;
    camera::KannalaBrandt lens;
    lens.cx_px = 0.5 * (kWidth - 1);
    lens.cy_px = 0.5 * (kHeight - 1);
    lens.fx_px = std::hypot(0.5 * kWidth, 0.5 * kHeight) / kHalfView_rad;
    lens.fy_px = lens.fx_px;
    camera::StereoRig rig = mounted("duo_mlx", {lens, kWidth, kHeight}, 0.030);
    rig.imu->rate_hz = 100.0;
    return rig;
}

}  // namespace

Pose looking_down(const Eigen::Vector3d& position_body_m, double pitch_down_rad) {
    Pose T_body_left = T_body_optical();
    // A positive turn about y (left) lowers the direction of x.
    T_body_left.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(pitch_down_rad, Eigen::Vector3d::UnitY())) *
        T_body_left.rotation;
    T_body_left.translation_m = position_body_m;
    return T_body_left;
}

std::vector<std::string> rig_presets() {
    std::vector<std::string> names;
    names.reserve(2 * kModes.size() + 1);
    for (const Mode& mode : kModes) names.emplace_back(mode.name);
    for (const Mode& mode : kModes) names.emplace_back(std::string(mode.name) + kRolling);
    names.emplace_back("duo_mlx");
    return names;
}

Result<camera::StereoRig> rig_preset(const std::string& name) {
    for (const Mode& mode : kModes) {
        if (name == mode.name) return zed(mode, false);
        if (name == std::string(mode.name) + kRolling) return zed(mode, true);
    }
    if (name == "duo_mlx") return duo_mlx();
    const std::vector<std::string> names = rig_presets();
    const std::string likely = did_you_mean(name, names);
    return usage_error(
        fmt::format("simulator: no file and no rig is named '{}'{} The rigs are: {}; to use "
                    "another rig, give its file",
                    name,
                    likely.empty() ? "." : likely,
                    fmt::join(names, ", ")));
}

}  // namespace surefoot::sim
