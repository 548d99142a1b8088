// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

namespace surefoot {

/// Value of a number that is not known. It is not equal to any value; test with std::isnan.
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
/// Value of an unknown pixel of a float image, and of an unknown cell of a map layer.
inline constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();

}  // namespace surefoot
