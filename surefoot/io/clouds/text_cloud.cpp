// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/clouds/text_cloud.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/io/file.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

constexpr std::size_t kMaxColumns = 256;
constexpr double kExact = 9007199254740992.0;  // 2^53

/// Returns true if the word is a whole number that a double may not hold exactly.
bool is_long_number(std::string_view word) {
    constexpr std::size_t kDigits = 16;
    if (word.size() < kDigits || word.find_first_of(".eE") != word.npos) return false;
    const auto value = parse_double(word);
    return value && std::abs(*value) >= kExact;
}

/// Returns the names of the columns after x, y and z in a Leica or potree .pts file, which has no
/// header.
std::vector<std::string> pts_names(std::size_t further) {
    if (further == 1) return {"intensity"};
    if (further == 3) return {"r", "g", "b"};
    if (further == 4) return {"intensity", "r", "g", "b"};
    return {};
}

bool is_metre(const std::string& unit) {
    return unit.empty() || unit == "m" || unit == "metre" || unit == "metres" || unit == "meter" ||
           unit == "meters";
}

}  // namespace

Result<PointCloud> TextCloudParser::parse(std::string_view text) {
    PointCloud cloud;
    cloud.double_precision = true;
    cloud.scalars = scalars_;
    LineReader lines(text);
    const int before = line_;
    const auto at_line = [&](const std::string& what) {
        return input_error(fmt::format("{}:{}: {}", file_, std::max(1, line_), what));
    };
    if (before == 0) {
        if (const auto problem = encoding_problem(text)) return at_line(*problem);
    }
    while (const auto line = lines.next()) {
        line_ = before + lines.number();
        const std::string_view content = trimmed(*line);
        if (content.empty()) continue;
        if (Status status = take_line(content, cloud); !status)
            return at_line(status.error().message);
    }
    cloud.width = static_cast<int>(cloud.points_m.size());
    return cloud;
}

Status TextCloudParser::finish() const {
    if (announced_.value_or(0) > points_) {
        return input_error(
            fmt::format("{}: the file announces {} points, but has only {}; copy the file again",
                        file_,
                        *announced_,
                        points_));
    }
    if (points_ > 0) return {};
    return input_error(fmt::format("{}: no points; expected lines of 'x y z'", file_));
}

std::vector<std::string> TextCloudParser::notes() const {
    if (rounded_ == 0) return {};
    return {
        fmt::format("{} whole numbers beyond 2^53 are rounded, because the first value of their "
                    "column is smaller",
                    rounded_)};
}

Status TextCloudParser::take_line(std::string_view content, PointCloud& cloud) {
    if (is_comment(content)) return take_head(content, true);
    split_fields(content, columns_ == 0 ? separator_of(content) : separator_, fields_);
    if (fields_.size() == 1 && parse_int64(fields_[0])) return take_count();
    const bool numbers = std::any_of(fields_.begin(), fields_.end(), [](std::string_view field) {
        return parse_value(field) || has_decimal_comma(field);
    });
    const bool words = std::any_of(
        fields_.begin(), fields_.end(), [](std::string_view field) { return !field.empty(); });
    if (!numbers && words && fields_.size() >= 3) return take_head(content, false);
    if (const auto problem = separator_problem(content)) return input_error(*problem);
    if (columns_ == 0) {
        if (Status status = choose_columns(content); !status) return status;
        cloud.scalars = scalars_;
    }
    return take_point(cloud);
}

/// Handles a line that may name the columns. After the first point the line must name the same
/// columns, because files can be concatenated. A comment without x, y and z, or with another number
/// of columns after the first point, is only a comment.
Status TextCloudParser::take_head(std::string_view content, bool comment) {
    const std::vector<Column> columns = columns_of(content, separator_of(content));
    const auto axes = axes_of(columns);
    if (!axes && comment) return {};
    if (!axes) {
        return input_error(
            fmt::format("the header line begins with {} but does not name x, y and z once each: "
                        "name them, or remove the line",
                        quoted(columns.empty() ? content : columns.front().name)));
    }
    if (columns_ != 0) {
        const bool same = head_ && head_->line == content;
        if (same || (!head_ && *axes == axes_)) return {};
        if (comment && head_ && columns.size() != columns_) return {};
        return input_error("the columns change here; put each part into a separate file");
    }
    for (const std::size_t axis : *axes) {
        if (is_metre(columns[axis].unit)) continue;
        return input_error(fmt::format(
            "the column {} is in {}, but clouds are read in metres: convert the column to metres",
            quoted(columns[axis].name),
            quoted(columns[axis].unit)));
    }
    head_ = Head{columns, std::string(content), line_, comment};
    return {};
}

/// Handles a line with a single number: the count of the points that follow.
Status TextCloudParser::take_count() {
    const auto count = parse_int64(fields_[0]);
    if (*count < 0 || announced_.value_or(0) > points_ || (columns_ != 0 && !announced_)) {
        return input_error(fmt::format("the line has 1 number, but {} are expected",
                                       columns_ == 0 ? "x y z" : std::to_string(columns_)));
    }
    constexpr std::int64_t kMost = std::int64_t{1} << 60;
    announced_ = std::min(*count, kMost) + points_;
    return {};
}

Status TextCloudParser::choose_columns(std::string_view content) {
    separator_ = separator_of(content);
    // With tabs a field may be empty, if the header gives the number of columns.
    if (separator_ == ' ' && head_ && content.find('\t') != content.npos &&
        head_->line.find('\t') != std::string::npos) {
        std::vector<std::string_view> names;
        split_fields(head_->line, '\t', names);
        std::vector<std::string_view> fields;
        split_fields(content, '\t', fields);
        if (names.size() == fields.size()) {
            separator_ = '\t';
            fields_ = std::move(fields);
        }
    }
    if (head_ && fields_.size() == head_->columns.size() + 1 && fields_.back().empty())
        fields_.pop_back();
    if (fields_.size() < 3) {
        return input_error(fmt::format("the line has {} numbers, but a point needs at least x y z",
                                       fields_.size()));
    }
    if (fields_.size() > kMaxColumns) {
        return input_error(fmt::format(
            "the line has {} columns; at most {} are supported", fields_.size(), kMaxColumns));
    }
    columns_ = fields_.size();
    if (Status status = name_columns(); !status) {
        columns_ = 0;
        return status;
    }
    return {};
}

Status TextCloudParser::name_columns() {
    std::vector<std::string> names;
    if (head_) {
        const std::array<std::size_t, 3> axes = *axes_of(head_->columns);
        const bool fits = head_->columns.size() == columns_;
        const bool in_order = axes[0] < axes[1] && axes[1] < axes[2];
        const bool first = axes == std::array<std::size_t, 3>{0, 1, 2};
        // A name of two words counts as two columns. This does no harm if x y z come first or are
        // the only columns.
        if (!fits && !first && !(in_order && columns_ == 3)) {
            return input_error(fmt::format(
                "the line has {} numbers, but line {} names {} columns. Name each column with one "
                "word, or remove the line with the names if x y z come first",
                columns_,
                head_->number,
                head_->columns.size()));
        }
        if (fits) axes_ = axes;
        if (fits || first)
            for (const Column& column : head_->columns) names.push_back(column.name);
    } else if (extension_of(file_) == ".pts") {
        names = {"x", "y", "z"};
        for (std::string& name : pts_names(columns_ - 3)) names.push_back(std::move(name));
    }
    name_scalars(names);
    return {};
}

void TextCloudParser::name_scalars(const std::vector<std::string>& names) {
    scalars_.clear();
    for (std::size_t i = 0; i < columns_; ++i) {
        if (std::find(axes_.begin(), axes_.end(), i) != axes_.end()) continue;
        ScalarValues values = std::vector<double>();
        if (is_long_number(fields_[i])) values = std::vector<std::int64_t>();
        const bool named = i < names.size() && !names[i].empty();
        scalars_.push_back({named ? names[i] : fmt::format("column{}", i + 1), values});
    }
}

Status TextCloudParser::take_point(PointCloud& cloud) {
    if (fields_.size() == columns_ + 1 && fields_.back().empty()) fields_.pop_back();
    if (fields_.size() != columns_) {
        return input_error(fmt::format(
            "the line has {} numbers, but the first point has {}", fields_.size(), columns_));
    }
    Eigen::Vector3d point_m;
    for (int axis = 0; axis < 3; ++axis) {
        const std::string_view word = fields_[axes_[static_cast<std::size_t>(axis)]];
        const auto value = word.empty() ? std::optional(std::nan("")) : parse_value(word);
        if (!value) return input_error(why_no_number(word));
        point_m[axis] = *value;
    }
    std::size_t next = 0;
    for (std::size_t i = 0; i < columns_; ++i) {
        if (std::find(axes_.begin(), axes_.end(), i) != axes_.end()) continue;
        if (Status status = take_scalar(fields_[i], cloud.scalars[next++]); !status) return status;
    }
    cloud.points_m.push_back(point_m);
    ++points_;
    return {};
}

Status TextCloudParser::take_scalar(std::string_view word, CloudScalar& scalar) {
    if (word.empty() ? scalar.add(std::nan("")) : scalar.add(word)) {
        if (is_long_number(word) && std::holds_alternative<std::vector<double>>(scalar.values))
            ++rounded_;
        return {};
    }
    if (parse_value(word)) {
        return input_error(
            fmt::format("{} in the column {} is not a whole number of 64 bits, but the first value "
                        "of the column is such a number",
                        quoted(word),
                        quoted(scalar.name)));
    }
    return input_error(why_no_number(word));
}

Result<PointCloud> parse_text_cloud(std::string_view text, const std::string& file) {
    TextCloudParser parser(file);
    Result<PointCloud> cloud = parser.parse(text);
    if (!cloud) return cloud;
    if (Status status = parser.finish(); !status) return status.error();
    cloud->notes = parser.notes();
    return cloud;
}

std::string format_text_cloud(const PointCloud& cloud) {
    std::string out = "//X Y Z";
    if (!cloud.colours.empty()) out += " R G B";
    for (const CloudScalar& scalar : cloud.scalars) out += " " + one_word(scalar.name);
    out += "\n";
    for (std::size_t i = 0; i < cloud.points_m.size(); ++i) {
        const Eigen::Vector3d& p = cloud.points_m[i];
        out += fmt::format("{} {} {}", p.x(), p.y(), p.z());
        if (!cloud.colours.empty()) {
            const Rgb& c = cloud.colours[i];
            out += fmt::format(" {} {} {}", c.r, c.g, c.b);
        }
        for (const CloudScalar& scalar : cloud.scalars)
            std::visit([&](const auto& v) { out += fmt::format(" {}", v[i]); }, scalar.values);
        out += "\n";
    }
    return out;
}

Status write_text_cloud(const std::string& path, const PointCloud& cloud) {
    if (const auto problem = cloud.problem()) return output_error(path + ": " + *problem);
    return write_file(path, format_text_cloud(cloud));
}

}  // namespace surefoot::io
