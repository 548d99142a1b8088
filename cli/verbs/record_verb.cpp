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

struct RecordOptions : SourceOptions {
    CommonOptions common;
    std::string out_dir;
};

/// `surefoot record`: writes the frames of a source to a folder.
int record(const RecordOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto executor = make_executor(options.common);
    auto source = open_source(request_of(options, options.common, *settings), *executor);
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
                                 "record the frames of a source to a folder in EuRoC layout",
                                 "surefoot record sim:floor --max-frames 4 --out out/copy",
                                 record);
    verb.option("source",
                o.source,
                "source to record: a recording, a video, sim:SCENE or v4l2:DEVICE; 'surefoot run "
                "--help' lists all kinds")
        .required()
        .value("SOURCE");
    verb.option("--out", o.out_dir, "folder for the recording").required().value("DIR");
    add_source_options(verb, o);
}

}  // namespace surefoot::app
