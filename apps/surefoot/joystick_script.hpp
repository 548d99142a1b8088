// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// From `time_ns` on the joystick sends `code`, until the next line.
struct JoystickLine {
    std::int64_t time_ns = 0;  ///< since the beginning of the script
    std::uint8_t code = 0;     ///< 0 = at rest
};

/// Lines `time_s code`, in order of time, parted by white space or a comma, or
/// `time_s,end_s,command` as `surefoot sim` writes joystick.csv (at rest from end_s on). Empty
/// lines and those that begin with '#' or are that file's header are left out. `name` is the
/// file's, for errors.
[[nodiscard]] Result<std::vector<JoystickLine>> parse_joystick_script(std::string_view text,
                                                                      const std::string& name);

/// What the joystick sends at a time; at rest before the first line.
[[nodiscard]] std::uint8_t code_at(const std::vector<JoystickLine>& script, std::int64_t time_ns);

}  // namespace surefoot::app
