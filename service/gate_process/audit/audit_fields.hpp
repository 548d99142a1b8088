// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/machine.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/grid/snapshot_fields.hpp"

/// The fields of the audit log in file order. Writing, reading, comparing and naming share one
/// list. A change here needs a new format version (docs/reference/audit_format.md).
namespace surefoot::gate_process {

template <typename Box, typename Visit>
void for_each_box_field(Box& box, Visit& visit) {
    visit("center_x_tenth_mm", box.center_x_tenth_mm);
    visit("center_y_tenth_mm", box.center_y_tenth_mm);
    visit("length_tenth_mm", box.length_tenth_mm);
    visit("width_tenth_mm", box.width_tenth_mm);
}

template <typename Limits, typename Visit>
void for_each_limit(Limits& limits, Visit& visit) {
    for (auto& step : limits.step) {
        visit("enabled", step.enabled);
        visit("up_tenth_mm", step.up_tenth_mm);
        visit("down_tenth_mm", step.down_tenth_mm);
    }
    visit("min_normal_z", limits.min_normal_z);
    visit("patch_side_tenth_mm", limits.patch_side_tenth_mm);
    visit("patch_residual_tenth_mm", limits.patch_residual_tenth_mm);
    visit("patch_sigma_tenth_mm", limits.patch_sigma_tenth_mm);
    visit("sigma_factor", limits.sigma_factor);
    visit("patch_independent_cells", limits.patch_independent_cells);
    visit("cell_sigma_tenth_mm", limits.cell_sigma_tenth_mm);
    visit("swing_clearance_tenth_mm", limits.swing_clearance_tenth_mm);
    visit("foot_margin_tenth_mm", limits.foot_margin_tenth_mm);
    visit("drop_tenth_mm", limits.drop_tenth_mm);
    visit("drop_band_tenth_mm", limits.drop_band_tenth_mm);
    visit("drop_evidence", limits.drop_evidence);
    visit("drift_tenth_mm", limits.drift_tenth_mm);
    visit("tread_share_permille", limits.tread_share_permille);
    visit("tread_overhang_tenth_mm", limits.tread_overhang_tenth_mm);
    visit("frame_age_ns", limits.frame_age_ns);
    visit("pose_age_ns", limits.pose_age_ns);
    visit("future_tolerance_ns", limits.future_tolerance_ns);
    visit("verdict_ttl_ns", limits.verdict_ttl_ns);
    visit("attestation_radius_tenth_mm", limits.attestation_radius_tenth_mm);
}

template <typename Machine, typename Visit>
void for_each_machine_field(Machine& machine, Visit& visit) {
    visit("sole_depth_tenth_mm", machine.sole_depth_tenth_mm);
    for_each_box_field(machine.left_foot, visit);
    for_each_box_field(machine.right_foot, visit);
    visit("ankle_from_heel_tenth_mm", machine.ankle_from_heel_tenth_mm);
    for (auto& part : machine.body.parts) {
        for_each_box_field(part.box, visit);
        visit("low_tenth_mm", part.low_tenth_mm);
        visit("high_tenth_mm", part.high_tenth_mm);
    }
    visit("count", machine.body.count);
    visit("sway_tenth_mm", machine.body.sway_tenth_mm);
    for (auto& movement : machine.movements) {
        visit("configured", movement.configured);
        visit("movement_class", movement.movement_class);
        visit("name", movement.name);
        visit("forward_tenth_mm", movement.forward_tenth_mm);
        visit("left_tenth_mm", movement.left_tenth_mm);
        visit("cos_turn", movement.cos_turn);
        visit("sin_turn", movement.sin_turn);
    }
    for_each_limit(machine.limits, visit);
}

template <typename Query, typename Visit>
void for_each_query_field(Query& query, Visit& visit) {
    visit("command", query.command);
    visit("x_tenth_mm", query.x_tenth_mm);
    visit("y_tenth_mm", query.y_tenth_mm);
    visit("cos_yaw", query.cos_yaw);
    visit("sin_yaw", query.sin_yaw);
    visit("stance_source", query.stance_source);
    visit("stance_height_tenth_mm", query.stance_height_tenth_mm);
    visit("attested.active", query.attested.active);
    visit("attested.center_x_tenth_mm", query.attested.center_x_tenth_mm);
    visit("attested.center_y_tenth_mm", query.attested.center_y_tenth_mm);
    visit("attested.radius_tenth_mm", query.attested.radius_tenth_mm);
    visit("attested.height_tenth_mm", query.attested.height_tenth_mm);
    visit("connection", query.connection);
    visit("sequence", query.sequence);
}

template <typename Health, typename Visit>
void for_each_health_field(Health& health, Visit& visit) {
    visit("state", health.state);
    visit("faults", health.faults);
}

template <typename Verdict, typename Visit>
void for_each_verdict_field(Verdict& verdict, Visit& visit) {
    auto& evidence = verdict.evidence;
    visit("decision", verdict.decision);
    visit("reasons", verdict.reasons);
    visit("primary", verdict.primary);
    visit("evidence.has_worst_cell", evidence.has_worst_cell);
    visit("evidence.worst_x_tenth_mm", evidence.worst_x_tenth_mm);
    visit("evidence.worst_y_tenth_mm", evidence.worst_y_tenth_mm);
    visit("evidence.foot", evidence.foot);
    visit("evidence.value_tenth_mm", evidence.value_tenth_mm);
    visit("evidence.limit_tenth_mm", evidence.limit_tenth_mm);
    visit("evidence.overhead", evidence.overhead);
    visit("evidence.unproven", evidence.unproven);
    visit("evidence.stance_known", evidence.stance_known);
    visit("evidence.stance_height_tenth_mm", evidence.stance_height_tenth_mm);
    visit("evidence.cells", evidence.cells);
    visit("evidence.known_cells", evidence.known_cells);
    visit("evidence.attested_cells", evidence.attested_cells);
    visit("evidence.height_delta_tenth_mm", evidence.height_delta_tenth_mm);
    visit("evidence.max_tilt_tan_sq", evidence.max_tilt_tan_sq);
    visit("evidence.max_patch_sigma_sq_tenth_mm2", evidence.max_patch_sigma_sq_tenth_mm2);
    visit("evidence.max_drift_tenth_mm", evidence.max_drift_tenth_mm);
    visit("evidence.min_clearance_tenth_mm", evidence.min_clearance_tenth_mm);
    visit("command", verdict.command);
    visit("connection", verdict.connection);
    visit("sequence", verdict.sequence);
    visit("map_version", verdict.map_version);
    visit("config_hash", verdict.config_hash);
    visit("frame_time_ns", verdict.frame_time_ns);
    visit("pose_time_ns", verdict.pose_time_ns);
    visit("decided_ns", verdict.decided_ns);
    visit("valid_until_ns", verdict.valid_until_ns);
}

/// The header of a snapshot without padding; its checksum covers all cells of the map.
template <typename Snapshot, typename Visit>
void for_each_snapshot_field(Snapshot& map, Visit& visit) {
    visit("magic", map.magic);
    visit("layout", map.layout);
    grid::for_each_header_field(map, visit);
    visit("checksum", map.checksum);
}

template <typename Box, typename Visit>
void for_each_zone_field(Box& zone, Visit& visit) {
    visit("zone.x", zone.x);
    visit("zone.y", zone.y);
    visit("zone.nx", zone.nx);
    visit("zone.ny", zone.ny);
}

}  // namespace surefoot::gate_process
