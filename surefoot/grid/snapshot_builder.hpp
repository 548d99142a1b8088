// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::grid {

/// What a map knows, on its way to the gate. All layers have the size of `geometry`; NaN = unknown.
struct SnapshotInput {
    GridGeometry geometry;  ///< in odom; the resolution must be a whole number of 0.1 mm
    ImageView<const float> height_m;
    ImageView<const float> variance_m2;  ///< of the height
    /// 1-sigma horizontal drift of the pose since the cell was last seen. Without this layer the
    /// drift is unknown, which the gate refuses: offline callers pass zeros and list the
    /// assumption.
    ImageView<const float> drift_m;
    ImageView<const float> clearance_m;  ///< optional: free height above the cell
    /// Optional, of unknown cells: lines of sight passed at this height, ground lies lower. Told
    /// to the gate, which takes nobody's word for level ground there.
    ImageView<const float> free_above_m;
    ImageView<const float>
        drop_evidence;  ///< optional: 0..1 from rays that passed below the ground
    /// Optional: not 0 = what was measured in the cell is not believed. The cell is unknown.
    ImageView<const std::uint8_t> hidden;
    /// A line in odom at which the ground falls; see SnapshotEdge.
    struct Edge {
        Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
        Eigen::Vector2d to_m = Eigen::Vector2d::Zero();
        double upper_m = 0.0;
        double lower_m = 0.0;
        double height_sigma_m = 0.0;
        double across_sigma_m = 0.0;
    };
    std::span<const Edge> edges;  ///< optional; beyond kMaxEdges the farthest are left out
    Pose T_odom_body;
    std::int64_t frame_time_ns = 0;
    std::int64_t pose_time_ns = 0;
    GravitySource gravity_source = GravitySource::assumed;
    /// One sigma, about any horizontal axis, of the angle between odom's z axis and the vertical.
    /// NaN = not known, which the gate refuses.
    double tilt_sigma_rad = std::numeric_limits<double>::quiet_NaN();
    SnapshotHealth health = SnapshotHealth::lost;
    CameraState camera = CameraState::unknown;
    std::uint64_t version = 0;
    std::uint64_t config_hash = 0;
    /// Neighbour cells whose heights differ by no more belong to one surface.
    double connect_step_m = 0.05;
    /// Ground lower by more, within `drop_reach_m` behind an edge, makes the edge a drop.
    double drop_step_m = 0.05;
    double drop_reach_m = 0.5;
};

/// Fills `out` and seals it with its checksum. Crops to 256 x 256 cells around the body. Rounds so
/// that no cell looks better than it is: sigma and drift upward, clearance downward; what is NaN or
/// too large becomes unknown or saturates. On an error `out` is left not intact, so that a gate
/// that gets it all the same answers ERROR.
///
/// Layers made here:
/// - `component`: connected known cells (4 neighbours, heights within `connect_step_m`), numbered
///   from 1 in order of their first cell; surfaces beyond 65535 get none.
/// - `drop_evidence`: the upper cell of a drop that was measured. Along rows and columns the next
///   known cell behind an edge, across at most `drop_reach_m` of unknown shadow, is looked up; when
///   it, or what lines of sight left for ground in the shadow, lies lower by more than
///   `drop_step_m`, the *upper* cell gets 255. The evidence sits on the upper cell because "drop"
///   depends on where one stands: the floor beside a table is no drop.
[[nodiscard]] Status build_snapshot(const SnapshotInput& input, MapSnapshot& out);

}  // namespace surefoot::grid
