// SPDX-License-Identifier: Apache-2.0
#include "service/console/numbers.hpp"

#include <fmt/format.h>

#include <cmath>

#include "surefoot/io/text.hpp"

namespace surefoot::app {
namespace {

/// Reads exactly N finite numbers separated by commas. `count` is N as a word, for the error
/// message.
template <std::size_t N>
Result<std::array<double, N>> parse_numbers(const std::string& option,
                                            const std::string& text,
                                            const char* count,
                                            const std::string& meaning) {
    std::array<double, N> values{};
    std::size_t begin = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t end = i + 1 < values.size() ? text.find(',', begin) : text.size();
        const auto value = end == std::string::npos
                               ? std::nullopt
                               : io::parse_double(text.substr(begin, end - begin));
        if (!value || !std::isfinite(*value)) {
            return usage_error(
                fmt::format("{} '{}': give {} finite numbers separated by commas: {}",
                            option,
                            text,
                            count,
                            meaning));
        }
        values[i] = *value;
        begin = end + 1;
    }
    return values;
}

}  // namespace

Result<std::array<double, 3>> parse_three_numbers(const std::string& option,
                                                  const std::string& text,
                                                  const std::string& meaning) {
    return parse_numbers<3>(option, text, "three", meaning);
}

Result<std::array<double, 4>> parse_four_numbers(const std::string& option,
                                                 const std::string& text,
                                                 const std::string& meaning) {
    return parse_numbers<4>(option, text, "four", meaning);
}

Result<std::array<double, 2>> parse_two_numbers(const std::string& option,
                                                const std::string& text,
                                                const std::string& meaning) {
    return parse_numbers<2>(option, text, "two", meaning);
}

}  // namespace surefoot::app
