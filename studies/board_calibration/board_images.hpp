// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::app {

/// Images of a calibration recording that were taken at the same time.
struct BoardImages {
    std::string name;  ///< name of the file or frame
    GreyImage left;    ///< left image, or the image of the only camera
    GreyImage right;   ///< right image; empty for one camera
};

/// Remarks about a source of board images.
struct BoardSource {
    std::vector<std::string> notes;  ///< sentences, for example about files that were left out
};

/// Number of views that is enough for a calibration. A video has more frames: every n-th frame is
/// used, where n is its frame count divided by this number, rounded down. A live session ends by
/// default after this many images.
inline constexpr int kMostVideoViews = 60;

/// Opens `source` and passes its images to `use`, in natural order of the file
/// names. One camera: a folder of images, or a video. If file names begin with
/// "left" and "right", `camera` ("left" or "right") selects the camera. Two
/// cameras, one of these: (1) a folder with pairs left* and right* whose names are
/// otherwise equal; (2) folders left and right (or cam0 and cam1, image_0 and
/// image_1) with equal file names; (3) a folder of side-by-side images; (4) a
/// side-by-side video.
[[nodiscard]] Result<BoardSource> for_board_images(const std::string& source,
                                                   bool stereo,
                                                   const std::string& camera,
                                                   const std::function<void(BoardImages)>& use);

}  // namespace surefoot::app
