// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/grid/map_region.hpp"

namespace surefoot::elevation {

class ElevationMap;

/// What the map knows of a window, by default of all of it; cells beyond the map are unknown. Frame
/// name, times, pose and hash are the caller's to fill in. `window->problem()` must be empty.
[[nodiscard]] grid::MapRegion region_of(
    const ElevationMap& map, const std::optional<grid::LatticeBox>& window = std::nullopt);

/// Lets every cell pay for an uncertain motion of the body that ended in `T_frame_body`, or for an
/// uncertain placement of the region as seen from there; `covariance` as for
/// `ElevationMap::follow`. The region then is one seen from that pose. Cells whose variance leaves
/// the range of a float are forgotten. Fails, and changes nothing, where pose or covariance are not
/// finite: then nothing is known of where the cells are.
[[nodiscard]] Status pay_for_motion(grid::MapRegion& region,
                                    const Pose& T_frame_body,
                                    const Matrix6& covariance);

}  // namespace surefoot::elevation
