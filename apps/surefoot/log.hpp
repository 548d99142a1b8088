// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Lines on stderr; results go to stdout or into files.
void log_info(const std::string& message);
void log_warning(const std::string& message);
void log_error(const std::string& message);

/// Logs the error and returns the exit code that belongs to it.
[[nodiscard]] int report(const Error& error);

}  // namespace surefoot::app
