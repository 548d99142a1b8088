// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/io/settings/model_file.hpp"

namespace surefoot::io {

/// The model as a URDF text; deterministic. Materials are named at robot level, because some
/// readers lose the colours of others. Each box is a visual and a collision element. The URDF has
/// no masses: it is not for dynamics simulation.
[[nodiscard]] std::string urdf_text(const MachineModel& model);

}  // namespace surefoot::io
