// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::io {

/// Makes the cells of a height map unknown whose heights cannot be measured ones, and says in one
/// sentence each which values it took out and how many cells held them:
///  - heights beyond kMaxHeight_m (surefoot/core/height_limit.hpp),
///  - marks for "no data" that no header declares: a value at either end of the heights, more than
///    50 m from all others, which either is a usual mark (-9999, -32768, ...) or is farther from
///    the others than ten times their own range.
/// An undeclared void must never become ground; a real tower or pit that looks like a mark becomes
/// unknown, which is never safe.
[[nodiscard]] std::vector<std::string> drop_impossible_heights(grid::Layer& heights_m);

}  // namespace surefoot::io
