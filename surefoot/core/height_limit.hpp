// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace surefoot {

/// A height of larger magnitude is no height but a mark for "no data" (-3.4e38, 1e20, -2147483648)
/// or a wrong unit. Mount Everest in a national grid, the deepest trench and heights in millimetres
/// up to 100 m are smaller. Readers of heights take such a value as unknown, never as ground.
inline constexpr double kMaxHeight_m = 1e5;

}  // namespace surefoot
