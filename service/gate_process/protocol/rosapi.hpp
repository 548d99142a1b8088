// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "service/gate_process/protocol/catalogue.hpp"
#include "service/gate_process/protocol/json_text.hpp"

namespace surefoot::gate_process {

/// Answers the rosapi services from the catalogue, in the format that roslib reads. An unknown
/// topic or service has the type "". An unknown parameter gives {value: "null", successful: false,
/// reason}. The value of get_param is JSON in a string. `service`: one of list_topics ...
/// has_param; `args`: an object, a list or null.
[[nodiscard]] Json rosapi_answer(Service service, const Json& args);

}  // namespace surefoot::gate_process
