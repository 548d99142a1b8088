// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/surefoot/copy_frames.hpp"
#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/run_output.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/source.hpp"
#include "apps/surefoot/verbs.hpp"

namespace surefoot::app {

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

}  // namespace surefoot::app
