// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/arguments.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace surefoot::gate_process {
namespace {

const Json* member(const Json& object, const char* name) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(name);
    return found == object.end() ? nullptr : &*found;
}

/// Returns a JSON integer from `least` to `most`, or nothing.
std::optional<std::uint64_t> whole_number(const Json& value,
                                          std::uint64_t least,
                                          std::uint64_t most) {
    if (!value.is_number_unsigned()) return std::nullopt;
    const auto number = value.get<std::uint64_t>();
    if (number < least || number > most) return std::nullopt;
    return number;
}

/// Returns the number with that name, or NaN.
double number_member(const Json& object, const char* name) {
    const Json* value = member(object, name);
    if (value == nullptr || !value->is_number()) return std::nan("");
    return value->get<double>();
}

StepRequest refuse(StepRequest request, gate::Reason problem, std::string text) {
    request.problem = problem;
    request.text = std::move(text);
    return request;
}

}  // namespace

const Json* argument(const Json& args, const char* name, std::size_t place) {
    if (args.is_array()) return place < args.size() ? &args[place] : nullptr;
    return member(args, name);
}

std::string text_argument(const Json& args, const char* name) {
    const Json* value = argument(args, name, 0);
    return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

std::string text_member(const Json& object, const char* name) {
    const Json* value = member(object, name);
    return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

StepRequest read_step_request(const Json& args) {
    constexpr std::uint64_t kMaxCommand = 255;
    StepRequest request;
    if (const Json* sequence = argument(args, "sequence", 1)) {
        request.sequence = whole_number(*sequence, 1, kMaxExact);
        if (!request.sequence)
            return refuse(
                request, gate::Reason::bad_number, "sequence: give a whole number of at least 1");
    }
    const Json* direction = argument(args, "direction", 0);
    if (direction == nullptr)
        return refuse(request, gate::Reason::bad_message, "the argument direction is missing");
    const auto command = whole_number(*direction, 0, kMaxCommand);
    if (!command)
        return refuse(
            request, gate::Reason::bad_number, "direction: give a whole number from 0 to 255");
    request.command = static_cast<std::uint8_t>(*command);
    return request;
}

Result<double> read_radius(const Json& args) {
    const Json* value = argument(args, "radius_m", 0);
    if (value == nullptr || !value->is_number())
        return input_error("radius_m: give the radius as a number, in m");
    return value->get<double>();
}

Result<GoalQuestion> read_goal(const Json& message) {
    constexpr double kUnitTolerance = 0.01;  // of |q|^2: clients send quaternions as floats
    const Json* header = member(message, "header");
    const Json* pose = member(message, "pose");
    const Json* position = pose == nullptr ? nullptr : member(*pose, "position");
    const Json* rotation = pose == nullptr ? nullptr : member(*pose, "orientation");
    if (header == nullptr || position == nullptr || rotation == nullptr)
        return input_error("goal: header, pose.position and pose.orientation are needed");
    GoalQuestion goal;
    goal.frame_id = text_member(*header, "frame_id");
    goal.x_m = number_member(*position, "x");
    goal.y_m = number_member(*position, "y");
    const double z_m = number_member(*position, "z");
    const double x = number_member(*rotation, "x");
    const double y = number_member(*rotation, "y");
    const double z = number_member(*rotation, "z");
    const double w = number_member(*rotation, "w");
    const double norm_sq = x * x + y * y + z * z + w * w;
    if (!std::isfinite(goal.x_m) || !std::isfinite(goal.y_m) || !std::isfinite(z_m))
        return input_error("goal: a coordinate of pose.position is not a finite number");
    if (!(std::abs(norm_sq - 1.0) <= kUnitTolerance))  // NaN included
        return input_error("goal: pose.orientation is not a unit quaternion");
    goal.yaw_rad = std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
    return goal;
}

}  // namespace surefoot::gate_process
