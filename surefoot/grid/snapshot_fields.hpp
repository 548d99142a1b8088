// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/grid/map_snapshot.hpp"

/// Lists all fields and layers of a snapshot once: for its checksums, its file and the audit log.
namespace surefoot::grid {

/// Calls visit(name, value) for the header fields in the order of memory, without magic, layout,
/// padding and checksums.
template <typename Snapshot, typename Visit>
void for_each_header_field(Snapshot& s, Visit&& visit) {
    visit("version", s.version);
    visit("config_hash", s.config_hash);
    visit("frame_time_ns", s.frame_time_ns);
    visit("pose_time_ns", s.pose_time_ns);
    visit("resolution_tenth_mm", s.resolution_tenth_mm);
    visit("nx", s.nx);
    visit("ny", s.ny);
    visit("edge_count", s.edge_count);
    visit("origin_x_tenth_mm", s.origin_x_tenth_mm);
    visit("origin_y_tenth_mm", s.origin_y_tenth_mm);
    visit("body_x_tenth_mm", s.body_x_tenth_mm);
    visit("body_y_tenth_mm", s.body_y_tenth_mm);
    visit("body_z_tenth_mm", s.body_z_tenth_mm);
    visit("body_cos_yaw", s.body_cos_yaw);
    visit("body_sin_yaw", s.body_sin_yaw);
    visit("gravity_source", s.gravity_source);
    visit("health", s.health);
    visit("camera", s.camera);
    visit("tilt_sigma_urad", s.tilt_sigma_urad);
}

/// Calls visit(layer) for each layer of cells. Every layer has one element per cell.
template <typename Snapshot, typename Visit>
void for_each_snapshot_layer(Snapshot& s, Visit&& visit) {
    visit(s.height_tenth_mm);
    visit(s.sigma_tenth_mm);
    visit(s.drift_tenth_mm);
    visit(s.clearance_tenth_mm);
    visit(s.component);
    visit(s.drop_evidence);
    visit(s.source);
}

}  // namespace surefoot::grid
