// SPDX-License-Identifier: Apache-2.0
#include "studies/simulation/sim_folder.hpp"

#include <fmt/format.h>

#include <string_view>

#include "surefoot/core/fnv1a.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/settings/config_yaml.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::app {
namespace {

/// Returns a comment line with the hash of a file that the call names. Empty for a built-in name.
Result<std::string> file_line(const std::string& path) {
    if (!io::is_file(path)) return std::string();
    const auto bytes = io::read_file(path, io::limits::kSettingsBytes);
    if (!bytes) return bytes.error();
    return fmt::format("# {}: {:016x}\n", path, fnv1a(*bytes));
}

}  // namespace

Result<std::string> sim_config(const SimOptions& options, const Settings& settings) {
    std::string text = fmt::format("# surefoot {}: sim {}", SUREFOOT_VERSION, options.scene);
    if (!options.rig.empty()) text += " --rig " + options.rig;
    if (options.rate_hz > 0.0) text += fmt::format(" --rate {}", options.rate_hz);
    if (options.frames > 0) text += fmt::format(" --frames {}", options.frames);
    if (options.depth) text += " --depth";
    text += fmt::format(" --machine {} --seed {}\n", options.machine, options.common.seed);
    for (const std::string& path :
         {options.scene.substr(0, options.scene.find('#')), options.rig, options.machine}) {
        const auto line = file_line(path);
        if (!line) return line.error();
        text += *line;
    }
    return text + io::format_config_of(settings);
}

SimFolder compare_folder(const std::string& folder, const std::string& config) {
    const auto there =
        io::read_file(io::join_path(folder, "config.yaml"), io::limits::kSettingsBytes);
    if (!there) return {};
    if (*there == config) return {io::Recorder::Existing::renew, ""};
    io::LineReader theirs(*there);
    io::LineReader ours(config);
    auto their_line = theirs.next();
    auto our_line = ours.next();
    while (their_line && their_line == our_line) {
        their_line = theirs.next();
        our_line = ours.next();
    }
    return {
        io::Recorder::Existing::refuse,
        fmt::format(
            "the folder was made by another call: its config.yaml says '{}', this call says '{}'",
            their_line.value_or(""),
            our_line.value_or(""))};
}

}  // namespace surefoot::app
