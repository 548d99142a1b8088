// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Prints the JSON object of a call with --json on stdout. A call prints exactly one.
void print_answer(const std::string& json_object);
/// True after print_answer was called.
[[nodiscard]] bool answered() noexcept;

// These functions print a line on stderr. Results go to stdout or into files.
void log_info(const std::string& message);
void log_warning(const std::string& message);
void log_error(const std::string& message);

/// The first message that log_error printed; empty if there was none.
[[nodiscard]] const std::string& first_error() noexcept;

/// Flushes stdout. Returns an error if this or any earlier write to stdout failed, because the
/// answer is then incomplete.
[[nodiscard]] Status close_stdout();

/// Logs the error and returns the exit code for its kind.
[[nodiscard]] int report(const Error& error);

}  // namespace surefoot::app
