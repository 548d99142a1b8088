// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Reads tables in text files: separators and named columns.
namespace surefoot::io {

/// Returns the separator of the fields of a line: ';' if the line has a ';', otherwise ',' if the
/// line has a ','. Otherwise returns ' ', which means white space of any length.
[[nodiscard]] char separator_of(std::string_view line) noexcept;

/// Splits a line into fields without surrounding white space and quotes. Fields between two ';',
/// ',' or tabs may be empty; with ' ' no field is empty.
void split_fields(std::string_view line, char separator, std::vector<std::string_view>& out);

/// Explains why the separator is ambiguous: commas and blanks both stand between numbers, as with
/// decimal commas ("0,5 1,5 2,5"). No value if the separator is clear.
[[nodiscard]] std::optional<std::string> separator_problem(std::string_view line);

/// Returns true if the line begins with '#' or "//".
[[nodiscard]] bool is_comment(std::string_view line) noexcept;

/// One column of a header line.
struct Column {
    std::string name;  ///< name as written, without quotes
    std::string key;   ///< name in lower case, without its unit
    std::string unit;  ///< unit: "m" of "x [m]" or "x(m)"; may be empty
};

/// Returns the columns that a header line names; the line may be a comment.
[[nodiscard]] std::vector<Column> columns_of(std::string_view line, char separator);

/// Returns 0, 1 or 2 for x, y or z (also "x_m", and ParaView's "points:0" and "points_0").
[[nodiscard]] std::optional<int> axis_named(std::string_view key) noexcept;

/// Returns the column numbers of x, y and z; no value unless each occurs exactly once.
[[nodiscard]] std::optional<std::array<std::size_t, 3>> axes_of(const std::vector<Column>& columns);

}  // namespace surefoot::io
