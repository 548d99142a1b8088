// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

namespace surefoot {

/// Value of a number that is not known. Comparisons with it are false; test with std::isnan.
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
/// Same for the float images and map layers.
inline constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();

}  // namespace surefoot
