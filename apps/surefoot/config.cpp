// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdio>

#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/verbs.hpp"
#include "surefoot/io/settings/config_yaml.hpp"

namespace surefoot::app {

int config(const ConfigOptions& options) {
    const auto settings = load_settings(options.common);
    if (options.check_only && options.common.json) {
        print_answer(check_json(settings ? "" : settings.error().message));
    }
    if (!settings) return report(settings.error());
    if (options.check_only) {
        if (!options.common.json) fmt::print("the settings are valid\n");
    } else if (options.common.json) {
        print_answer(settings_json(io::list_config_of(*settings)));
    } else {
        fmt::print("{}", io::format_config_of(*settings));
    }
    return kExitOk;
}

}  // namespace surefoot::app
