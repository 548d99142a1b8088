// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/sim/scenes/scene_file.hpp"

namespace surefoot::sim {

/// The files of surefoot/sim/scene_files/, sorted by name; made by the build.
[[nodiscard]] const std::vector<SceneFile>& embedded_scenes();

}  // namespace surefoot::sim
