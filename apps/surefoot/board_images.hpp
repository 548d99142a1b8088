// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::app {

/// One moment of a calibration recording.
struct BoardImages {
    std::string name;  ///< of the file or frame
    GreyImage left;    ///< or the only one
    GreyImage right;   ///< empty for one camera
};

/// What is worth knowing about a source beyond its images.
struct BoardSource {
    std::vector<std::string> notes;  ///< sentences: files left out
};

/// A video has far more frames than views are needed.
inline constexpr int kMostVideoViews = 60;

/// Opens `source` and gives its images to `use` in natural order.
/// One camera: the images of a folder, or a video; where names begin with "left" and "right" the
/// ones of `eye`. Two cameras: a folder with left* and right* of equal rest, folders left and right
/// (or cam0 and cam1, image_0 and image_1) with equal names, else side-by-side images or a video.
[[nodiscard]] Result<BoardSource> for_board_images(const std::string& source,
                                                   bool stereo,
                                                   const std::string& eye,
                                                   const std::function<void(BoardImages)>& use);

}  // namespace surefoot::app
