// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "surefoot/io/live_camera/v4l2_device.hpp"

namespace surefoot::app {

/// Properties that a live camera reports.
struct CameraView {
    std::string device;
    std::string card;
    std::string driver;
    std::vector<io::VideoMode> modes;
    std::vector<io::VideoControl> controls;
};
[[nodiscard]] Result<CameraView> camera_view(const std::string& device);

/// A video device node of this computer.
struct CameraNode {
    std::string device;
    std::string card;
    std::string problem;  ///< why the camera cannot be used; empty = it delivers video
};
/// Returns all nodes /dev/video*, sorted so that video10 follows video9.
[[nodiscard]] std::vector<CameraNode> camera_nodes();

}  // namespace surefoot::app
