// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Writes for every scene NAME.png (what the left camera sees half-way along the path, of
/// a walk before it turns) and NAME_height.png (the true ground from above, with the path), and
/// index.html that shows them.
[[nodiscard]] Status write_scene_gallery(const std::string& folder,
                                         std::uint64_t seed,
                                         Executor& executor);

}  // namespace surefoot::app
