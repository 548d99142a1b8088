// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/verdict_text.hpp"

#include <cstdio>

#include "surefoot/gate/tilt.hpp"

namespace surefoot::gate {
namespace {

double magnitude(double value) {
    return value < 0.0 ? -value : value;
}

double metres(std::int64_t tenth_mm) {
    return static_cast<double>(tenth_mm) * 1e-4;
}

std::string fixed(double value, int decimals) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.*f", decimals, value);
    return text;
}

std::string length(std::int64_t tenth_mm) {
    const double value_m = metres(tenth_mm);
    // Below 0.1 m two decimals are too coarse for the limits.
    return fixed(value_m, magnitude(value_m) < 0.0995 ? 3 : 2) + " m";
}

/// Returns the signed distance of a point from an interval around `center`; 0 inside.
double beyond(double at, double center, double size) {
    if (at > center + size / 2.0) return at - (center + size / 2.0);
    if (at < center - size / 2.0) return at - (center - size / 2.0);
    return 0.0;
}

/// Returns the position relative to the present stance, for example "0.31 m ahead of the left
/// foot".
std::string place(const Evidence& evidence, const Query& query, const Machine& machine) {
    const double dx = metres(evidence.worst_x_tenth_mm - query.x_tenth_mm);
    const double dy = metres(evidence.worst_y_tenth_mm - query.y_tenth_mm);
    const double forward = query.cos_yaw * dx + query.sin_yaw * dy;
    const double left = query.cos_yaw * dy - query.sin_yaw * dx;
    const bool is_left =
        evidence.foot == Foot::left || (evidence.foot == Foot::none && left >= 0.0);
    const GroundBox& box = is_left ? machine.left_foot : machine.right_foot;
    const std::string foot = is_left ? "the left foot" : "the right foot";
    const double ahead =
        beyond(forward, metres(box.center_x_tenth_mm), metres(box.length_tenth_mm));
    const double aside = beyond(left, metres(box.center_y_tenth_mm), metres(box.width_tenth_mm));
    constexpr double kNearM = 0.005;  // rounds to 0.00
    if (magnitude(ahead) < kNearM && magnitude(aside) < kNearM) return "under " + foot;
    if (magnitude(ahead) >= magnitude(aside))
        return fixed(magnitude(ahead), 2) + (ahead > 0.0 ? " m ahead of " : " m behind ") + foot;
    return fixed(magnitude(aside), 2) + (aside > 0.0 ? " m left of " : " m right of ") + foot;
}

std::string limit(const Evidence& evidence) {
    return " (limit " + length(evidence.limit_tenth_mm) + ")";
}

std::string terrain_text(const Verdict& verdict, const Query& query, const Machine& machine) {
    const Evidence& e = verdict.evidence;
    const std::string where = e.has_worst_cell ? ", " + place(e, query, machine) : "";
    const std::string value = length(e.value_tenth_mm);
    const double min_z = machine.limits.min_normal_z;
    switch (verdict.primary) {
        case Reason::outside_map: return "the step leaves the map" + where;
        case Reason::drop_off:
            if (e.value_tenth_mm == 0) return "edge of a drop" + where;
            return "drop of " + value + where + limit(e);
        case Reason::step_too_high: return "step up of " + value + where + limit(e);
        case Reason::step_too_low: return "step down of " + value + where + limit(e);
        case Reason::corridor_blocked:
            if (e.overhead)
                return "something that hangs " + value + " high in the way of the foot" + where +
                       limit(e);
            return "something " + value + " high in the way of the foot" + where + limit(e);
        case Reason::body_clearance:
            if (e.overhead)
                return "only " + value + " of room under something overhead" + where + limit(e);
            return "something " + value + " high in the way of the body" + where + limit(e);
        case Reason::unknown_cells: return "ground that was never seen" + where;
        case Reason::slope:
            return "ground sloping " + fixed(100.0 * root(e.max_tilt_tan_sq), 1) + " %" + where +
                   " (limit " + fixed(100.0 * root(1.0 / (min_z * min_z) - 1.0), 1) + " %)";
        case Reason::roughness: return "ground uneven by " + value + where + limit(e);
        case Reason::disconnected:
            return "ground that is not connected with where you stand" + where;
        case Reason::memory_uncertain:
            return "ground seen too far back to be sure where it is" + where + ": drift " + value +
                   limit(e);
        case Reason::not_resolvable: return "ground not seen well enough" + where + limit(e);
        case Reason::support_area:
            return "only " + value + " of the foot on its tread" + where + ", wanted " +
                   length(e.limit_tenth_mm);
        case Reason::edge_margin:
            return "only " + value + " of the foot surely on its tread" + where + ", wanted " +
                   length(e.limit_tenth_mm);
        default: return to_string(verdict.primary);
    }
}

const char* error_text(Reason reason) {
    switch (reason) {
        case Reason::config: return "the machine description is not valid";
        case Reason::clock: return "the clock cannot be trusted";
        case Reason::bad_message: return "the message could not be read";
        case Reason::bad_number: return "a number of the query is not finite or is out of range";
        case Reason::frame_id: return "the query is in a frame that the gate does not know";
        case Reason::seq: return "the query is out of sequence";
        case Reason::unknown_command: return "the machine has no such movement";
        case Reason::not_ready: return "the system is not ready";
        case Reason::warmup: return "the system is warming up";
        case Reason::mount_moved: return "the camera has moved on its mount";
        case Reason::pose_jump: return "the position jumped";
        case Reason::pose_lost: return "the position is lost";
        case Reason::plane_invalid: return "it is not known how the machine stands on the ground";
        case Reason::blind: return "the camera sees nothing";
        case Reason::exposure: return "the image is too bright";
        case Reason::frame_corrupt: return "the camera image is damaged";
        case Reason::frame_frozen: return "the camera image stands still";
        case Reason::time_skew: return "a measurement is stamped in the future";
        case Reason::frame_stale: return "the last camera image is too old";
        case Reason::pose_stale: return "the last position is too old";
        case Reason::map_stale: return "the map is too old";
        case Reason::expired: return "the answer has expired";
        case Reason::deadline: return "the answer took too long";
        case Reason::overload: return "too many questions at a time";
        case Reason::audit: return "the log cannot be written";
        default: return "internal error: the map or the gate is damaged";
    }
}

}  // namespace

std::string text_of(const Verdict& verdict, const Query& query, const Machine& machine) {
    switch (verdict.decision) {
        case Decision::ok: return "the way is clear and the ground carries";
        case Decision::not_traversable: return terrain_text(verdict, query, machine);
        case Decision::error: break;
    }
    return error_text(verdict.primary);
}

std::vector<std::string_view> names_of(ReasonSet reasons) {
    std::vector<std::string_view> names;
    for (int i = 0; i < kReasonCount; ++i) {
        const auto reason = static_cast<Reason>(i);
        if (reasons.contains(reason)) names.emplace_back(to_string(reason));
    }
    return names;
}

std::vector<std::string_view> unproven_names(const Evidence& evidence) {
    std::vector<std::string_view> names;
    for (int i = 0; i < static_cast<int>(Proof::count); ++i) {
        const auto proof = static_cast<Proof>(i);
        if (evidence.lacks(proof)) names.emplace_back(to_string(proof));
    }
    return names;
}

}  // namespace surefoot::gate
