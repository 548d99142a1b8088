// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"

namespace surefoot::sim {

/// Values that an expression may name.
using NamedNumbers = std::map<std::string, double, std::less<>>;

/// Value of an arithmetic expression: numbers, names, + - * / and parentheses, the usual
/// precedence, operators of equal rank from left to right. An error says what is wrong and where in
/// the text; so does a value that is not finite (a division by zero).
[[nodiscard]] Result<double> evaluate(std::string_view text, const NamedNumbers& names);

/// Letters, digits and '_', not beginning with a digit.
[[nodiscard]] bool is_name(std::string_view text) noexcept;

}  // namespace surefoot::sim
