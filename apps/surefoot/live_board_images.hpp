// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "apps/surefoot/board_images.hpp"
#include "surefoot/io/live_camera/live_camera.hpp"

namespace surefoot::app {

/// What a session of showing a board to a live camera is.
struct LiveBoards {
    std::string address;  ///< DEVICE@WIDTHxHEIGHT[@RATE], width of both eyes side by side
    bool stereo = true;
    std::string eye = {};  ///< of one camera: left or right
    io::CameraConfig config = {};
    std::function<bool()> stop = {};    ///< asked while waiting; true ends the session
    std::function<void()> opened = {};  ///< called once when the camera answers
    /// Between two images that are used: time to move the board.
    double pause_s = 1.0;
    int most = kMostVideoViews;
};

/// Gives the images of a side-by-side camera to `use`, `pause_s` apart by their stamps, until there
/// are `most` of them or `stop` says so. Frames that bring nothing new are left out.
[[nodiscard]] Status for_live_images(std::unique_ptr<io::VideoDevice> device,
                                     const LiveBoards& session,
                                     const std::function<void(BoardImages)>& use);

}  // namespace surefoot::app
