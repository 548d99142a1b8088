// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace surefoot {

/// Largest magnitude of a height. Beyond it lie wrong units and "no data" marks (-3.4e38, 1e20,
/// -2147483648); below it Mount Everest, the deepest trench and millimetres up to 100 m. Readers of
/// heights treat a larger value as unknown, never as ground.
inline constexpr double kMaxHeight_m = 1e5;

}  // namespace surefoot
