// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/step_gate.hpp"
#include "surefoot/gate/reason.hpp"

/// Converts untrusted JSON values to types without guessing: a number in quotes, null, true, or a
/// fraction for an integer is an error.
namespace surefoot::gate_process {

/// The largest integer that every JSON reader represents exactly: 2^53 - 1.
inline constexpr std::uint64_t kMaxExact = (std::uint64_t{1} << 53U) - 1;

/// Returns an argument of a call: member `name` of an object, or element `place` of a list
/// (rosbridge allows both). Returns nullptr if the argument is missing.
[[nodiscard]] const Json* argument(const Json& args, const char* name, std::size_t place);
/// Returns member `name`, or the first element of a list, as text; empty if missing or not text.
[[nodiscard]] std::string text_argument(const Json& args, const char* name);
/// Returns a member of an object as text; empty if it is missing or not text.
[[nodiscard]] std::string text_member(const Json& object, const char* name);

/// A client's question about a step. It is valid if `problem` is `none`.
struct StepRequest {
    std::uint8_t command = 0;
    std::optional<std::uint64_t> sequence;
    gate::Reason problem = gate::Reason::none;
    std::string text;  ///< message about the problem
};
/// Reads {direction, sequence?} or [direction, sequence?].
[[nodiscard]] StepRequest read_step_request(const Json& args);

/// Reads the argument `radius_m`, a number in m.
[[nodiscard]] Result<double> read_radius(const Json& args);

/// Reads a geometry_msgs/PoseStamped: position and unit quaternion (only its yaw is used). Leaves
/// `connection` to the caller.
[[nodiscard]] Result<GoalQuestion> read_goal(const Json& message);

}  // namespace surefoot::gate_process
