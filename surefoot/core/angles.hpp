// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace surefoot {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;

}  // namespace surefoot
