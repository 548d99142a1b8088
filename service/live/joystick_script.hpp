// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// A line of the script: from `time_ns` until the next line the joystick sends `code`.
struct JoystickLine {
    std::int64_t time_ns = 0;  ///< time since the start of the script
    std::uint8_t code = 0;     ///< 0 = at rest
};

/// Parses a joystick script. Errors contain `name` (the file) and the number of the line.
///
/// A line is `time_s code`, separated by white space or a comma. A line of the joystick.csv of
/// `surefoot sim` is `time_s,end_s,command`; the joystick is at rest from end_s on. Times must not
/// decrease. Empty lines, lines that begin with '#' and the header of joystick.csv are skipped.
[[nodiscard]] Result<std::vector<JoystickLine>> parse_joystick_script(std::string_view text,
                                                                      const std::string& name);

/// Returns the code at a time after the start of the script; 0 (at rest) before the first line.
[[nodiscard]] std::uint8_t code_at(const std::vector<JoystickLine>& script, std::int64_t time_ns);

}  // namespace surefoot::app
