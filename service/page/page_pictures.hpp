// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/core/frame.hpp"

namespace surefoot::page {

/// Returns the JPEG of a camera image; empty if the image is empty.
[[nodiscard]] std::string jpeg_of(const GreyImage& image);
/// Returns the JPEG of a disparity image in false colours: bright = near, black = unknown. The
/// largest disparity, at least 1 px, gets the brightest colour. Empty if the image is empty.
[[nodiscard]] std::string jpeg_of_disparity(const Image<float>& disparity_px);

}  // namespace surefoot::page
