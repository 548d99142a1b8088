// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// The one JSON object of a call with --json, on stdout.
void print_answer(const std::string& json_object);
/// Whether the call has answered already.
[[nodiscard]] bool answered() noexcept;

/// Lines on stderr; results go to stdout or into files.
void log_info(const std::string& message);
void log_warning(const std::string& message);
void log_error(const std::string& message);

/// The first sentence that log_error was given; empty when nothing failed.
[[nodiscard]] const std::string& first_error() noexcept;

/// Writes what stdout still holds. A failure of any earlier print counts: the answer is not whole.
[[nodiscard]] Status close_stdout();

/// Logs the error and returns the exit code that belongs to it.
[[nodiscard]] int report(const Error& error);

}  // namespace surefoot::app
