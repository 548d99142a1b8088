// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"

namespace surefoot::sim {

/// Values of the names that an expression may use.
using NamedNumbers = std::map<std::string, double, std::less<>>;

/// Evaluates an arithmetic expression: numbers, names, + - * / and parentheses with the usual
/// precedence; operators of equal rank go from left to right. Errors, with their position in the
/// text: a syntax error, an unknown name, a value that is not finite (division by zero).
[[nodiscard]] Result<double> evaluate(std::string_view text, const NamedNumbers& names);

/// Returns true for a text of letters, digits and '_' that does not begin with a digit.
[[nodiscard]] bool is_name(std::string_view text) noexcept;

}  // namespace surefoot::sim
