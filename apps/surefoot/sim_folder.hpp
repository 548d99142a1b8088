// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/verbs.hpp"
#include "surefoot/io/recordings/recorder.hpp"

namespace surefoot::app {

/// What decides every byte of a simulated recording, as `config.yaml` beside it says: the call,
/// what the files that it names hold, all settings. Another version of the program is another line.
[[nodiscard]] Result<std::string> sim_config(const SimOptions& options, const Settings& settings);

/// May a folder's recording be gone on with?
struct SimFolder {
    io::Recorder::Existing existing = io::Recorder::Existing::refuse;
    std::string difference;  ///< of the folder's `config.yaml` from ours, a sentence; empty if none
};
[[nodiscard]] SimFolder compare_folder(const std::string& folder, const std::string& config);

}  // namespace surefoot::app
