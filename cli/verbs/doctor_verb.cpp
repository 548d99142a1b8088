// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <thread>

#include "cli/cameras.hpp"
#include "cli/json/program_answers.hpp"
#include "cli/rig_view.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "service/console/source.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/perception/fit_settings.hpp"
#include "surefoot/pipeline/fine_depth.hpp"
#include "surefoot/sim/sensors/rigs.hpp"
#include "surefoot/stereo/confidence.hpp"

namespace surefoot::app {
namespace {

struct DoctorOptions {
    CommonOptions common;
    std::string rig_file;
    std::string machine;
};

/// Returns the part of the level floor that the middle column of the rectified camera sees.
FloorView floor_view(const camera::RectifiedRig& rig, double base_height_m) {
    const auto floor_x_m = [&](double row_px) {
        const Eigen::Vector3d ray_camera(0.0, (row_px - rig.cy_px) / rig.fy_px, 1.0);
        const Eigen::Vector3d ray_body = rig.T_body_camera.rotation * ray_camera;
        const double camera_height_m = base_height_m + rig.T_body_camera.translation_m.z();
        if (ray_body.z() >= 0.0) return std::numeric_limits<double>::infinity();
        return rig.T_body_camera.translation_m.x() - camera_height_m * ray_body.x() / ray_body.z();
    };
    return {floor_x_m(rig.height - 1.0), floor_x_m(0.0)};
}

/// Smallest standard deviation that the matcher reports; it occurs on well textured ground.
/// `doctor` and `depth-accuracy --design` compute the standard deviations of depth from this value.
/// The standard deviation of a typical pixel of a scene is 50 % larger.
constexpr double kDisparitySigma_px = static_cast<double>(stereo::kSigmaFloor_px);

RigView view_of(const camera::StereoRig& rig,
                const camera::RectifiedRig& r,
                const Machine& machine) {
    RigView view;
    view.name = rig.name;
    view.width = r.width;
    view.height = r.height;
    const int scale = rig.right ? pipeline::fine_scale({}, r.width, r.height) : 1;
    view.coarse_width = r.width / scale;
    view.coarse_height = r.height / scale;
    view.focal_px = r.fx_px;
    view.baseline_m = r.baseline_m;
    view.disparity_sigma_px = kDisparitySigma_px;
    for (const double z_m : {0.5, 1.0, 2.0, 3.0}) {
        // sigma_z = z^2 sigma_d / (f b)
        view.depths.push_back({z_m, z_m * z_m * kDisparitySigma_px / r.depth_to_disparity_px_m()});
    }
    view.floor = floor_view(r, 1e-4 * machine.sole_depth_tenth_mm);
    for (int code = 0; code < Machine::kMovementCodes; ++code) {
        const Movement& m = machine.movements[static_cast<std::size_t>(code)];
        if (!m.configured || m.forward_tenth_mm <= 0 || m.left_tenth_mm != 0) continue;
        const GroundBox& foot = machine.left_foot;
        const double toe_m =
            1e-4 * (m.forward_tenth_mm + foot.center_x_tenth_mm + 0.5 * foot.length_tenth_mm);
        view.steps.push_back({code, m.name.data(), toe_m, toe_m <= view.floor.near_m});
    }
    return view;
}

void print(const RigView& view) {
    fmt::print("rig {}: images of {}x{} px, focal length {:.1f} px, baseline {:.1f} mm\n",
               view.name,
               view.width,
               view.height,
               view.focal_px,
               1e3 * view.baseline_m);
    if (view.coarse_width < view.width) {
        const pipeline::FineConfig fine;
        fmt::print(
            "two rates: every frame is matched at {}x{} px, and the ground {:g} to {:g} m ahead "
            "also at {}x{} px, every {:g} s (settings fine.*)\n",
            view.coarse_width,
            view.coarse_height,
            fine.from_m,
            fine.to_m,
            view.width,
            view.height,
            fine.every_s);
    } else {
        fmt::print(
            "one rate: every frame is matched at full size. If a stereo camera has a mode of about "
            "1280x720 px, this mode makes the depth of the ground ahead more precise\n");
    }
    fmt::print(
        "standard deviation of depth on well textured ground (standard deviation of a disparity "
        "{:g} px):",
        view.disparity_sigma_px);
    for (const auto& depth : view.depths)
        fmt::print("  {:.1f} mm at {:.1f} m", 1e3 * depth.sigma_m, depth.z_m);
    fmt::print(
        "\nblind zone: the camera never sees floor nearer than {:.2f} m ahead of base_link; the "
        "view of the floor ends at {:.2f} m\n",
        view.floor.near_m,
        view.floor.far_m);
    for (const auto& step : view.steps) {
        fmt::print(
            "command {} ({}): the foot lands up to {:.2f} m ahead of base_link; {}\n",
            step.command,
            step.name,
            step.toe_m,
            step.remembered
                ? "the whole foot lands in the blind zone, on ground that only the map contains"
                : "a part of the foot lands on ground that the camera sees now");
    }
}

void print(const std::vector<CameraNode>& cameras) {
    if (cameras.empty()) fmt::print("cameras: no camera found (there is no /dev/video*)\n");
    for (const CameraNode& node : cameras) {
        if (node.problem.empty()) {
            fmt::print("camera {}: {}\n", node.device, node.card);
        } else {
            fmt::print("this device is not a usable camera: {}\n", node.problem);
        }
    }
}

/// `surefoot doctor`: checks the installation, and prints the cameras and the blind zone of a rig
/// on a machine.
int doctor(const DoctorOptions& options) {
    const auto machine = load_machine(options.machine.empty() ? "rex" : options.machine);
    if (!machine) return report(machine.error());
    const auto rig =
        options.rig_file.empty() ? sim::rig_preset("zed_vga") : read_noted_rig(options.rig_file);
    if (!rig) return report(rig.error());
    const auto rectifier = camera::Rectifier::make(mounted_rig(*rig, *machine));
    if (!rectifier) return report(rectifier.error());
    const RigView view = view_of(*rig, rectifier->rig(), machine->value().machine);
    const auto threads = static_cast<int>(std::thread::hardware_concurrency());
    const std::vector<CameraNode> cameras = camera_nodes();
    if (options.common.json) {
        print_answer(doctor_json(SUREFOOT_VERSION, threads, machine->value().name, view, cameras));
        return kExitOk;
    }
    fmt::print("surefoot {}: {} threads, no GPU needed\nsettings: valid\nmachine {}: valid\n",
               SUREFOOT_VERSION,
               threads,
               machine->value().name);
    print(cameras);
    print(view);
    return kExitOk;
}

}  // namespace

void add_doctor(VerbGroup verbs) {
    auto [verb, o] =
        verbs.add<DoctorOptions>("doctor",
                                 "check the computer, the settings, the cameras and the machine "
                                 "file; print the blind zone and the depth precision of one rig",
                                 "surefoot doctor --machine rex",
                                 doctor);
    verb.option(
            "--rig", o.rig_file, "calibration file of the rig (default: the built-in rig zed_vga)")
        .value("FILE");
    verb.option("--machine", o.machine, "machine file, or name of a built-in machine (default rex)")
        .value("FILE|NAME");
}

}  // namespace surefoot::app
