// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

/// Keys keep the order in which they are written: the same answer gives the same bytes.
using Json = nlohmann::ordered_json;

/// What a foreign text may be at most.
struct JsonLimits {
    std::size_t max_bytes = 64 * 1024;
    int max_depth = 12;  ///< a stamped pose in a publish message is four deep
    std::size_t max_string_bytes = 1024;
};

/// One whole JSON value in valid UTF-8, within the limits, no key twice in an object, every number
/// finite; else the first problem in words.
[[nodiscard]] Result<Json> parse_json(std::string_view text, const JsonLimits& limits);

/// Null where it is none: JSON has no infinity and no NaN.
[[nodiscard]] Json number(double value);

/// On one line. Bytes that are no UTF-8 become U+FFFD: an answer is never lost for its text.
[[nodiscard]] std::string dump(const Json& json);

}  // namespace surefoot::gate_process
