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

/// Map data for a snapshot. All layers have the size of `geometry`; NaN = unknown.
struct SnapshotInput {
    GridGeometry geometry;  ///< in the frame odom; the cell side is a whole number of 0.1 mm
    ImageView<const float> height_m;
    ImageView<const float> variance_m2;  ///< variance of the height
    /// 1-sigma horizontal drift of the pose since the last observation of the cell. Without this
    /// layer the drift is unknown and the gate refuses. Offline callers pass zeros and report this
    /// assumption.
    ImageView<const float> drift_m;
    ImageView<const float> clearance_m;  ///< optional: free height above the cell
    /// Optional, for unknown cells: rays passed at this height, so the ground lies lower. If this
    /// height is below an attested level by more than a drop, the gate ignores the attestation.
    ImageView<const float> free_above_m;
    ImageView<const float>
        drop_evidence;  ///< optional: evidence of a drop at the cell, 0 (none) to 1 (proven)
    /// Optional: cells with a value other than 0 have an untrusted measurement and become unknown.
    ImageView<const std::uint8_t> hidden;
    /// A line in odom where the ground drops; see SnapshotEdge.
    struct Edge {
        Eigen::Vector2d from_m = Eigen::Vector2d::Zero();
        Eigen::Vector2d to_m = Eigen::Vector2d::Zero();
        double upper_m = 0.0;
        double lower_m = 0.0;
        double height_sigma_m = 0.0;
        double across_sigma_m = 0.0;
    };
    std::span<const Edge> edges;  ///< optional; only the kMaxEdges nearest edges are used
    Pose T_odom_body;
    std::int64_t frame_time_ns = 0;
    std::int64_t pose_time_ns = 0;
    GravitySource gravity_source = GravitySource::assumed;
    /// One sigma, about any horizontal axis, of the angle between odom's z axis and the vertical.
    /// NaN = unknown; the gate then refuses.
    double tilt_sigma_rad = std::numeric_limits<double>::quiet_NaN();
    SnapshotHealth health = SnapshotHealth::lost;
    CameraState camera = CameraState::unknown;
    std::uint64_t version = 0;
    std::uint64_t config_hash = 0;
    /// Neighbour cells belong to one surface if their heights differ by at most this step.
    double connect_step_m = 0.05;
    /// A cell lies above a drop if ground within `drop_reach_m` of it is lower by more than this.
    double drop_step_m = 0.05;
    double drop_reach_m = 0.5;
};

/// Fills `out` and seals it with its checksum. Crops to 256 x 256 cells around the body. Rounds
/// sigma and drift up and clearance down, so that rounding never makes a cell seem safer. NaN and
/// too large values become unknown or the largest value. After an error `out` is not intact: a gate
/// that still receives it answers ERROR.
///
/// This function computes two layers:
/// - `component`: connected known cells (4 neighbours, heights within `connect_step_m`), numbered
///   from 1 in the order of their first cell. Surfaces beyond 65535 get no number.
/// - `drop_evidence`: 255 on the *upper* cell of a measured drop. Each measured cell is compared
///   with the next measured cell along its row and column, at most `drop_reach_m` away. It is also
///   compared with rays that passed over occluded cells up to there. The cell is an upper cell if
///   such a cell or ray lies lower by more than `drop_step_m`. The lower cell gets no evidence: for
///   a machine that stands on it, the lower ground is no drop (the floor beside a table).
[[nodiscard]] Status build_snapshot(const SnapshotInput& input, MapSnapshot& out);

}  // namespace surefoot::grid
