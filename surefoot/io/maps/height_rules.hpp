// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::io {

/// Makes cells of a height map unknown if their heights cannot be measurements. Returns one
/// sentence for each removed value, with the number of its cells. Removed values:
///  - heights beyond kMaxHeight_m (surefoot/core/height_limit.hpp),
///  - undeclared "no data" marks: a value at either end of the heights, more than 50 m from all
///    others, that is a usual mark (-9999, -32768, ...) or is farther from the others than ten
///    times their own range.
/// An undeclared void must never become ground. A real tower or pit that looks like a mark becomes
/// unknown, which is never safe.
[[nodiscard]] std::vector<std::string> drop_impossible_heights(grid::Layer& heights_m);

}  // namespace surefoot::io
