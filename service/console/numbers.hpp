// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Reads three finite numbers "a,b,c" from the text of an option. The usage error names the option
/// and the meaning of the numbers.
[[nodiscard]] Result<std::array<double, 3>> parse_three_numbers(const std::string& option,
                                                                const std::string& text,
                                                                const std::string& meaning);

/// Reads four numbers "a,b,c,d", like parse_three_numbers().
[[nodiscard]] Result<std::array<double, 4>> parse_four_numbers(const std::string& option,
                                                               const std::string& text,
                                                               const std::string& meaning);

/// Reads two numbers "a,b", like parse_three_numbers().
[[nodiscard]] Result<std::array<double, 2>> parse_two_numbers(const std::string& option,
                                                              const std::string& text,
                                                              const std::string& meaning);

}  // namespace surefoot::app
