// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Writes two pictures of every scene and an index.html that shows them. NAME.png is the left image
/// at half of the duration of the path. For a walk with turns, it is the image at the first turn.
/// NAME_height.png is the true ground from above, with the path.
[[nodiscard]] Status write_scene_gallery(const std::string& folder,
                                         std::uint64_t seed,
                                         Executor& executor);

}  // namespace surefoot::app
