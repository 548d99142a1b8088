// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "service/console/option_settings.hpp"
#include "studies/runs/run_options.hpp"
#include "studies/runs/run_session.hpp"
#include "surefoot/io/settings/machine_file.hpp"

namespace surefoot::app {

/// Writes all result files of a run. Continues after a failed file and returns the first failure.
[[nodiscard]] Status write_results(const RunOptions& options,
                                   const Settings& settings,
                                   const std::optional<io::MachineFile>& machine,
                                   const pipeline::Pipeline& pipeline,
                                   const RunRecord& record);

/// Returns a copy of the layer, or a layer of unknown cells if the layer is empty.
[[nodiscard]] grid::Layer or_unknown(const grid::Layer& layer, const grid::GridGeometry& geometry);

/// Returns a summary of a run for the terminal.
[[nodiscard]] std::string run_summary(const RunRecord& record, const pipeline::Pipeline& pipeline);

/// Returns a note about results that the simulator modelled instead of computing them from images.
/// Empty if there are none.
[[nodiscard]] std::string modelled_note(const camera::SourceInfo& source);

/// Returns one line about skipped broken frames; empty if there are none.
[[nodiscard]] std::string broken_text(const camera::BrokenFrames& broken);

/// Returns one sentence with the reason for an empty map; empty if the map has known cells.
[[nodiscard]] std::string empty_map_reason(const RunRecord& record,
                                           const pipeline::Pipeline& pipeline);

/// Mean, median and 99th percentile of a list of values.
struct Percentiles {
    double mean = 0.0;
    double median = 0.0;
    double p99 = 0.0;
    std::size_t samples = 0;
};
[[nodiscard]] Percentiles percentiles(std::vector<double> values);
/// Returns the time of one stage [ms] over the full frames; for odometry, over all frames.
[[nodiscard]] Percentiles stage_percentiles(const RunRecord& record, Stage stage);
/// Returns the time of all stages together [ms], over the frames with full processing.
[[nodiscard]] Percentiles frame_percentiles(const RunRecord& record);

/// Returns the peak resident memory of this process [MB].
[[nodiscard]] double peak_memory_mb();

}  // namespace surefoot::app
