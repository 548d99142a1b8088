// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "surefoot/sim/scenes/scene_file.hpp"

namespace surefoot::sim {

/// The files of surefoot/sim/scene_files/, sorted by name; the build generates this list.
[[nodiscard]] const std::vector<SceneFile>& embedded_scenes();

}  // namespace surefoot::sim
