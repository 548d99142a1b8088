// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "service/gate_process/protocol/catalogue.hpp"
#include "service/gate_process/protocol/json_text.hpp"

namespace surefoot::gate_process {

/// Answers of the services of rosapi about what is in the catalogue, as roslib reads them. An
/// unknown topic or service has the type ""; an unknown parameter is {value: "null", successful:
/// false, reason}. A value of get_param is JSON within a string.
/// `service` is one of list_topics ... has_param; `args` an object, a list or null.
[[nodiscard]] Json rosapi_answer(Service service, const Json& args);

}  // namespace surefoot::gate_process
