// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// What a mistyped name may have meant: the one place for keys, verbs, scenes, rigs and machines.
namespace surefoot {

/// Names in order of their likeness to `name` (edit distance), at most `count`, only plausible
/// ones.
[[nodiscard]] std::vector<std::string> nearest_names(std::string_view name,
                                                     std::span<const std::string> names,
                                                     std::size_t count = 3);
/// "; did you mean 'a' or 'b'?" from nearest_names, or an empty string.
[[nodiscard]] std::string did_you_mean(std::string_view name, std::span<const std::string> names);

}  // namespace surefoot
