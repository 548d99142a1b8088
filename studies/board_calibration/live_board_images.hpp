// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "studies/board_calibration/board_images.hpp"
#include "surefoot/io/live_camera/live_camera.hpp"

namespace surefoot::app {

/// Settings of a session in which a user shows a calibration board to a live camera.
struct LiveBoards {
    std::string address;  ///< DEVICE@WIDTHxHEIGHT[@RATE]; WIDTH spans both images
    bool stereo = true;
    std::string camera = {};  ///< camera to use if not `stereo`: left or right
    io::CameraConfig config = {};
    std::function<bool()> stop = {};    ///< polled while waiting; returns true to end the session
    std::function<void()> opened = {};  ///< called once when the camera is open
    /// Smallest time between two used images [s], so that the user can move the board.
    double pause_s = 1.0;
    int most = kMostVideoViews;  ///< number of images at which the session ends
};

/// Passes images of a side-by-side camera to `use` until `use` has got `most` images or `stop`
/// returns true. The stamps of consecutive images differ by at least `pause_s`. Repeated and
/// incomplete frames are skipped.
[[nodiscard]] Status for_live_images(std::unique_ptr<io::VideoDevice> device,
                                     const LiveBoards& session,
                                     const std::function<void(BoardImages)>& use);

}  // namespace surefoot::app
