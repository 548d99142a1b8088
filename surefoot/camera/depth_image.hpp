// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/depth_image.hpp"

namespace surefoot::camera {

using surefoot::DepthImage;  // in core, because frames may bring one

}  // namespace surefoot::camera
