// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "surefoot/camera/frame_source.hpp"
#include "surefoot/io/settings/model_file.hpp"

namespace surefoot::app {

/// Writes the joint angles of the machine at a time of the source's clock. Leaves the vector empty
/// if the angles are not known at that time. An integration with a real machine supplies its own
/// function.
using JointsAt = std::function<void(std::int64_t time_ns, std::vector<float>& joints_rad)>;

/// Returns a function that gives the angles of the moving joints, in the order of the model. It
/// works only for a simulated REX and a model with the joint names of the REX; otherwise the
/// returned function is empty. The source must outlive the returned function.
[[nodiscard]] JointsAt joints_of(const camera::FrameSource& source, const io::MachineModel& model);

}  // namespace surefoot::app
