// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/scene_file.hpp"

namespace surefoot::sim {

/// The files of sim/scenes/, sorted by name; made by the build.
[[nodiscard]] const std::vector<SceneFile>& embedded_scenes();

}  // namespace surefoot::sim
