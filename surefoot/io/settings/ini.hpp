// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "surefoot/core/result.hpp"

namespace surefoot::io {

/// Contents of an INI file: [section] lines and key = value lines. Names are stored in lower case.
/// Comments begin with ';' or '#'.
struct IniFile {
    struct Value {
        std::string text;
        int line = 0;
    };
    using Section = std::map<std::string, Value>;

    std::string name;  ///< file name for messages
    std::map<std::string, Section> sections;

    /// Returns the section; nullptr if the file has no such section.
    [[nodiscard]] const Section* find(std::string_view section) const;
    /// Returns the value; nullptr if the section has no such key.
    [[nodiscard]] const Value* find(std::string_view section, std::string_view key) const;
    /// Returns a required finite number. A number with a comma, such as "0,5" from another locale,
    /// is an error with its own message.
    [[nodiscard]] Result<double> number(std::string_view section, std::string_view key) const;
};

/// Fails on a repeated key or section, an unreadable line, or more than 1 MB of text.
[[nodiscard]] Result<IniFile> parse_ini(std::string_view text, const std::string& file);

}  // namespace surefoot::io
