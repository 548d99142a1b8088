// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/elevation/fusion/cell_reduction.hpp"

namespace surefoot::elevation {

/// Runs `reduce_cell` for neighbouring cells; every instruction set gives the same bytes. Cell i
/// owns the samples [begin[i], begin[i + 1]). Reads up to `CellGroups::kSlack` elements beyond the
/// last sample. A cell without a measurement gets 0 points.
void reduce_cells(const ReductionConfig& config,
                  const std::uint32_t* begin,
                  int cells,
                  const float* z_m,
                  const float* var_m2,
                  CellMeasurement* measured);

}  // namespace surefoot::elevation
