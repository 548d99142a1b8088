// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/numbers.hpp"

#include <fmt/format.h>

#include <cmath>

#include "io/text.hpp"

namespace surefoot::app {

Result<std::array<double, 3>> parse_three_numbers(const std::string& option,
                                                  const std::string& text,
                                                  const std::string& meaning) {
    std::array<double, 3> values{};
    std::size_t begin = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t end = i + 1 < values.size() ? text.find(',', begin) : text.size();
        const auto value = end == std::string::npos
                               ? std::nullopt
                               : io::parse_double(text.substr(begin, end - begin));
        if (!value || !std::isfinite(*value)) {
            return usage_error(
                fmt::format("{} '{}': three finite numbers {} are needed", option, text, meaning));
        }
        values[i] = *value;
        begin = end + 1;
    }
    return values;
}

}  // namespace surefoot::app
