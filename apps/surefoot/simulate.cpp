// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "apps/surefoot/copy_frames.hpp"
#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/scene_gallery.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/source.hpp"
#include "apps/surefoot/verbs.hpp"
#include "apps/surefoot/writes.hpp"
#include "io/dem_file.hpp"
#include "io/file.hpp"
#include "io/pfm.hpp"
#include "io/trajectory_file.hpp"
#include "sim/safety_oracle.hpp"
#include "sim/scenes.hpp"
#include "sim/truth.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::app {
namespace {

/// Names and descriptions; with a folder also a picture of each scene.
int list(const SimOptions& options) {
    const auto scenes = sim::list_scenes();
    if (options.common.json) {
        print_answer(scenes_json(scenes));
    } else {
        for (const auto& scene : scenes) fmt::print("{:<26}{}\n", scene.name, scene.description);
    }
    if (options.out_dir.empty()) return kExitOk;
    const auto executor = make_executor(options.common);
    const auto status = write_scene_gallery(options.out_dir, options.common.seed, *executor);
    return status ? kExitOk : report(status.error());
}

/// Cells that hold the whole path and what can be seen from it.
sim::Lattice lattice_around(const Trajectory& trajectory, double resolution_m) {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector2d high = -low;
    for (const auto& pose : trajectory) {
        low = low.cwiseMin(pose.T_world_body.translation_m.head<2>());
        high = high.cwiseMax(pose.T_world_body.translation_m.head<2>());
    }
    constexpr double kReach_m = 6.0;
    const auto snapped = [&](double value_m) {
        return std::floor(value_m / resolution_m) * resolution_m;
    };
    sim::Lattice lattice;
    lattice.resolution_m = resolution_m;
    lattice.origin_m = {snapped(low.x() - kReach_m), snapped(low.y() - kReach_m)};
    lattice.nx = static_cast<int>((high.x() - low.x() + 2.0 * kReach_m) / resolution_m);
    lattice.ny = static_cast<int>((high.y() - low.y() + 2.0 * kReach_m) / resolution_m);
    return lattice;
}

/// groundtruth.tum, elevation.asc (highest surface), labels.asc; beside RGB-D also groundtruth.txt,
/// where users of that layout look for the poses of the camera.
Status write_truth(const std::string& out,
                   const sim::SceneTruth& truth,
                   std::size_t frames,
                   double resolution_m) {
    Trajectory trajectory;
    for (std::size_t i = 0; i < std::min(frames, truth.trajectory.size()); ++i) {
        trajectory.push_back({truth.trajectory[i].time_ns, truth.trajectory[i].T_world_body});
    }
    const sim::Lattice lattice = lattice_around(trajectory, resolution_m);
    const grid::GridGeometry geometry{
        lattice.resolution_m, lattice.nx, lattice.ny, lattice.origin_m};
    grid::Layer labels(lattice.nx, lattice.ny);
    const auto label_codes = sim::labels(truth.scene, lattice);
    for (std::size_t i = 0; i < labels.size(); ++i)
        labels.data()[i] = static_cast<float>(label_codes.data()[i]);
    if (auto status = io::write_tum_trajectory(out + "/groundtruth.tum", trajectory); !status)
        return status;
    if (!truth.rig.right) {
        for (StampedPose& pose : trajectory)
            pose.T_world_body = pose.T_world_body * truth.rig.body_from_left();
        if (auto status = io::write_tum_trajectory(out + "/groundtruth.txt", trajectory); !status)
            return status;
    }
    if (auto status =
            io::write_esri_grid(out + "/elevation.asc", geometry, sim::dem(truth.scene, lattice));
        !status) {
        return status;
    }
    return io::write_esri_grid(out + "/labels.asc", geometry, labels);
}

/// joystick.csv: what the user asks a walking machine for, and when (no line for other carriers);
/// safety.csv: which of all movements would truly be safe at each of these moments.
Status write_steps(const std::string& out, const sim::SceneTruth& truth, const Machine& machine) {
    std::string joystick = "time_s,end_s,command\n";
    std::vector<sim::SafetyLabel> labels;
    for (const sim::StepEvent& step : truth.steps) {
        const std::int64_t time_ns = truth.start_ns + ns_from_seconds(step.start_s);
        joystick += fmt::format("{:.3f},{:.3f},{}\n",
                                seconds_from_ns(time_ns),
                                seconds_from_ns(truth.start_ns + ns_from_seconds(step.end_s)),
                                step.command);
        for (int command = 1; command < Machine::kMovementCodes; ++command) {
            if (!machine.movements[static_cast<std::size_t>(command)].configured) continue;
            labels.push_back(
                {time_ns, command, sim::judge(truth.scene, machine, step.T_world_before, command)});
        }
    }
    Writes writes;
    writes += io::write_file(out + "/joystick.csv", joystick);
    writes += io::write_file(out + "/safety.csv", sim::safety_csv(labels));
    return writes.first();
}

}  // namespace

int simulate(const SimOptions& options) {
    if (options.list) return list(options);
    if (options.scene.empty() || (options.out_dir.empty() && options.scan_file.empty())) {
        return report(
            usage_error("sim: a scene and --out (or --scan) are needed; 'surefoot sim --list' "
                        "shows the scenes"));
    }
    if (!options.scan_file.empty()) return scan(options);
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto machine = load_machine(options.machine);
    if (!machine) return report(machine.error());
    if (!*machine) return report(usage_error("--machine: a machine file or name is needed"));
    const auto executor = make_executor(options.common);
    auto source = open_simulation({options.scene,
                                   options.rig,
                                   options.rate_hz,
                                   options.frames,
                                   options.common.seed,
                                   settings->sim},
                                  *executor);
    if (!source) return report(source.error());
    auto recorder = start_recording(options.out_dir, **source);
    if (!recorder) return report(recorder.error());
    if (options.depth) {
        if (auto status = io::make_folder(options.out_dir + "/depth"); !status)
            return report(status.error());
    }
    const auto write_depth = [&](const StereoFrame& frame) -> Status {
        if (!options.depth) return {};
        return io::write_pfm(fmt::format("{}/depth/{}.pfm", options.out_dir, frame.time_ns),
                             (*source)->last_depth_m());
    };
    Copied copied = copy_frames("sim", **source, *recorder, write_depth);
    // The truth of the frames that are there, also when the recording ended early.
    if (copied.frames > 0) {
        Writes writes;
        writes += write_truth(options.out_dir,
                              (*source)->truth(),
                              static_cast<std::size_t>(copied.frames),
                              settings->pipeline.elevation.resolution_m);
        writes += write_steps(options.out_dir, (*source)->truth(), machine->value().machine);
        if (!writes.first() && !copied.error) copied.error = writes.first().error();
    }
    if (options.common.json) {
        print_answer(copied_json(copied, options.out_dir));
    } else {
        fmt::print("{} frames of {} with ground truth in {}/\n",
                   copied.frames,
                   options.scene,
                   options.out_dir);
    }
    return copied.error ? report(*copied.error) : kExitOk;
}

}  // namespace surefoot::app
