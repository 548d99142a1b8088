// SPDX-License-Identifier: Apache-2.0
// Reads legacy VTK (Kitware, "VTK File Formats"). The first lines are the version, a title, ASCII
// and DATASET; sections follow. The points are the numbers after "POINTS n type".
#include <fmt/format.h>

#include "surefoot/io/clouds/point_cloud.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// Count n and text after the line "POINTS n type".
struct Points {
    std::int64_t count = 0;
    bool doubles = false;
    std::string_view text;
};

Result<Points> find_points(std::string_view bytes, const std::string& file) {
    LineReader lines(bytes);
    const auto first = lines.next();
    if (!first || !first->starts_with("# vtk DataFile Version"))
        return input_error(fmt::format(
            "{}:1: not a VTK file (its first line must begin with '# vtk DataFile Version')",
            file));
    (void)lines.next();  // the title can be any text
    const auto encoding = lines.next();
    if (!encoding || trimmed(*encoding) != "ASCII") {
        return input_error(
            fmt::format("{}:3: found {}, but only ASCII VTK files can be read; write the file as "
                        "ASCII VTK or as PLY",
                        file,
                        quoted(encoding.value_or(""))));
    }
    while (const auto line = lines.next()) {
        const std::vector<std::string_view> words = split(*line);
        if (words.empty() || words[0] != "POINTS") continue;
        const auto count = words.size() == 3 ? parse_int64(words[1]) : std::nullopt;
        if (!count || *count < 0) {
            return input_error(
                fmt::format("{}:{}: expected 'POINTS count type'", file, lines.number()));
        }
        return Points{*count, words[2] == "double", lines.rest()};
    }
    return input_error(fmt::format("{}: the VTK file has no line POINTS", file));
}

}  // namespace

Result<PointCloud> parse_vtk(std::string_view bytes, const std::string& file) {
    const auto points = find_points(bytes, file);
    if (!points) return points.error();
    // Each number takes at least two bytes. This check prevents an allocation for a damaged count.
    const auto room = static_cast<std::int64_t>((points->text.size() + 1) / 6);
    if (points->count > room) {
        return input_error(fmt::format(
            "{}: truncated or damaged VTK: {} points do not fit into {} bytes; copy the file again",
            file,
            points->count,
            points->text.size()));
    }
    PointCloud cloud;
    cloud.points_m.reserve(static_cast<std::size_t>(points->count));
    WordReader words(points->text);
    for (std::int64_t i = 0; i < points->count; ++i) {
        Eigen::Vector3d p_m;
        for (double& c_m : p_m) {
            const std::string_view word = words.next();
            const auto value = parse_value(word);
            if (!value) {
                return input_error(
                    fmt::format("{}: VTK point {} of {}: {}",
                                file,
                                i,
                                points->count,
                                word.empty() ? "the file ends here" : why_no_number(word)));
            }
            c_m = *value;
        }
        cloud.points_m.push_back(p_m);
    }
    cloud.width = static_cast<int>(points->count);
    cloud.double_precision = points->doubles;
    if (points->text.find("\nPOINT_DATA") != std::string_view::npos)
        cloud.notes.emplace_back("the values of the points (POINT_DATA) are not kept");
    return cloud;
}

}  // namespace surefoot::io
