// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Suggestions for misspelled names: keys, verbs, scenes, rigs and machines all use them.
namespace surefoot {

/// At most `count` plausible names, most similar to `name` first (edit distance). Implausible names
/// are left out.
[[nodiscard]] std::vector<std::string> nearest_names(std::string_view name,
                                                     std::span<const std::string> names,
                                                     std::size_t count = 3);
/// Suggestion text from nearest_names: "; did you mean 'a' or 'b'?", or an empty string.
[[nodiscard]] std::string did_you_mean(std::string_view name, std::span<const std::string> names);

}  // namespace surefoot
