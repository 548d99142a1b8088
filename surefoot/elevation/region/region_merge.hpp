// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/result.hpp"
#include "surefoot/elevation/fusion/height_fusion.hpp"
#include "surefoot/grid/map_region.hpp"

namespace surefoot::elevation {

/// What the heights of two regions have in common.
enum class RegionErrors : std::uint8_t {
    shared,       ///< one run: the same looks, matcher errors and drift may be in both
    independent,  ///< two runs over the same ground, one placed in the frame of the other
};

struct MergeCounts {
    std::int64_t taken = 0;      ///< cells that only `from` knew
    std::int64_t agreed = 0;     ///< known to both, within the Mahalanobis gate
    std::int64_t disagreed = 0;  ///< known to both, outside of it
};

/// Puts what `from` knows into `into`, which grows to the smallest box around both. The cells
/// do not depend on which is which. One rule for every cell:
/// * known to one of them: it is taken as it is;
/// * known to both, and they agree (`mahalanobis_sq` within `fusion.gate_sigma`): with shared
///   errors the surer height stays as it is, nothing being gained (covariance intersection in one
///   dimension, Julier and Uhlmann 1997); with independent errors both are fused by equation 6.1.
///   The cell has the later sighting with its drift and confidence, and of extremes, clearance and
///   density what warns more;
/// * known to both, and they disagree: the cell that was seen later stays, and the squared
///   difference of the heights is added to its variance.
///
/// Stamp, pose and configuration are those of the region with the later stamp; the cells of the
/// other must have paid for the motion between (`pay_for_motion`). Fails, and changes nothing,
/// where resolution or frame differ, or where both together are too large. With independent errors
/// the frames need the same name only: that they are the same place is the caller's word.
[[nodiscard]] Result<MergeCounts> merge(grid::MapRegion& into,
                                        const grid::MapRegion& from,
                                        const FusionConfig& fusion,
                                        RegionErrors errors = RegionErrors::shared);

}  // namespace surefoot::elevation
