// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/step_gate.hpp"
#include "surefoot/gate/reason.hpp"

/// Foreign values into typed ones. Nothing is guessed: a number in quotes, a fraction where a whole
/// number belongs, null and true are no numbers.
namespace surefoot::gate_process {

/// 2^53 - 1: the largest whole number that every JSON reader keeps exactly.
inline constexpr std::uint64_t kMaxExact = (std::uint64_t{1} << 53U) - 1;

/// The argument of a call: a member of an object, or the place in a list (rosbridge allows both);
/// nullptr where it is missing.
[[nodiscard]] const Json* argument(const Json& args, const char* name, std::size_t place);
/// The first argument as text, or an empty one.
[[nodiscard]] std::string text_argument(const Json& args, const char* name);
/// A member of an object as text, or an empty one.
[[nodiscard]] std::string text_member(const Json& object, const char* name);

/// What a client wants to know of a step; `problem` is none when it could be read.
struct StepRequest {
    std::uint8_t command = 0;
    std::optional<std::uint64_t> sequence;
    gate::Reason problem = gate::Reason::none;
    std::string text;  ///< of the problem
};
/// {direction, sequence?} or [direction, sequence?].
[[nodiscard]] StepRequest read_step_request(const Json& args);

/// A finite number, in m.
[[nodiscard]] Result<double> read_radius(const Json& args);

/// A geometry_msgs/PoseStamped: position and a unit quaternion, of which the yaw counts. The
/// connection is left for the caller.
[[nodiscard]] Result<GoalQuestion> read_goal(const Json& message);

}  // namespace surefoot::gate_process
