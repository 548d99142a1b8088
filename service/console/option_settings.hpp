// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "service/console/options.hpp"
#include "surefoot/perception/settings.hpp"

namespace surefoot::app {

/// Loads the settings of the command line. Warns about each setting that is given by its former
/// name, only once in a run of the program. Not thread-safe.
[[nodiscard]] Result<Settings> load_settings(const CommonOptions& options);

/// Applies --config and --set to a program's own settings. Warns like load_settings.
[[nodiscard]] Status apply_overrides(const CommonOptions& options,
                                     const io::DescribeConfig& describe);

[[nodiscard]] inline std::unique_ptr<Executor> make_executor(const CommonOptions& options) {
    return surefoot::make_executor(options.threads);
}

}  // namespace surefoot::app
