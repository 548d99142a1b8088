// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "surefoot/camera/frame_source.hpp"
#include "surefoot/io/settings/model_file.hpp"

namespace surefoot::app {

/// Fills in the angles of the machine's joints at a time of the source's clock, or nothing where
/// they are not known then. Whoever knows the joints of a real machine, over whatever wire, is such
/// a function too: frames need not carry what the map has no use for.
using JointsAt = std::function<void(std::int64_t time_ns, std::vector<float>& joints_rad)>;

/// Angles of the model's moving joints, in their order, where the source knows all of them: a
/// simulated REX, and a model with its joints' names. Else an empty function. The source must
/// outlive the answer.
[[nodiscard]] JointsAt joints_of(const camera::FrameSource& source, const io::MachineModel& model);

}  // namespace surefoot::app
