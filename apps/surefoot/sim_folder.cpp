// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/sim_folder.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <string_view>

#include "io/config_yaml.hpp"
#include "io/file.hpp"

namespace surefoot::app {
namespace {

/// A comment line for a file that the call names; nothing for a built-in name.
Result<std::string> file_line(const std::string& path) {
    if (!io::is_file(path)) return std::string();
    const auto bytes = io::read_file(path);
    if (!bytes) return bytes.error();
    std::uint64_t hash = 0xcbf29ce484222325U;  // FNV-1a, 64 bit
    for (const char c : *bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
    return fmt::format("# {}: {:016x}\n", path, hash);
}

/// The first line of `text`, which becomes the rest.
std::string_view next_line(std::string_view& text) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    return line;
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
    const auto there = io::read_file(io::join_path(folder, "config.yaml"));
    if (!there) return {};
    if (*there == config) return {io::Recorder::Existing::renew, ""};
    std::string_view theirs = *there;
    std::string_view ours = config;
    std::string_view their_line;
    std::string_view our_line;
    while (their_line == our_line && !(theirs.empty() && ours.empty())) {
        their_line = next_line(theirs);
        our_line = next_line(ours);
    }
    return {io::Recorder::Existing::refuse,
            fmt::format("it was made otherwise: its config.yaml says '{}', this call '{}'",
                        their_line,
                        our_line)};
}

}  // namespace surefoot::app
