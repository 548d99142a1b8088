// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/result.hpp"
#include "surefoot/elevation/fusion/height_fusion.hpp"
#include "surefoot/grid/map_region.hpp"

namespace surefoot::elevation {

/// Common errors of the heights of two regions.
enum class RegionErrors : std::uint8_t {
    shared,       ///< one run: both may share observations, matcher errors and drift
    independent,  ///< two runs over the same ground; one is placed in the other's frame
};

struct MergeCounts {
    std::int64_t taken = 0;      ///< cells known only in `from`
    std::int64_t agreed = 0;     ///< known in both, within the Mahalanobis gate
    std::int64_t disagreed = 0;  ///< known in both, outside of the gate
};

/// Merges `from` into `into`, which grows to the smallest box around both. The order of the two
/// regions does not change the cells. Rules for a cell:
/// * known in one region: the cell is copied;
/// * known in both, and they agree (`mahalanobis_sq` within `fusion.gate_sigma`). With shared
///   errors the height of smaller variance stays unchanged (covariance intersection in one
///   dimension, Julier and Uhlmann 1997). With independent errors, equation 6.1 (Lange 2016) fuses
///   both. The cell takes time, drift and confidence of the later observation. Of the extremes,
///   clearances and densities it takes the more cautious values;
/// * known in both, and they disagree: the later observed cell stays, and its variance grows by the
///   squared difference of the heights.
///
/// Stamp, pose and configuration come from the region with the later stamp. The cells of the other
/// region must include the motion between the stamps (`pay_for_motion`). Fails without changes if
/// resolution or frame differ, or if the merged region is too large. With independent errors,
/// `frame_since_ns` may differ: the caller guarantees that both frames are at the same place.
[[nodiscard]] Result<MergeCounts> merge(grid::MapRegion& into,
                                        const grid::MapRegion& from,
                                        const FusionConfig& fusion,
                                        RegionErrors errors = RegionErrors::shared);

}  // namespace surefoot::elevation
