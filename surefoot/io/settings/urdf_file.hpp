// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/io/settings/model_file.hpp"

namespace surefoot::io {

/// The model as a URDF, the same text every time: materials named at the level of the robot (some
/// readers lose the colours of others), each box to be seen and to be collided with. It has no
/// masses: nobody simulates forces with it.
[[nodiscard]] std::string urdf_text(const MachineModel& model);

}  // namespace surefoot::io
