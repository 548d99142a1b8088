// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/page/foxglove_messages.hpp"

namespace surefoot::page {

/// "foxglove.Grid".
[[nodiscard]] const char* schema_name_of(FoxgloveChannel channel) noexcept;

/// The JSON schema of a channel's payload. Clients build tables from it: each property names one
/// plain type, arrays hold one plain type, objects say what is in them. What may be null, and lists
/// of lists, are in the payload, but not in its schema.
[[nodiscard]] std::string schema_of(FoxgloveChannel channel);

}  // namespace surefoot::page
