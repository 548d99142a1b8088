// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/step_gate.hpp"

/// The messages of all topics but the verdicts.
namespace surefoot::gate_process {

/// {state, why, faults, map_version, frame_age_ms, pose_age_ms, vouching, vouched, asked, allowed}.
/// An age is null before the first snapshot came. `vouched` is the attested area in odom {x_m, y_m,
/// z_m, radius_m}, or null.
[[nodiscard]] Json health_object(const GateReport& report);
/// The same on one line, for those who do not read JSON themselves.
[[nodiscard]] std::string health_text(const GateReport& report);

/// A diagnostic_msgs/DiagnosticArray of one status, stamped with the steady clock.
[[nodiscard]] Json diagnostics_object(const GateReport& report, std::int64_t now_ns);

/// {map_version, state, verdicts: [{command, verdict, primary, text}]}: what `gate` would say to
/// each movement.
[[nodiscard]] Json outlook_object(const GateReport& report,
                                  const StepGate& gate,
                                  std::span<const Prospect> prospects);

/// Two visualization_msgs/Marker for a goal that was judged: an arrow and its words. Bluish green,
/// vermilion, and magenta where the gate cannot judge: three colours that people with any of the
/// usual colour blindnesses tell apart (Okabe and Ito), and the words say the same.
[[nodiscard]] std::array<Json, 2> goal_markers(const GoalQuestion& goal, const Answer& answer);
/// The same two markers taken away: the last goal could not be read.
[[nodiscard]] std::array<Json, 2> no_goal_markers();

}  // namespace surefoot::gate_process
