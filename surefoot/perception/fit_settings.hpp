// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/io/settings/machine_file.hpp"
#include "surefoot/perception/settings.hpp"

namespace surefoot {

/// What the camera and the machine file know goes into settings that the user left alone.
void fit_settings(const camera::StereoRig& rig,
                  const std::optional<io::MachineFile>& machine,
                  Settings& settings);

/// The rig; where it does not say how the camera is mounted, with the mount of the machine.
[[nodiscard]] camera::StereoRig mounted_rig(const camera::StereoRig& rig,
                                            const std::optional<io::MachineFile>& machine);

}  // namespace surefoot
