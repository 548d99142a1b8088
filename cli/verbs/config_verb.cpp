// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdio>

#include "cli/json/program_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "surefoot/io/settings/config_yaml.hpp"

namespace surefoot::app {
namespace {

struct ConfigOptions {
    CommonOptions common;
    bool check_only = false;
};

/// `surefoot config`: prints or checks the settings.
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

}  // namespace

void add_config(VerbGroup verbs) {
    auto [verb, o] =
        verbs.add<ConfigOptions>("config",
                                 "print every setting with its value, its range and its "
                                 "description; with --check, only check the settings",
                                 "surefoot config --set elevation.length_m=8",
                                 config,
                                 Reads::own_settings);
    verb.flag(
        "--check",
        o.check_only,
        "check the settings and print whether they are valid, without the list of all settings");
}

}  // namespace surefoot::app
