// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/result.hpp"

/// Converts configuration objects to YAML and back. Works with every type that has `void
/// describe(ConfigVisitor&)`. Strict: an unknown key, a wrong type or a value out of range is a
/// usage error that names the key, and the object stays unchanged. Keys may have the names of the
/// previous version (renamed_keys.hpp); `notes`, if given, receives a sentence with the new name.
namespace surefoot::io {

/// Describes a config object to a visitor.
using DescribeConfig = std::function<void(ConfigVisitor&)>;

/// Sentences for the user about a text that was read without an error, such as an old key.
using Notes = std::vector<std::string>;

/// One key with its current value, without nesting.
struct ConfigEntry {
    std::string key;    ///< key with its groups: "elevation.length_m"
    std::string value;  ///< text that reads back to the same bits
    std::string range;  ///< allowed values: "0.1 .. 100" or "true | false"
    std::string comment;
};

[[nodiscard]] std::vector<ConfigEntry> list_config(const DescribeConfig& describe);
/// Formats every key with value, range and comment. Reading the text gives the same bits.
[[nodiscard]] std::string format_config(const DescribeConfig& describe);
/// Sets the values of a YAML text; keys that the text does not contain keep their values. Groups
/// may be nested or written with dots ("elevation.length_m: 6").
[[nodiscard]] Status parse_config(std::string_view yaml,
                                  const std::string& file,
                                  const DescribeConfig& describe,
                                  Notes* notes = nullptr);
/// Applies one override "key=value" with the same checks.
[[nodiscard]] Status override_config(std::string_view key_and_value,
                                     const DescribeConfig& describe,
                                     Notes* notes = nullptr);
/// Sets one key to a value, with the same checks. Errors name the key.
[[nodiscard]] Status change_config(const std::string& key,
                                   const std::string& value,
                                   const DescribeConfig& describe);
[[nodiscard]] Status read_config(const std::string& path,
                                 const DescribeConfig& describe,
                                 Notes* notes = nullptr);
[[nodiscard]] Status write_config(const std::string& path, const DescribeConfig& describe);

template <typename Config>
[[nodiscard]] DescribeConfig describe_config(Config& config) {
    return [&config](ConfigVisitor& visitor) { config.describe(visitor); };
}
template <typename Config>
[[nodiscard]] std::vector<ConfigEntry> list_config_of(Config config) {
    return list_config(describe_config(config));
}
template <typename Config>
[[nodiscard]] std::string format_config_of(Config config) {
    return format_config(describe_config(config));
}
template <typename Config>
[[nodiscard]] Status read_config_into(const std::string& path, Config& config) {
    return read_config(path, describe_config(config));
}
template <typename Config>
[[nodiscard]] Status write_config_of(const std::string& path, Config config) {
    return write_config(path, describe_config(config));
}

}  // namespace surefoot::io
