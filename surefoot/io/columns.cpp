// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/columns.hpp"

#include <algorithm>

#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

constexpr std::string_view kBlanks = " \t";

bool is_blank(char c) noexcept {
    return c == ' ' || c == '\t';
}

/// Cuts "x [m]" and "x(m)" into name and unit.
Column column_named(std::string_view name) {
    Column column{std::string(name), {}, {}};
    const std::size_t open = name.find_first_of("[(");
    const std::size_t close = name.find_last_of("])");
    std::string_view key = name;
    if (open != name.npos && close != name.npos && close > open) {
        column.unit = trimmed(name.substr(open + 1, close - open - 1));
        key = trimmed(name.substr(0, open));
    }
    column.key = lowercase(key);
    return column;
}

}  // namespace

char separator_of(std::string_view line) noexcept {
    if (line.find(';') != line.npos) return ';';
    return line.find(',') != line.npos ? ',' : ' ';
}

void split_fields(std::string_view line, char separator, std::vector<std::string_view>& out) {
    out.clear();
    line = trimmed(line);
    if (separator == ' ') {
        for (std::size_t begin = 0; begin < line.size();) {
            std::size_t end = begin;
            while (end < line.size() && !is_blank(line[end])) ++end;
            if (end > begin) out.push_back(unquoted(line.substr(begin, end - begin)));
            begin = end + 1;
        }
        return;
    }
    for (std::size_t begin = 0; begin <= line.size();) {
        const std::size_t end = std::min(line.find(separator, begin), line.size());
        out.push_back(unquoted(trimmed(line.substr(begin, end - begin))));
        begin = end + 1;
    }
}

std::optional<std::string> separator_problem(std::string_view line) {
    if (separator_of(line) != ',') return std::nullopt;
    line = trimmed(line);
    char before = ',';
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (!is_blank(line[i])) {
            before = line[i];
            continue;
        }
        const std::size_t next = line.find_first_not_of(kBlanks, i);
        if (before != ',' && line[next] != ',') {
            return "commas and blanks both separate numbers. If the commas are decimal commas, "
                   "write decimal points (1.5, not 1,5); otherwise use only one kind of separator";
        }
        i = next - 1;
    }
    return std::nullopt;
}

bool is_comment(std::string_view line) noexcept {
    return line.starts_with('#') || line.starts_with("//");
}

std::vector<Column> columns_of(std::string_view line, char separator) {
    while (!line.empty() && (line[0] == '/' || line[0] == '#')) line.remove_prefix(1);
    std::vector<std::string_view> names;
    split_fields(line, separator, names);
    std::vector<Column> columns;
    for (const std::string_view name : names) {
        // In "x [m] y [m]" with blanks as separators, the unit of a column is a separate word.
        const bool unit = separator == ' ' && name.size() > 2 && name.front() == '[';
        if (unit && !columns.empty()) {
            columns.back().unit = name.substr(1, name.find(']') - 1);
        } else {
            columns.push_back(column_named(name));
        }
    }
    return columns;
}

std::optional<int> axis_named(std::string_view key) noexcept {
    constexpr std::string_view kNames[][3] = {{"x", "y", "z"},
                                              {"x_m", "y_m", "z_m"},
                                              {"points:0", "points:1", "points:2"},
                                              {"points_0", "points_1", "points_2"}};
    for (const auto& names : kNames)
        for (int axis = 0; axis < 3; ++axis)
            if (key == names[axis]) return axis;
    return std::nullopt;
}

std::optional<std::array<std::size_t, 3>> axes_of(const std::vector<Column>& columns) {
    std::array<std::size_t, 3> at{};
    std::array<int, 3> count{};
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const auto axis = axis_named(columns[i].key);
        if (!axis) continue;
        at[static_cast<std::size_t>(*axis)] = i;
        ++count[static_cast<std::size_t>(*axis)];
    }
    if (count != std::array<int, 3>{1, 1, 1}) return std::nullopt;
    return at;
}

}  // namespace surefoot::io
