// SPDX-License-Identifier: Apache-2.0
#include "service/live/joystick_script.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "surefoot/io/text.hpp"

namespace surefoot::app {
namespace {

constexpr std::string_view kHeader = "time_s,end_s,command";

/// Adds a line. Returns false if its time or code is invalid, or if its time is before the time of
/// the previous line.
bool add(std::vector<JoystickLine>& script, std::string_view time_s, std::string_view command) {
    const auto time_ns = io::parse_seconds_as_ns(time_s);
    const auto code = io::parse_int64(command);
    if (!time_ns || *time_ns < 0 || !code || *code < 0 || *code > 255) return false;
    if (!script.empty() && *time_ns < script.back().time_ns) return false;
    script.push_back({*time_ns, static_cast<std::uint8_t>(*code)});
    return true;
}

}  // namespace

Result<std::vector<JoystickLine>> parse_joystick_script(std::string_view text,
                                                        const std::string& name) {
    std::vector<JoystickLine> script;
    io::LineReader lines(text);
    while (const auto next = lines.next()) {
        const std::string_view line = io::trimmed(*next);
        if (line.empty() || line.front() == '#' || line == kHeader) continue;
        const auto words = io::split(line, " \t,");
        const bool understood = words.size() == 2
                                    ? add(script, words[0], words[1])
                                    : words.size() == 3 && add(script, words[0], words[2]) &&
                                          add(script, words[1], "0");
        if (!understood) {
            return input_error(fmt::format(
                "{}:{}: {} is not a valid line; give a time in s and a code from 0 to 255, or "
                "time_s,end_s,command. Times must not decrease from line to line",
                name,
                lines.number(),
                io::quoted(line)));
        }
    }
    return script;
}

std::uint8_t code_at(const std::vector<JoystickLine>& script, std::int64_t time_ns) {
    const auto later = std::upper_bound(
        script.begin(), script.end(), time_ns, [](std::int64_t time, const JoystickLine& line) {
            return time < line.time_ns;
        });
    return later == script.begin() ? std::uint8_t{0} : std::prev(later)->code;
}

}  // namespace surefoot::app
