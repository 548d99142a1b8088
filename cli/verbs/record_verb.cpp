// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/json/recording_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "service/console/source.hpp"
#include "studies/runs/run_output.hpp"
#include "studies/simulation/copy_frames.hpp"

namespace surefoot::app {
namespace {

struct RecordOptions {
    CommonOptions common;
    ReadingOptions reading;
    std::string source;
    std::string out_dir;
    std::string rig_file;
    std::string imu_file;
    double rate_hz = 0.0;
    int max_frames = 0;
};

/// `surefoot record`: writes the frames of a source to a folder.
int record(const RecordOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
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
    auto recorder = start_recording(options.out_dir, **source);
    if (!recorder) return report(recorder.error());
    const Copied copied = copy_frames("record", **source, *recorder);
    if (options.common.json) {
        print_answer(copied_json(copied, options.out_dir));
    } else {
        fmt::print("{} frames recorded in {}/{}\n{}",
                   copied.frames,
                   options.out_dir,
                   copied.error ? " before the error" : "",
                   broken_text(copied.broken));
    }
    return copied.error ? report(*copied.error) : kExitOk;
}

}  // namespace

void add_record(VerbGroup verbs) {
    auto [verb, o] =
        verbs.add<RecordOptions>("record",
                                 "record any source to a folder in EuRoC layout",
                                 "surefoot record sim:floor --max-frames 4 --out out/copy",
                                 record);
    verb.option("source", o.source, "see 'surefoot run --help'").required().value("SOURCE");
    verb.option("--out", o.out_dir, "folder for the recording").required().value("DIR");
    add_reading(verb, o.reading);
    add_skip_broken(verb, o.reading);
    verb.option("--rig",
                o.rig_file,
                "calibration file, or name of a built-in rig; replaces that of the source")
        .value("FILE");
    verb.option("--imu", o.imu_file, "see 'surefoot run --help'").value("FILE");
    verb.option("--rate", o.rate_hz, "frame rate of a source without time stamps, in Hz")
        .in(0.01, 1000.0);
    verb.option("--max-frames", o.max_frames, "stop after this number of frames").positive();
}

}  // namespace surefoot::app
