// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/reason.hpp"

#include "surefoot/gate/verdict.hpp"

namespace surefoot::gate {

const char* to_string(Reason reason) noexcept {
    switch (reason) {
        case Reason::internal: return "INTERNAL";
        case Reason::config: return "CONFIG";
        case Reason::clock: return "CLOCK";
        case Reason::bad_message: return "BAD_MESSAGE";
        case Reason::bad_number: return "BAD_NUMBER";
        case Reason::frame_id: return "FRAME_ID";
        case Reason::seq: return "SEQ";
        case Reason::unknown_command: return "UNKNOWN_COMMAND";
        case Reason::not_ready: return "NOT_READY";
        case Reason::warmup: return "WARMUP";
        case Reason::mount_moved: return "MOUNT_MOVED";
        case Reason::pose_jump: return "POSE_JUMP";
        case Reason::pose_lost: return "POSE_LOST";
        case Reason::plane_invalid: return "PLANE_INVALID";
        case Reason::blind: return "BLIND";
        case Reason::exposure: return "EXPOSURE";
        case Reason::frame_corrupt: return "FRAME_CORRUPT";
        case Reason::frame_frozen: return "FRAME_FROZEN";
        case Reason::time_skew: return "TIME_SKEW";
        case Reason::frame_stale: return "FRAME_STALE";
        case Reason::pose_stale: return "POSE_STALE";
        case Reason::map_stale: return "MAP_STALE";
        case Reason::expired: return "EXPIRED";
        case Reason::deadline: return "DEADLINE";
        case Reason::overload: return "OVERLOAD";
        case Reason::audit: return "AUDIT";
        case Reason::outside_map: return "OUTSIDE_MAP";
        case Reason::drop_off: return "DROP_OFF";
        case Reason::step_too_high: return "STEP_TOO_HIGH";
        case Reason::step_too_low: return "STEP_TOO_LOW";
        case Reason::corridor_blocked: return "CORRIDOR_BLOCKED";
        case Reason::body_clearance: return "BODY_CLEARANCE";
        case Reason::unknown_cells: return "UNKNOWN_CELLS";
        case Reason::slope: return "SLOPE";
        case Reason::roughness: return "ROUGHNESS";
        case Reason::disconnected: return "DISCONNECTED";
        case Reason::memory_uncertain: return "MEMORY_UNCERTAIN";
        case Reason::not_resolvable: return "NOT_RESOLVABLE";
        case Reason::support_area: return "SUPPORT_AREA";
        case Reason::edge_margin: return "EDGE_MARGIN";
        case Reason::none: return "NONE";
    }
    return "INTERNAL";  // an invalid value counts as INTERNAL, so it never allows a step
}

const char* to_string(Decision decision) noexcept {
    switch (decision) {
        case Decision::ok: return "OK";
        case Decision::not_traversable: return "NOT_TRAVERSABLE";
        case Decision::error: return "ERROR";
    }
    return "ERROR";
}

const char* to_string(Proof proof) noexcept {
    switch (proof) {
        case Proof::process_ready: return "process_ready";
        case Proof::machine_valid: return "machine_valid";
        case Proof::snapshot_intact: return "snapshot_intact";
        case Proof::numbers_valid: return "numbers_valid";
        case Proof::stamps_fresh: return "stamps_fresh";
        case Proof::gravity_known: return "gravity_known";
        case Proof::pose_healthy: return "pose_healthy";
        case Proof::camera_healthy: return "camera_healthy";
        case Proof::command_known: return "command_known";
        case Proof::cells_intact: return "cells_intact";
        case Proof::stance_known: return "stance_known";
        case Proof::corridors_clear: return "corridors_clear";
        case Proof::body_clear: return "body_clear";
        case Proof::bands_solid: return "bands_solid";
        case Proof::left_supported: return "left_supported";
        case Proof::right_supported: return "right_supported";
        case Proof::count: break;
    }
    return "unknown";
}

}  // namespace surefoot::gate
