// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Suggestions for misspelled names: keys, verbs, scenes, rigs and machines all use them.
namespace surefoot {

/// Returns at most `count` names, most similar to `name` first (edit distance). Leaves out names
/// that are too different to be meant.
[[nodiscard]] std::vector<std::string> nearest_names(std::string_view name,
                                                     std::span<const std::string> names,
                                                     std::size_t count = 3);
/// Returns a suggestion from nearest_names: "; did you mean 'a' or 'b'?", or an empty string.
[[nodiscard]] std::string did_you_mean(std::string_view name, std::span<const std::string> names);

}  // namespace surefoot
