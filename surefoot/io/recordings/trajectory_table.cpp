// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/recordings/trajectory_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

constexpr std::size_t kTumColumns = 8;
constexpr std::size_t kKittiColumns = 12;
constexpr std::size_t kEurocColumns = 17;
constexpr PosePlaces kTumPlaces = {0, 1, 2, 3, 4, 5, 6, 7};
constexpr PosePlaces kEurocPlaces = {0, 1, 2, 3, 5, 6, 7, 4};  // here the quaternion begins with w

template <std::size_t N>
bool is_one_of(std::string_view word, const std::array<std::string_view, N>& words) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// Returns the role of a column among the eight numbers of a stamped pose. The axis is the end of
/// the column name, after the prefixes of TUM, EuRoC, ROS and evo.
std::optional<std::size_t> role_of(std::string_view key) {
    constexpr std::array<std::string_view, 9> kStamps = {"t",
                                                         "time",
                                                         "stamp",
                                                         "timestamp",
                                                         "stamp_s",
                                                         "time_s",
                                                         "stamp_ns",
                                                         "time_ns",
                                                         "timestamp_ns"};
    constexpr std::array<std::string_view, 9> kPositions = {
        "", "t", "p", "t_", "p_", "pos_", "position_", "position.", "p_rs_r_"};
    constexpr std::array<std::string_view, 7> kRotations = {
        "q", "q_", "r", "quat_", "orientation_", "orientation.", "q_rs_"};
    if (is_one_of(key, kStamps)) return 0;
    const std::size_t axis =
        key.empty() ? std::string_view::npos : std::string_view("xyzw").find(key.back());
    if (axis == std::string_view::npos) return std::nullopt;
    key.remove_suffix(1);
    if (axis < 3 && is_one_of(key, kPositions)) return 1 + axis;
    return is_one_of(key, kRotations) ? std::optional(4 + axis) : std::nullopt;
}

/// Returns column numbers from a header line; no value unless each of the eight roles occurs
/// exactly once.
std::optional<PosePlaces> places_of(const std::vector<Column>& columns) {
    PosePlaces places{};
    std::array<int, 8> count{};
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const auto role = role_of(columns[i].key);
        if (!role) continue;
        places[*role] = i;
        ++count[*role];
    }
    const bool all = std::all_of(count.begin(), count.end(), [](int n) { return n == 1; });
    return all ? std::optional(places) : std::nullopt;
}

/// Returns the layout of a table without a header line.
Result<TrajectoryLayout> layout_of(const std::vector<std::string_view>& words, char separator) {
    TrajectoryLayout layout{"TUM", true, words.size(), separator, kTumPlaces, {}};
    if (words.size() == kKittiColumns) {
        layout.stamped = false;
        layout.format = "KITTI poses";
        return layout;
    }
    const bool in_ns = stamp_unit_of(std::span(words).first(1)).name == "ns";
    if (words.size() == kEurocColumns && in_ns) {
        layout.format = "EuRoC csv";
        layout.places = kEurocPlaces;
        return layout;
    }
    if (words.size() != kTumColumns) {
        return input_error(
            fmt::format("the line has {} numbers. A line of a trajectory has {} (TUM: stamp_s tx "
                        "ty tz qx qy qz qw), {} (KITTI: 3x4 matrices) or {} (ground truth of "
                        "EuRoC). For other files add a header line with the names of the columns",
                        words.size(),
                        kTumColumns,
                        kKittiColumns,
                        kEurocColumns));
    }
    if (separator == ',' && in_ns) {
        return input_error(
            "8 numbers with commas and a stamp in ns, but no header line: is the quaternion "
            "qw,qx,qy,qz (EuRoC) or qx,qy,qz,qw (TUM)? Add a first line with the names, for "
            "example '#timestamp [ns],px,py,pz,qw,qx,qy,qz'");
    }
    return layout;
}

}  // namespace

Result<TrajectoryTable> TrajectoryTable::read(std::string_view text, const std::string& file) {
    TrajectoryTable table;
    LineReader lines(text);
    const auto at_line = [&](const std::string& what) {
        return input_error(fmt::format("{}:{}: {}", file, std::max(1, lines.number()), what));
    };
    if (const auto problem = encoding_problem(text)) return at_line(*problem);
    while (const auto line = lines.next()) {
        const std::string_view content = trimmed(*line);
        if (content.empty()) continue;
        if (Status status = table.take_line(content, lines.number()); !status)
            return at_line(status.error().message);
    }
    return table;
}

Status TrajectoryTable::take_line(std::string_view content, int number) {
    if (is_comment(content)) {
        if (rows_.empty()) (void)take_head(content);  // or a plain comment without names
        return {};
    }
    const char separator = rows_.empty() ? separator_of(content) : layout_.separator;
    split_fields(content, separator, words_);
    if (words_.size() > 1 && words_.back().empty()) words_.pop_back();
    const bool no_number = std::none_of(words_.begin(), words_.end(), [](std::string_view word) {
        return parse_value(word) || has_decimal_comma(word);
    });
    if (no_number && content == head_line_) return {};  // repeated header in concatenated files
    if (no_number && rows_.empty()) {
        if (take_head(content)) return {};
        return input_error(
            fmt::format("the header line begins with {} but does not name a stamp, x, y, z, qx, "
                        "qy, qz and qw once each: rename the columns, or remove the line",
                        quoted(words_.front())));
    }
    if (const auto problem = separator_problem(content)) return input_error(*problem);
    if (rows_.empty()) {
        if (Status status = choose_layout(separator); !status) return status;
    }
    return take_row(number);
}

bool TrajectoryTable::take_head(std::string_view content) {
    const char separator = separator_of(content);
    const std::vector<Column> columns = columns_of(content, separator);
    const auto places = places_of(columns);
    if (!places) return false;
    const Column& stamp = columns[(*places)[0]];
    const bool tum = columns.size() == kTumColumns && *places == kTumPlaces;
    const bool euroc = columns[(*places)[1]].key == "p_rs_r_x";
    head_ = TrajectoryLayout{tum     ? "TUM"
                             : euroc ? "EuRoC csv"
                                     : "columns by name",
                             true,
                             columns.size(),
                             separator,
                             *places,
                             stamp_unit_named(stamp.key.ends_with("_ns") ? "ns" : stamp.unit)};
    head_line_ = content;
    return true;
}

Status TrajectoryTable::choose_layout(char separator) {
    if (head_ && head_->columns == words_.size()) {
        layout_ = *head_;
        layout_.separator = separator;
        return {};
    }
    if (head_ && !is_comment(head_line_)) {
        return input_error(
            fmt::format("the line has {} numbers, but the header line names {} columns",
                        words_.size(),
                        head_->columns));
    }
    auto layout = layout_of(words_, separator);
    if (!layout) return layout.error();
    layout_ = std::move(layout).value();
    return {};
}

Status TrajectoryTable::take_row(int number) {
    if (words_.size() != layout_.columns) {
        return input_error(
            fmt::format("the line has {} numbers, but needs {}", words_.size(), layout_.columns));
    }
    TrajectoryRow row;
    row.line = number;
    if (!layout_.stamped) {
        for (std::size_t i = 0; i < words_.size(); ++i)
            if (Status status = take_number(words_[i], i, row); !status) return status;
    } else {
        row.stamp = words_[layout_.places[0]];
        const auto stamp = row.stamp.empty() ? std::optional(std::nan("")) : parse_value(row.stamp);
        if (!stamp) return input_error("stamp " + why_no_number(row.stamp));
        row.finite = std::isfinite(*stamp);
        for (std::size_t i = 1; i < layout_.places.size(); ++i) {
            if (Status status = take_number(words_[layout_.places[i]], i - 1, row); !status)
                return status;
        }
    }
    rows_.push_back(row);
    return {};
}

Status TrajectoryTable::take_number(std::string_view word, std::size_t at, TrajectoryRow& row) {
    const auto value = word.empty() ? std::optional(std::nan("")) : parse_value(word);
    if (!value) return input_error(why_no_number(word));
    row.numbers[at] = *value;
    row.finite = row.finite && std::isfinite(*value);
    return {};
}

}  // namespace surefoot::io
