// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/console/option_settings.hpp"
#include "studies/simulation/sim_options.hpp"
#include "surefoot/io/recordings/recorder.hpp"

namespace surefoot::app {

/// Returns the content of the `config.yaml` beside a simulated recording. The file holds every
/// input that affects the recording: program version, call, hashes of the files that the call
/// names, all settings.
[[nodiscard]] Result<std::string> sim_config(const SimOptions& options, const Settings& settings);

/// Result of comparing the configuration of a folder with that of this call.
struct SimFolder {
    io::Recorder::Existing existing = io::Recorder::Existing::refuse;
    /// Sentence with the first difference between the two configurations; empty = no difference.
    std::string difference;
};
[[nodiscard]] SimFolder compare_folder(const std::string& folder, const std::string& config);

}  // namespace surefoot::app
