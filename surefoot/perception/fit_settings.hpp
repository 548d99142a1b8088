// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/perception/settings.hpp"

namespace surefoot {

/// Takes values of the camera and the machine file for settings that the user did not set.
void fit_settings(const camera::StereoRig& rig,
                  const std::optional<io::MachineFile>& machine,
                  Settings& settings);

/// Returns `rig`. If it does not state its mounting, the result has the mounting of the machine.
[[nodiscard]] camera::StereoRig mounted_rig(const camera::StereoRig& rig,
                                            const std::optional<io::MachineFile>& machine);

}  // namespace surefoot
