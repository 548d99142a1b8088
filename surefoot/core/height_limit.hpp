// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace surefoot {

/// Largest magnitude of a height. It accepts Mount Everest, the deepest trench, and heights up to
/// 100 m that are in mm by mistake. Readers of height maps treat a larger value as unknown, never
/// as ground. Such values have wrong units or are "no data" marks (-3.4e38, 1e20, -2147483648).
inline constexpr double kMaxHeight_m = 1e5;

}  // namespace surefoot
