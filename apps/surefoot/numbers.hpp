// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Three finite numbers "a,b,c" of an option; the usage error names the option and what it means.
[[nodiscard]] Result<std::array<double, 3>> parse_three_numbers(const std::string& option,
                                                                const std::string& text,
                                                                const std::string& meaning);

/// Four of them, "a,b,c,d".
[[nodiscard]] Result<std::array<double, 4>> parse_four_numbers(const std::string& option,
                                                               const std::string& text,
                                                               const std::string& meaning);

/// Two of them, "a,b".
[[nodiscard]] Result<std::array<double, 2>> parse_two_numbers(const std::string& option,
                                                              const std::string& text,
                                                              const std::string& meaning);

}  // namespace surefoot::app
