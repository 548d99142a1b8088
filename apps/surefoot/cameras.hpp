// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "surefoot/io/live_camera/v4l2_device.hpp"

namespace surefoot::app {

/// What a live camera says of itself.
struct CameraView {
    std::string device;
    std::string card;
    std::string driver;
    std::vector<io::VideoMode> modes;
    std::vector<io::VideoControl> controls;
};
[[nodiscard]] Result<CameraView> camera_view(const std::string& device);

/// A video node of this machine: what it is called, or why it cannot be used.
struct CameraNode {
    std::string device;
    std::string card;
    std::string problem;  ///< empty = it can be opened and delivers video
};
/// /dev/video*, in natural order.
[[nodiscard]] std::vector<CameraNode> camera_nodes();

}  // namespace surefoot::app
