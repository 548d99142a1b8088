// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/page/foxglove_messages.hpp"

namespace surefoot::page {

/// Returns the name of the schema of a channel, for example "foxglove.Grid".
[[nodiscard]] const char* schema_name_of(FoxgloveChannel channel) noexcept;

/// Returns the JSON schema of the payload of a channel. Clients build tables from the schema. So
/// each property and each array element has one plain type, and each object lists its
/// properties. Values that may be null, and lists of lists, are in the payload but not in the
/// schema.
[[nodiscard]] std::string schema_of(FoxgloveChannel channel);

}  // namespace surefoot::page
