// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/io/settings/model_file.hpp"

namespace surefoot::io {

/// Formats the model as a URDF text. Materials are named at robot level, because some readers lose
/// the colours of materials in links. Each box is a visual and a collision element. The URDF has no
/// masses and does not suit dynamics simulation.
[[nodiscard]] std::string urdf_text(const MachineModel& model);

}  // namespace surefoot::io
