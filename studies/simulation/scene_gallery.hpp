// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Writes two pictures of every scene and an index.html that shows them. NAME.png is the left image
/// half-way along the path. For a walk, it is the image before the first turn of the machine.
/// NAME_height.png is the true ground from above, with the path.
[[nodiscard]] Status write_scene_gallery(const std::string& folder,
                                         std::uint64_t seed,
                                         Executor& executor);

}  // namespace surefoot::app
