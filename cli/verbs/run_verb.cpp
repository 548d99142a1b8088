// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <string>
#include <vector>

#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "service/console/writes.hpp"
#include "studies/runs/map_layers.hpp"
#include "studies/runs/place_session.hpp"
#include "studies/runs/run_json.hpp"
#include "studies/runs/run_options.hpp"
#include "studies/runs/run_output.hpp"
#include "studies/runs/run_session.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/perception/fit_settings.hpp"

namespace surefoot::app {
namespace {

/// `surefoot run`: processes a recording, video, live camera or simulated scene with the whole
/// pipeline and writes the results.
int run(const RunOptions& options) {
    auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto machine = load_machine(options.machine);
    if (!machine) return report(machine.error());
    const auto executor = make_executor(options.common);
    auto source = open_source(request_of(options, options.common, *settings), *executor);
    if (!source) return report(source.error());
    const camera::StereoRig rig = mounted_rig((*source)->rig(), *machine);
    fit_settings(rig, *machine, *settings);
    auto pipeline = pipeline::Pipeline::make(settings->pipeline, rig, *executor, steady_now_ns);
    if (!pipeline) return report(pipeline.error());
    std::optional<PlaceSession> place;
    if (!options.place.empty()) {
        auto opened = PlaceSession::open(options.place);
        if (!opened) return report(opened.error());
        place.emplace(std::move(opened).value());
    }
    if (const auto status = io::make_folder(options.out_dir); !status)
        return report(status.error());

    // Remove results of an earlier run that other programs read. Otherwise the gate or a user could
    // take the old results for results of this run.
    std::vector<std::string> names{
        "map.snapshot", "ground.asc", "stairs.json", "treads.asc", "report.json", "layers.png"};
    for (const char* layer : kLayerNames) names.push_back(fmt::format("{}.asc", layer));
    for (const std::string& name : names) {
        if (auto status = io::remove_file(io::join_path(options.out_dir, name)); !status) {
            return report(status.error());
        }
    }
    if (io::is_file(options.save_map)) {
        if (auto status = io::remove_file(options.save_map); !status) return report(status.error());
    }
    RunSession session(*pipeline, **source, rig, options.depth_every, settings->maps);
    session.drive("run", [&](const FrameReport& frame) {
        if (place) place->after_frame(frame, *pipeline);
    });
    Writes writes;
    if (place) {
        writes += place->save();
        session.record().place = place->record();
    }
    const RunRecord& record = session.record();

    writes += write_results(options, *settings, *machine, *pipeline, record);
    const Status written = writes.first();
    if (options.common.json) {
        print_answer(run_json(record, *pipeline, written));
    } else {
        fmt::print("{}", run_summary(record, *pipeline));
        if (written)
            fmt::print("the results are in {0}/; open {0}/report.html first\n", options.out_dir);
    }
    // The run and the writing may both have failed. Each error is reported once, and the error of
    // the run determines the exit code.
    if (!written) {
        log_error(fmt::format(
            "{}; {} contains only a part of the results: correct this error and run again",
            written.error().message,
            options.out_dir));
    }
    if (!record.complete()) return report(*record.error);
    return written ? kExitOk : kExitFailed;
}

}  // namespace

void add_run(VerbGroup verbs) {
    auto [verb, o] = verbs.add<RunOptions>(
        "run",
        "run the whole chain (depth, odometry, elevation map, traversability, stairs) on a "
        "recording, a video, a live camera or a simulated scene",
        "surefoot run sim:floor --max-frames 8 --out out/floor\n"
        "  surefoot run sim:floor --max-frames 8 --set "
        "sim.sensor=analytic --out out/modelled --save-map "
        "out/modelled/floor.region",
        run);
    verb.option("source",
                o.source,
                "source of the frames: a folder in EuRoC, KITTI or TUM RGB-D layout, a folder or "
                "video of side-by-side images, a simulated scene sim:SCENE, or a live camera "
                "v4l2:DEVICE[@WIDTHxHEIGHT[@RATE]]")
        .required()
        .value("SOURCE");
    verb.option("--out", o.out_dir, "folder for the results").required().value("DIR");
    verb.option("--machine",
                o.machine,
                "machine that carries the camera: a machine file, or the name of a built-in "
                "machine. It sets the position of the camera on the machine")
        .value("FILE|NAME");
    add_source_options(verb, o);
    verb.option(
            "--depth-every",
            o.depth_every,
            "compute depth and map for every n-th frame only (default 1); odometry uses all frames")
        .in(1, 1000);
    verb.flag("--layers",
              o.all_layers,
              "write every layer of the map, not only elevation, variance and traversability");
    verb.option("--save-map",
                o.save_map,
                "file in which the run saves its map at the end; 'surefoot map' reads this file")
        .value("F.region");
    verb.option("--place",
                o.place,
                "file of a place database. The run recognises places of the database, adds new "
                "places and writes the file again; a missing file is created")
        .value("F.place");
}

}  // namespace surefoot::app
