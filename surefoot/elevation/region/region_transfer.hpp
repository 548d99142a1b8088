// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/grid/map_region.hpp"

namespace surefoot::elevation {

class ElevationMap;

/// Copies a window of the map, by default the whole map; cells beyond the map are unknown. The
/// caller sets frame name, times, pose and hash. `window->problem()` must be empty.
[[nodiscard]] grid::MapRegion region_of(
    const ElevationMap& map, const std::optional<grid::LatticeBox>& window = std::nullopt);

/// Adds to every cell the uncertainty of a body motion that ended in `T_frame_body`, or of the
/// region's placement. The uncertainties are then relative to that pose. `covariance`: see
/// `ElevationMap::follow`. Cells become unknown if their variance or drift leaves the range of a
/// float. Returns an error and changes nothing if the pose or the covariance is not finite, because
/// the position of the cells is then unknown.
[[nodiscard]] Status pay_for_motion(grid::MapRegion& region,
                                    const Pose& T_frame_body,
                                    const Matrix6& covariance);

}  // namespace surefoot::elevation
