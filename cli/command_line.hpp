// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace surefoot::app {

/// Runs the verb that the arguments name and returns the exit code of the program. With --json it
/// prints exactly one JSON object on stdout, after an error too, but not for --help or --version.
[[nodiscard]] int run_command_line(int argc, char** argv);

}  // namespace surefoot::app
