// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "apps/surefoot/run_session.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/verbs.hpp"
#include "surefoot/io/settings/machine_file.hpp"

namespace surefoot::app {

/// Writes everything that a run produced. Goes on after a failed file and returns the first
/// failure, so that as much as possible is kept.
[[nodiscard]] Status write_results(const RunOptions& options,
                                   const Settings& settings,
                                   const std::optional<io::MachineFile>& machine,
                                   const pipeline::Pipeline& pipeline,
                                   const RunRecord& record);

/// The layer, or one of unknown cells where nothing has filled it yet.
[[nodiscard]] grid::Layer or_unknown(const grid::Layer& layer, const grid::GridGeometry& geometry);

/// A few lines for the terminal.
[[nodiscard]] std::string run_summary(const RunRecord& record, const pipeline::Pipeline& pipeline);

/// What must be said of results that were not all measured; empty when they were.
[[nodiscard]] std::string modelled_note(const camera::SourceInfo& source);

/// A line about frames that the source passed over; empty when there are none.
[[nodiscard]] std::string broken_text(const camera::BrokenFrames& broken);

/// Why the map holds no cell, in one sentence; empty when it holds some.
[[nodiscard]] std::string empty_map_reason(const RunRecord& record,
                                           const pipeline::Pipeline& pipeline);

/// Median and 99th percentile of what the frames report.
struct Percentiles {
    double median = 0.0;
    double p99 = 0.0;
    std::size_t samples = 0;
};
[[nodiscard]] Percentiles percentiles(std::vector<double> values);
[[nodiscard]] Percentiles stage_percentiles(const RunRecord& record, Stage stage);
/// Sum of all stages of the frames that ran in full.
[[nodiscard]] Percentiles frame_percentiles(const RunRecord& record);

/// Largest resident memory of this process [MB].
[[nodiscard]] double peak_memory_mb();

}  // namespace surefoot::app
