// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace surefoot::io {

/// Returns today's name of a setting. Version 0.2 renamed some keys; files and --set may use the
/// names of version 0.1 until version 0.3. Returns `key` itself if it has no newer name.
/// docs/migration.md lists all pairs.
[[nodiscard]] std::string current_key(std::string_view key);

/// Returns the sentence that asks for the new name of a setting, an option or a key of a file.
[[nodiscard]] std::string renamed_note(std::string_view old_name, std::string_view new_name);

}  // namespace surefoot::io
