// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "io/file.hpp"
#include "io/point_cloud.hpp"
#include "io/text.hpp"

namespace surefoot::io {
namespace {

constexpr std::string_view kSeparators = " \t,;";

/// Names of the columns after "X Y Z" in a comment head, or none.
std::vector<std::string> names_in_head(std::string_view line) {
    while (!line.empty() && (line[0] == '/' || line[0] == '#')) line.remove_prefix(1);
    const std::vector<std::string_view> words = split(line, kSeparators);
    if (words.size() < 3 || lowercase(words[0]) != "x" || lowercase(words[1]) != "y" ||
        lowercase(words[2]) != "z") {
        return {};
    }
    return {words.begin() + 3, words.end()};
}

bool is_comment(std::string_view line) {
    return line.starts_with("#") || line.starts_with("//");
}

}  // namespace

Result<PointCloud> parse_text_cloud(std::string_view text, const std::string& file) {
    constexpr std::size_t kMaxColumns = 256;
    PointCloud cloud;
    std::vector<std::string> names;
    std::size_t columns = 0;
    LineReader lines(text);
    while (const auto line = lines.next()) {
        const std::string_view content = trimmed(*line);
        if (content.empty()) continue;
        if (is_comment(content)) {
            if (columns == 0) names = names_in_head(content);
            continue;
        }
        const std::vector<std::string_view> words = split(content, kSeparators);
        if (columns == 0) {
            columns = words.size();
            for (std::size_t i = 3; i < columns; ++i) {
                cloud.scalars.push_back(
                    {i - 3 < names.size() ? names[i - 3] : fmt::format("column{}", i + 1), {}});
            }
        }
        if (words.size() != columns || columns < 3 || columns > kMaxColumns) {
            return input_error(
                fmt::format("{}:{}: {} numbers where {} are expected",
                            file,
                            lines.number(),
                            words.size(),
                            columns < 3 ? std::string("x y z") : std::to_string(columns)));
        }
        Eigen::Vector3d point_m;
        for (std::size_t i = 0; i < columns; ++i) {
            const auto value = parse_double(words[i]);
            if (!value) {
                return input_error(fmt::format(
                    "{}:{}: {} is not a number", file, lines.number(), quoted(words[i])));
            }
            if (i < 3) {
                point_m[static_cast<Eigen::Index>(i)] = *value;
            } else {
                cloud.scalars[i - 3].values.push_back(static_cast<float>(*value));
            }
        }
        cloud.points_m.push_back(point_m);
    }
    if (cloud.points_m.empty()) {
        return input_error(fmt::format("{}: no points; expected lines of 'x y z'", file));
    }
    cloud.width = static_cast<int>(cloud.points_m.size());
    return cloud;
}

std::string format_text_cloud(const PointCloud& cloud) {
    std::string out = "//X Y Z";
    for (const CloudScalar& scalar : cloud.scalars) out += " " + one_word(scalar.name);
    out += "\n";
    for (std::size_t i = 0; i < cloud.points_m.size(); ++i) {
        const Eigen::Vector3d& p = cloud.points_m[i];
        out += fmt::format("{} {} {}", p.x(), p.y(), p.z());
        for (const CloudScalar& scalar : cloud.scalars) out += fmt::format(" {}", scalar.values[i]);
        out += "\n";
    }
    return out;
}

Status write_text_cloud(const std::string& path, const PointCloud& cloud) {
    if (const auto problem = cloud.problem()) return output_error(path + ": " + *problem);
    return write_file(path, format_text_cloud(cloud));
}

}  // namespace surefoot::io
