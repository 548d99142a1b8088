// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cli/json/recording_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "service/console/source.hpp"
#include "service/console/writes.hpp"
#include "studies/simulation/copy_frames.hpp"
#include "studies/simulation/scan.hpp"
#include "studies/simulation/scene_gallery.hpp"
#include "studies/simulation/sim_folder.hpp"
#include "studies/simulation/sim_options.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/grid/whole_cells.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/pfm.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/recordings/trajectory_file.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/scenes/truth.hpp"

namespace surefoot::app {
namespace {

/// Prints the names and descriptions of the scenes. If options.out_dir is set, also writes a
/// picture of each scene.
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

/// Returns a grid that covers the whole path and 6 m around it.
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
    lattice.nx = grid::whole_cells((high.x() - low.x() + 2.0 * kReach_m) / resolution_m);
    lattice.ny = grid::whole_cells((high.y() - low.y() + 2.0 * kReach_m) / resolution_m);
    return lattice;
}

/// Writes groundtruth.tum, elevation.asc (highest surface) and labels.asc. For an RGB-D recording
/// also writes groundtruth.txt: in the TUM layout this file contains the poses of the camera.
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

/// Writes joystick.csv: the movements that the user of a walking machine requests, with their
/// times. The file has only a header for other motion models.
Status write_joystick(const std::string& out,
                      const sim::SceneTruth& truth,
                      std::int64_t last_frame_ns) {
    std::string joystick = "time_s,end_s,command\n";
    for (const sim::StepEvent& step : truth.steps) {
        const std::int64_t time_ns = truth.start_ns + ns_from_seconds(step.start_s);
        if (time_ns > last_frame_ns) break;
        joystick += fmt::format("{:.3f},{:.3f},{}\n",
                                seconds_from_ns(time_ns),
                                seconds_from_ns(truth.start_ns + ns_from_seconds(step.end_s)),
                                step.command);
    }
    return io::write_file(out + "/joystick.csv", joystick);
}

/// Writes safety.csv: which movements are truly safe at each stance before a step. A trolley has
/// stops instead of stances. The file has no lines for a hand-held camera, which has no stance.
Status write_safety(const std::string& out,
                    const sim::SceneTruth& truth,
                    std::int64_t last_frame_ns,
                    const Machine& machine) {
    std::vector<sim::Stop> stances = truth.stops;
    for (const sim::StepEvent& step : truth.steps)
        stances.push_back({step.start_s, step.T_world_before});
    std::vector<sim::SafetyLabel> labels;
    for (const sim::Stop& stance : stances) {
        const std::int64_t time_ns = truth.start_ns + ns_from_seconds(stance.start_s);
        if (time_ns > last_frame_ns) break;
        for (int command = 1; command < Machine::kMovementCodes; ++command) {
            if (!machine.movements[static_cast<std::size_t>(command)].configured) continue;
            labels.push_back(
                {time_ns, command, sim::judge(truth.scene, machine, stance.T_world_body, command)});
        }
    }
    return io::write_file(out + "/safety.csv", sim::safety_csv(labels));
}

/// Writes the ground truth of the recorded frames, even if the recording ended early.
Status write_all_truth(const std::string& out,
                       const sim::SceneTruth& truth,
                       int frames,
                       double resolution_m,
                       const Machine& machine) {
    const auto count = std::min(static_cast<std::size_t>(frames), truth.trajectory.size());
    const std::int64_t last_frame_ns = truth.trajectory[count - 1].time_ns;
    Writes writes;
    writes += write_truth(out, truth, count, resolution_m);
    writes += write_joystick(out, truth, last_frame_ns);
    writes += write_safety(out, truth, last_frame_ns, machine);
    return writes.first();
}

/// Starts a recording, or continues a recording of the same call. Also writes config.yaml to the
/// folder.
Result<io::Recorder> start_simulated(const SimOptions& options,
                                     const Settings& settings,
                                     const sim::SceneSource& source) {
    const auto config = sim_config(options, settings);
    if (!config) return config.error();
    const SimFolder there = compare_folder(options.out_dir, *config);
    auto recorder = start_recording(options.out_dir, source, there.existing);
    if (!recorder && !there.difference.empty())
        return Error{recorder.error().code, recorder.error().message + "; " + there.difference};
    if (!recorder) return recorder;
    if (options.depth) {
        if (auto status = io::make_folder(options.out_dir + "/depth"); !status)
            return status.error();
    }
    if (there.existing == io::Recorder::Existing::renew) return recorder;
    if (auto status = io::write_file(options.out_dir + "/config.yaml", *config); !status)
        return status.error();
    return recorder;
}

/// Renders and records the frames that the folder lacks.
Copied record_frames(const SimOptions& options, sim::SceneSource& source, io::Recorder& recorder) {
    const auto depth_file = [&](std::int64_t time_ns) {
        return fmt::format("{}/depth/{}.pfm", options.out_dir, time_ns);
    };
    bool known = false;
    source.use_known_images([&](StereoFrame& frame) {
        known = (!options.depth || io::read_pfm(depth_file(frame.time_ns)).ok()) &&
                recorder.read_back(frame);
        return known;
    });
    const auto write_depth = [&](const StereoFrame& frame) -> Status {
        if (!options.depth || known) return {};
        return io::write_pfm(depth_file(frame.time_ns), source.last_depth_m());
    };
    return copy_frames("sim", source, recorder, write_depth);
}

/// `surefoot sim`: writes a simulated recording with its ground truth.
int simulate(const SimOptions& options) {
    if (options.list) return list(options);
    if (options.scene.empty() || (options.out_dir.empty() && options.scan_file.empty())) {
        return report(
            usage_error("sim: the scene or the output is missing; give a scene and --out or "
                        "--scan. 'surefoot sim --list' shows the scenes"));
    }
    if (!options.scan_file.empty()) return scan(options);
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto machine = load_machine(options.machine);
    if (!machine) return report(machine.error());
    if (!*machine)
        return report(
            usage_error("--machine is empty: give a machine file, or the name of a built-in "
                        "machine, for example rex"));
    const auto executor = make_executor(options.common);
    auto source = open_simulation({options.scene,
                                   options.rig,
                                   options.rate_hz,
                                   options.frames,
                                   options.common.seed,
                                   settings->sim},
                                  *executor);
    if (!source) return report(source.error());
    auto recorder = start_simulated(options, *settings, **source);
    if (!recorder) return report(recorder.error());
    Copied copied = record_frames(options, **source, *recorder);
    if (copied.frames > 0) {
        const auto truth = write_all_truth(options.out_dir,
                                           (*source)->truth(),
                                           copied.frames,
                                           settings->pipeline.elevation.resolution_m,
                                           machine->value().machine);
        if (!truth && !copied.error) copied.error = truth.error();
    }
    if (const int known = (*source)->known_frames(); known > 0)
        log_info(fmt::format("{} of {} frames already existed in the folder; the verb kept them",
                             known,
                             copied.frames));
    if (options.common.json) {
        print_answer(copied_json(copied, options.out_dir));
    } else {
        fmt::print("{} frames of {} {} in {}/\n",
                   copied.frames,
                   options.scene,
                   copied.error ? "before the error" : "with ground truth",
                   options.out_dir);
    }
    return copied.error ? report(*copied.error) : kExitOk;
}

}  // namespace

void add_sim(VerbGroup verbs) {
    auto [verb, o] = verbs.add<SimOptions>(
        "sim",
        "write a simulated recording with its ground truth, or laser scans of a scene",
        "surefoot sim floor --frames 4 --out out/floor_recording\n"
        "  surefoot sim floor --frames 2 --set "
        "sim.sensor=depth_camera --out out/floor_rgbd\n"
        "  surefoot sim demo_stairs --scan out/stairs.ply --set "
        "sim.laser.step_deg=1",
        simulate);
    verb.option(
            "scene", o.scene, "name of a scene (see --list), or a scene file: my/scene.yaml[#NAME]")
        .value("SCENE");
    const Option out =
        verb.option(
                "--out",
                o.out_dir,
                "folder for the recording; to continue an interrupted recording, repeat the call")
            .value("DIR");
    verb.option("--frames", o.frames, "stop after this number of frames").positive();
    verb.option("--rate", o.rate_hz, "frame rate of the simulated cameras, in Hz")
        .value("HZ")
        .in(0.1, 1000.0);
    verb.option("--rig",
                o.rig,
                "rig of the simulated cameras: a calibration file, or the name of a built-in rig, "
                "for example zed_vga")
        .value("FILE|NAME");
    verb.option("--machine",
                o.machine,
                "machine for which safety.csv says which movements are truly safe: a machine file, "
                "or the name of a built-in machine (default rex)")
        .value("FILE|NAME");
    verb.flag("--depth",
              o.depth,
              "also write the true depth of every frame (a PFM file of about 1 MB for each frame)");
    verb.flag("--list",
              o.list,
              "print the names and descriptions of the scenes; with --out also write a picture of "
              "each scene and index.html");
    const Option scan =
        verb.option("--scan",
                    o.scan_file,
                    "write terrestrial laser scans of the scene instead of a recording, with all "
                    "points in the world frame. A station needs up to 850 MB; a larger "
                    "sim.laser.step_deg gives smaller files")
            .value("F.ply|DIR")
            .excludes(out);
    verb.option(
            "--station",
            o.stations,
            "position of the laser scanner, in m; repeat the option for more stations "
            "(default: the stations of the scene, or 1.6 m above the ground at the start of the "
            "path)")
        .value("X,Y,Z")
        .one_value_each()
        .needs(scan);
    const Option tile =
        verb.option(
                "--tile",
                o.tile_m,
                "write the scan to a folder, as square tiles with this side, in m, and index.json")
            .value("M")
            .in(0.5, 1000.0)
            .needs(scan);
    verb.option("--tile-format", o.tile_format, "file format of the tiles of --tile (default ply)")
        .one_of({"ply", "pcd"})
        .needs(tile);
}

}  // namespace surefoot::app
