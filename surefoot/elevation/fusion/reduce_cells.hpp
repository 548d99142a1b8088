// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/elevation/fusion/cell_reduction.hpp"

namespace surefoot::elevation {

/// `reduce_cell` for neighbouring cells, for every instruction set with the same bytes. Samples of
/// cell i lie at [begin[i], begin[i + 1]); reads up to `CellGroups::kSlack` beyond the last one.
/// A cell without a measurement gets 0 points.
void reduce_cells(const ReductionConfig& config,
                  const std::uint32_t* begin,
                  int cells,
                  const float* z_m,
                  const float* var_m2,
                  CellMeasurement* measured);

}  // namespace surefoot::elevation
