// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Prints the JSON object of a program run with --json on stdout. Each run prints one object.
void print_answer(const std::string& json_object);
/// Returns true after print_answer was called.
[[nodiscard]] bool answered() noexcept;

// Each function prints a line on stderr. Results go to stdout or to files.
void log_info(const std::string& message);
void log_warning(const std::string& message);
void log_error(const std::string& message);

/// Returns the first message that log_error printed; empty if no error was logged.
[[nodiscard]] const std::string& first_error() noexcept;

/// Flushes stdout. Returns an error if this or any earlier write to stdout failed, because the
/// answer is then incomplete.
[[nodiscard]] Status close_stdout();

/// Logs the error and returns the exit code for its kind.
[[nodiscard]] int report(const Error& error);

}  // namespace surefoot::app
