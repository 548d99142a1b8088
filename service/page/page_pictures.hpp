// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surefoot/core/frame.hpp"

namespace surefoot::page {

/// JPEG of an eye as it is; empty where there is none.
[[nodiscard]] std::string jpeg_of(const GreyImage& image);
/// JPEG of a disparity in colours, near = bright; unknown is black.
[[nodiscard]] std::string jpeg_of_disparity(const Image<float>& disparity_px);

}  // namespace surefoot::page
