// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

/// JSON whose keys keep their order of insertion: the same run gives the same bytes.
using Json = nlohmann::ordered_json;

/// Limits for text from a client.
struct JsonLimits {
    std::size_t max_bytes = 64 * 1024;
    int max_depth = 12;  ///< a stamped pose in a publish message has depth four
    std::size_t max_string_bytes = 1024;
};

/// Parses one complete JSON value: valid UTF-8, within the limits, without duplicate keys, with
/// finite numbers only. Otherwise the error names the first problem.
[[nodiscard]] Result<Json> parse_json(std::string_view text, const JsonLimits& limits);

/// Returns the number, or null if it is infinite or NaN: JSON has neither of these values.
[[nodiscard]] Json number(double value);

/// Serialises on one line. Invalid UTF-8 becomes U+FFFD, so that no answer is lost.
[[nodiscard]] std::string dump(const Json& json);
/// Serialises like dump(), over several lines with an indent of two: for answers and files that
/// people read.
[[nodiscard]] std::string dump_indented(const Json& json);

}  // namespace surefoot::gate_process
