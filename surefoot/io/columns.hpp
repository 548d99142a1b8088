// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Tables in text files: what separates the fields of a line, and columns that have names.
namespace surefoot::io {

/// What separates the fields of a line: ';' where there is one, else ',' where there is one, else
/// ' ' (white space, any number of characters).
[[nodiscard]] char separator_of(std::string_view line) noexcept;

/// The fields of a line, without white space and quotes around them. Fields between two ';', ',' or
/// a tab may be empty; with ' ' none is.
void split_fields(std::string_view line, char separator, std::vector<std::string_view>& out);

/// Why no separator can be told: commas and blanks both stand between numbers, as with decimal
/// commas ("0,5 1,5 2,5"). Nothing where it can.
[[nodiscard]] std::optional<std::string> separator_problem(std::string_view line);

/// Does the line begin with '#' or "//"?
[[nodiscard]] bool is_comment(std::string_view line) noexcept;

/// One column of a head line.
struct Column {
    std::string name;  ///< as written, without quotes
    std::string key;   ///< in lower case, without its unit
    std::string unit;  ///< "m" of "x [m]" and of "x(m)"; empty where there is none
};

/// The columns that a line names, which may be a comment.
[[nodiscard]] std::vector<Column> columns_of(std::string_view line, char separator);

/// 0, 1 or 2 for a column that holds x, y or z (also "x_m"; "points:0" and "points_0" of ParaView).
[[nodiscard]] std::optional<int> axis_named(std::string_view key) noexcept;

/// Where x, y and z are; nothing unless each is there exactly once.
[[nodiscard]] std::optional<std::array<std::size_t, 3>> axes_of(const std::vector<Column>& columns);

}  // namespace surefoot::io
