// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/step_gate.hpp"

/// The messages of all topics except the verdicts.
namespace surefoot::gate_process {

/// Returns {state, why, faults, map_version, frame_age_ms, pose_age_ms, attesting, attested, asked,
/// allowed}. An age is null before the first snapshot. `attested`: the attested area in odom {x_m,
/// y_m, z_m, radius_m}, or null.
[[nodiscard]] Json health_object(const GateReport& report);
/// Returns the data of health_object() as one line of text, for clients without a JSON reader.
[[nodiscard]] std::string health_text(const GateReport& report);

/// Returns a diagnostic_msgs/DiagnosticArray with one status and the time of the steady clock.
[[nodiscard]] Json diagnostics_object(const GateReport& report, std::int64_t now_ns);

/// Returns {map_version, state, verdicts: [{command, verdict, primary, text}]}: the present answer
/// of `gate` to each movement.
[[nodiscard]] Json outlook_object(const GateReport& report,
                                  const StepGate& gate,
                                  std::span<const Prospect> prospects);

/// Returns two visualization_msgs/Marker for a judged goal: an arrow and a text. Colours: bluish
/// green (OK), vermilion (not traversable), magenta (the gate cannot judge). People with common
/// colour blindness can distinguish them (Okabe and Ito). The text contains the same result.
[[nodiscard]] std::array<Json, 2> goal_markers(const GoalQuestion& goal, const Answer& answer);
/// Returns messages that delete both markers, because the last goal could not be read.
[[nodiscard]] std::array<Json, 2> no_goal_markers();

}  // namespace surefoot::gate_process
