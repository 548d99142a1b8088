// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <thread>

#include "apps/surefoot/log.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/source.hpp"
#include "apps/surefoot/verbs.hpp"
#include "io/file.hpp"
#include "io/rig_file.hpp"
#include "sim/rigs.hpp"
#include "surefoot/camera/rectifier.hpp"

namespace surefoot::app {
namespace {

/// Nearest and farthest floor that the middle column of the rectified camera sees, from base_link
/// [m].
struct FloorView {
    double near_m = 0.0;
    double far_m = 0.0;  ///< infinite when the horizon is in view
};

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

void print_sigma(const camera::RectifiedRig& rig) {
    // sigma_z = z^2 sigma_d / (f b); a quarter of a pixel is what semi-global matching reaches.
    constexpr double kDisparitySigma_px = 0.25;
    fmt::print("depth sigma at {:.2f} px:", kDisparitySigma_px);
    for (const double z_m : {0.5, 1.0, 2.0, 3.0}) {
        fmt::print("  {:.1f} mm at {:.1f} m",
                   1e3 * z_m * z_m * kDisparitySigma_px / rig.depth_to_disparity_px_m(),
                   z_m);
    }
    fmt::print("\n");
}

int print_blind_zone(const camera::StereoRig& rig, const io::MachineFile& machine) {
    const auto rectifier = camera::Rectifier::make(mounted_rig(rig, machine));
    if (!rectifier) return report(rectifier.error());
    const camera::RectifiedRig& r = rectifier->rig();
    const double base_height_m = 1e-4 * machine.machine.sole_depth_tenth_mm;
    const FloorView view = floor_view(r, base_height_m);
    fmt::print("rig {}: {}x{}, f {:.1f} px, baseline {:.1f} mm\n",
               rig.name,
               r.width,
               r.height,
               r.fx_px,
               1e3 * r.baseline_m);
    print_sigma(r);
    fmt::print(
        "blind zone: floor nearer than {:.2f} m ahead of base_link is never seen; view ends at "
        "{:.2f} m\n",
        view.near_m,
        view.far_m);
    const GroundBox& foot = machine.machine.left_foot;
    for (int code = 0; code < Machine::kMovementCodes; ++code) {
        const Movement& m = machine.machine.movements[static_cast<std::size_t>(code)];
        if (!m.configured || m.forward_tenth_mm <= 0 || m.left_tenth_mm != 0) continue;
        const double toe_m =
            1e-4 * (m.forward_tenth_mm + foot.center_x_tenth_mm + 0.5 * foot.length_tenth_mm);
        fmt::print(
            "command {} ({}): the foot lands up to {:.2f} m ahead, {}\n",
            code,
            m.name.data(),
            toe_m,
            toe_m <= view.near_m ? "all of it on remembered ground" : "partly on ground seen now");
    }
    return kExitOk;
}

}  // namespace

int doctor(const DoctorOptions& options) {
    fmt::print("surefoot {}: {} threads, no GPU needed\n",
               SUREFOOT_VERSION,
               std::thread::hardware_concurrency());
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    fmt::print("settings: valid\n");
    const auto machine = load_machine(options.machine.empty() ? "rex" : options.machine);
    if (!machine) return report(machine.error());
    fmt::print("machine {}: valid\n", machine->value().name);
    if (!options.rig_file.empty()) {
        const auto rig = io::read_rig(options.rig_file);
        if (!rig) return report(rig.error());
        return print_blind_zone(*rig, machine->value());
    }
    const auto rig = sim::rig_preset("zed_vga");
    if (!rig) return report(rig.error());
    return print_blind_zone(*rig, machine->value());
}

}  // namespace surefoot::app
