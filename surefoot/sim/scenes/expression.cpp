// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>

namespace surefoot::sim {
namespace {

/// Limit of the nesting. Deeper nesting could exhaust the stack, and no scene needs it.
constexpr int kMaxDepth = 64;

bool is_letter(char c) noexcept {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

bool is_digit(char c) noexcept {
    return c >= '0' && c <= '9';
}

bool is_space(char c) noexcept {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

/// Recursive descent:
///   sum     = product { (+|-) product }
///   product = factor { (*|/) factor }
///   factor  = (+|-) factor | number | name | ( sum )
/// After the first error every function returns at once; the value then does not count.
class Parser {
  public:
    Parser(std::string_view text, const NamedNumbers& names) : text_(text), names_(names) {}

    Result<double> whole() {
        const double value = sum(0);
        if (!error_ && next() != '\0') fail(fmt::format("'{}' was not expected", text_[at_]));
        if (!error_ && !std::isfinite(value)) fail("the value is not finite");
        if (error_) return *error_;
        return value;
    }

  private:
    /// Returns the next character that is not a space; '\0' at the end.
    char next() {
        while (at_ < text_.size() && is_space(text_[at_])) ++at_;
        return at_ < text_.size() ? text_[at_] : '\0';
    }

    void fail(const std::string& what) {
        if (error_) return;
        error_ =
            input_error(fmt::format("expression '{}', character {}: {}", text_, at_ + 1, what));
    }

    double sum(int depth) {
        double value = product(depth);
        for (char op = next(); !error_ && (op == '+' || op == '-'); op = next()) {
            ++at_;
            const double term = product(depth);
            value = op == '+' ? value + term : value - term;
        }
        return value;
    }

    double product(int depth) {
        double value = factor(depth);
        for (char op = next(); !error_ && (op == '*' || op == '/'); op = next()) {
            ++at_;
            const double term = factor(depth);
            value = op == '*' ? value * term : value / term;
        }
        return value;
    }

    double factor(int depth) {
        if (depth >= kMaxDepth)
            fail(fmt::format("nested deeper than {} levels; use fewer parentheses and signs",
                             kMaxDepth));
        if (error_) return 0.0;
        const char c = next();
        if (c == '-' || c == '+') {
            ++at_;
            const double value = factor(depth + 1);
            return c == '-' ? -value : value;
        }
        if (c == '(') return in_parentheses(depth);
        if (is_digit(c) || c == '.') return number();
        if (is_letter(c)) return named();
        fail(c == '\0' ? "a number or a name is missing at the end"
                       : fmt::format("'{}' was not expected", c));
        return 0.0;
    }

    double in_parentheses(int depth) {
        ++at_;
        const double value = sum(depth + 1);
        if (!error_ && next() != ')') fail("')' is missing");
        ++at_;
        return value;
    }

    double number() {
        double value = 0.0;
        const char* begin = text_.data() + at_;
        const auto [end, problem] = std::from_chars(begin, text_.data() + text_.size(), value);
        if (problem != std::errc{}) fail("not a number in the range of a double");
        at_ += static_cast<std::size_t>(end - begin);
        return value;
    }

    double named() {
        std::size_t end = at_;
        while (end < text_.size() && (is_letter(text_[end]) || is_digit(text_[end]))) ++end;
        const std::string_view name = text_.substr(at_, end - at_);
        const auto found = names_.find(name);
        if (found == names_.end()) {
            fail(fmt::format("no number is named '{}'; define a parameter of this name", name));
            return 0.0;
        }
        at_ = end;
        return found->second;
    }

    std::string_view text_;
    const NamedNumbers& names_;
    std::size_t at_ = 0;
    std::optional<Error> error_;
};

}  // namespace

Result<double> evaluate(std::string_view text, const NamedNumbers& names) {
    return Parser(text, names).whole();
}

bool is_name(std::string_view text) noexcept {
    return !text.empty() && is_letter(text.front()) &&
           std::all_of(
               text.begin(), text.end(), [](char c) { return is_letter(c) || is_digit(c); });
}

}  // namespace surefoot::sim
