// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "service/console/options.hpp"
#include "surefoot/perception/settings.hpp"

namespace surefoot::app {

/// Returns the options of the command line that affect settings.
[[nodiscard]] inline SettingsRequest settings_request(const CommonOptions& options) {
    return {options.preset, options.config_file, options.settings};
}
[[nodiscard]] inline Result<Settings> load_settings(const CommonOptions& options) {
    return surefoot::load_settings(settings_request(options));
}
[[nodiscard]] inline std::unique_ptr<Executor> make_executor(const CommonOptions& options) {
    return surefoot::make_executor(options.threads);
}

}  // namespace surefoot::app
