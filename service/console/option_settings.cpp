// SPDX-License-Identifier: Apache-2.0
#include "service/console/option_settings.hpp"

#include <set>

#include "service/console/log.hpp"

namespace surefoot::app {
namespace {

SettingsRequest settings_request(const CommonOptions& options) {
    return {options.preset, options.config_file, options.settings};
}

void warn_once(const io::Notes& notes) {
    static std::set<std::string> given;
    for (const std::string& note : notes) {
        if (given.insert(note).second) log_warning(note);
    }
}

}  // namespace

Result<Settings> load_settings(const CommonOptions& options) {
    io::Notes notes;
    auto settings = surefoot::load_settings(settings_request(options), &notes);
    warn_once(notes);
    return settings;
}

Status apply_overrides(const CommonOptions& options, const io::DescribeConfig& describe) {
    io::Notes notes;
    auto status = surefoot::apply_overrides(settings_request(options), describe, &notes);
    warn_once(notes);
    return status;
}

}  // namespace surefoot::app
