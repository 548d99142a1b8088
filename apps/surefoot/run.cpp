// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <string>
#include <vector>

#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/map_layers.hpp"
#include "apps/surefoot/place_session.hpp"
#include "apps/surefoot/run_output.hpp"
#include "apps/surefoot/run_session.hpp"
#include "apps/surefoot/source.hpp"
#include "apps/surefoot/verbs.hpp"
#include "apps/surefoot/writes.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/perception/fit_settings.hpp"

namespace surefoot::app {
int run(const RunOptions& options) {
    auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto machine = load_machine(options.machine);
    if (!machine) return report(machine.error());
    const auto executor = make_executor(options.common);
    auto source = open_source({options.source,
                               options.rig_file,
                               options.rate_hz,
                               options.max_frames,
                               options.common.seed,
                               settings->sim,
                               settings->live,
                               options.imu_file,
                               0,
                               options.reading},
                              *executor);
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

    // Remove results of an earlier run, so that nobody, above all the gate, takes them for results
    // of this run.
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
        if (written) fmt::print("results in {0}/, start with {0}/report.html\n", options.out_dir);
    }
    // The run and the writing may both have failed. Each error is reported once; the error of the
    // run decides the exit code.
    if (!written) {
        log_error(fmt::format("{}; {} holds only a part of the results: make room and run again",
                              written.error().message,
                              options.out_dir));
    }
    if (!record.complete()) return report(*record.error);
    return written ? kExitOk : kExitFailed;
}

}  // namespace surefoot::app
