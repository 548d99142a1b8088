// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::io {

/// Makes cells of a height map unknown if their heights cannot be measurements. Returns one
/// sentence for each removed value, with the number of its cells. Removed values:
///  - heights beyond kMaxHeight_m (surefoot/core/height_limit.hpp),
///  - "no data" marks that the file does not declare. A mark is the lowest or highest value, more
///    than 50 m from all others. It is a usual mark (-9999, -32768, ...), or its distance from the
///    others is more than ten times the range of the others.
/// A void must never become ground. A real tower or pit that looks like a mark becomes unknown, and
/// unknown cells never count as safe.
[[nodiscard]] std::vector<std::string> drop_impossible_heights(grid::Layer& heights_m);

}  // namespace surefoot::io
