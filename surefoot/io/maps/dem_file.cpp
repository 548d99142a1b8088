// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/maps/dem_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "surefoot/core/height_limit.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/maps/height_rules.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

constexpr double kNoData = -9999.0;
constexpr double kFinest_m = 1e-4;  ///< smallest side of a cell; `surefoot dem` has the same limit
constexpr double kCoarsest_m = 1000.0;
constexpr double kFarthest_m = 1e9;  ///< largest coordinate; a double resolves 1 um there
constexpr std::int64_t kMaxSide = 1 << 20;
/// Values of at least this magnitude mean "no data". One common mark is the lowest float,
/// -3.4028235e38. No layer has measured values of this size.
constexpr double kMaxValue = 1e30;

bool is_cell_size(double side_m) {
    return side_m >= kFinest_m && side_m <= kCoarsest_m;  // false for NaN
}
/// Relative precision of a float. Writers print "no data" marks from floats, with 7 to 17 digits.
constexpr double kFloatStep = 1.1920928955078125e-07;

/// Returns true if a value means "no data".
bool is_no_data(double value, double no_data) {
    return std::abs(value) >= kMaxValue ||
           std::abs(value - no_data) <= kFloatStep * std::abs(no_data);
}

struct Header {
    std::optional<double> columns, rows, x, y, cell, dx, dy;
    double no_data = kNoData;
    bool x_is_center = false;
    bool y_is_center = false;
};

/// Stores the value of a header key; returns false if the key is unknown.
bool take_pair(const std::string& key, double value, Header& header) {
    if (key == "ncols") {
        header.columns = value;
    } else if (key == "nrows") {
        header.rows = value;
    } else if (key == "xllcorner" || key == "xllcenter") {
        header.x = value;
        header.x_is_center = key == "xllcenter";
    } else if (key == "yllcorner" || key == "yllcenter") {
        header.y = value;
        header.y_is_center = key == "yllcenter";
    } else if (key == "cellsize") {
        header.cell = value;
    } else if (key == "dx") {
        header.dx = value;
    } else if (key == "dy") {
        header.dy = value;
    } else if (key == "nodata_value") {
        header.no_data = value;
    } else {
        return false;
    }
    return true;
}

Error at_line(const std::string& file, int line, const std::string& what) {
    return input_error(fmt::format("{}:{}: {}", file, line, what));
}

/// Returns the number of the line in which `word` begins. `word` is a part of `text`.
int line_of(std::string_view text, std::string_view word) {
    LineReader lines(text);
    while (const auto line = lines.next())
        if (word.data() <= line->data() + line->size()) break;
    return lines.number();
}

/// Reads "key value" lines until a line begins with a number. `body` gets the rest of the text.
Result<Header> parse_header(std::string_view text,
                            const std::string& file,
                            std::string_view& body) {
    if (const auto problem = encoding_problem(text)) return at_line(file, 1, *problem);
    Header header;
    LineReader lines(text);
    body = lines.rest();
    while (const auto line = lines.next()) {
        const std::vector<std::string_view> words = split(*line);
        if (!words.empty() && parse_value(words[0])) break;
        body = lines.rest();
        if (words.empty()) continue;
        if (has_decimal_comma(words[0]))
            return at_line(file, lines.number(), why_no_number(words[0]));
        if (words.size() != 2)
            return at_line(file, lines.number(), "expected 'key value' of an ESRI grid");
        const auto value = parse_value(words[1]);
        if (!value) return at_line(file, lines.number(), why_no_number(words[1]));
        if (!take_pair(lowercase(words[0]), *value, header)) {
            return at_line(
                file,
                lines.number(),
                fmt::format("unknown key {} of an ESRI grid; known keys: ncols, nrows, xllcorner, "
                            "xllcenter, yllcorner, yllcenter, cellsize, dx, dy, NODATA_value",
                            quoted(words[0])));
        }
    }
    return header;
}

/// Sets the cell size from dx and dy, which must be equal. Does nothing if the header has cellsize.
Status take_cell_size(Header& header, const std::string& file) {
    constexpr double kSame = 1e-9;
    if (header.cell || (!header.dx && !header.dy)) return {};
    if (header.dx && header.dy && std::abs(*header.dx - *header.dy) <= kSame * *header.dx) {
        header.cell = header.dx;
        return {};
    }
    return input_error(fmt::format("{}: cells must be square: dx {} and dy {} must be equal",
                                   file,
                                   header.dx ? format_double(*header.dx) : "(missing)",
                                   header.dy ? format_double(*header.dy) : "(missing)"));
}

Result<grid::GridGeometry> geometry_of(const Header& header, const std::string& file) {
    const struct {
        const char* name;
        const std::optional<double>& value;
    } needed[] = {{"ncols", header.columns},
                  {"nrows", header.rows},
                  {"xllcorner", header.x},
                  {"yllcorner", header.y},
                  {"cellsize", header.cell}};
    for (const auto& [name, value] : needed) {
        if (!value) return input_error(fmt::format("{}: the ESRI grid has no '{}'", file, name));
        if (!std::isfinite(*value)) {
            return input_error(fmt::format("{}: {} = {} must be finite", file, name, *value));
        }
    }
    if (!is_cell_size(*header.cell)) {
        return input_error(fmt::format("{}: cellsize {} must be from {:g} to {:g} m",
                                       file,
                                       *header.cell,
                                       kFinest_m,
                                       kCoarsest_m));
    }
    for (const auto& [name, value] : {needed[2], needed[3]}) {
        if (std::abs(*value) > kFarthest_m) {
            return input_error(fmt::format(
                "{}: {} = {:g} m: at most {:g} m are possible", file, name, *value, kFarthest_m));
        }
    }
    for (const auto& [name, value] : {needed[0], needed[1]}) {
        if (!(*value >= 1.0 && *value <= static_cast<double>(kMaxSide)) ||
            *value != std::floor(*value)) {
            return input_error(fmt::format(
                "{}: {} = {} must be a whole number 1 .. {}", file, name, *value, kMaxSide));
        }
    }
    grid::GridGeometry geometry;
    geometry.resolution_m = *header.cell;
    geometry.nx = static_cast<int>(*header.columns);
    geometry.ny = static_cast<int>(*header.rows);
    geometry.origin_m.x() = *header.x - (header.x_is_center ? 0.5 * *header.cell : 0.0);
    geometry.origin_m.y() = *header.y - (header.y_is_center ? 0.5 * *header.cell : 0.0);
    return geometry;
}

Status check_layer(const std::string& path,
                   const grid::GridGeometry& geometry,
                   const grid::Layer& values) {
    if (values.width() == geometry.nx && values.height() == geometry.ny && !values.empty())
        return {};
    return output_error(
        fmt::format("{}: a layer of {} x {} cells does not fit a grid of {} x {} cells",
                    path,
                    values.width(),
                    values.height(),
                    geometry.nx,
                    geometry.ny));
}

/// Formats a value with nine digits, or NODATA for an unknown cell.
std::string format_cell(float cell) {
    const auto value = static_cast<double>(cell);
    if (!(std::abs(value) < kMaxValue)) return fmt::format("{}", kNoData);
    // Move a value that would be read as NODATA by two float steps, which is 2 mm at 10 km.
    return fmt::format(
        "{:.9g}",
        is_no_data(value, kNoData) ? static_cast<float>((1.0 - 2.0 * kFloatStep) * kNoData) : cell);
}

template <typename Pixel>
Dem dem_from_image(const Image<Pixel>& image, double scale_m, double full_height_m) {
    Dem dem;
    dem.geometry.resolution_m = scale_m;
    dem.geometry.nx = image.width();
    dem.geometry.ny = image.height();
    dem.values = grid::Layer(image.width(), image.height());
    const double unit_m = full_height_m / static_cast<double>(std::numeric_limits<Pixel>::max());
    for (int v = 0; v < image.height(); ++v) {
        float* out = dem.values.row(image.height() - 1 - v);
        for (int u = 0; u < image.width(); ++u) {
            out[u] = static_cast<float>(unit_m * static_cast<double>(image.row(v)[u]));
        }
    }
    dem.notes = drop_impossible_heights(dem.values);
    return dem;
}

}  // namespace

Result<Dem> parse_esri_grid(std::string_view text, const std::string& file) {
    std::string_view body;
    Result<Header> header = parse_header(text, file, body);
    if (!header) return header.error();
    if (Status status = take_cell_size(*header, file); !status) return status.error();
    const Result<grid::GridGeometry> geometry = geometry_of(*header, file);
    if (!geometry) return geometry.error();
    const std::int64_t cells = std::int64_t{geometry->nx} * geometry->ny;
    // Each value needs at least a digit and a blank. A damaged header must not allocate memory.
    if (cells > static_cast<std::int64_t>(body.size() + 1) / 2) {
        return input_error(fmt::format(
            "{}: truncated ESRI grid: {} x {} cells do not fit in {} bytes; copy the file again",
            file,
            geometry->nx,
            geometry->ny,
            body.size()));
    }
    Dem dem{*geometry, grid::Layer(geometry->nx, geometry->ny, kNanF), {}};
    WordReader words(body);
    for (int row = 0; row < geometry->ny; ++row) {
        float* out = dem.values.row(geometry->ny - 1 - row);
        for (int ix = 0; ix < geometry->nx; ++ix) {
            const std::string_view word = words.next();
            const auto value = parse_value(word);
            if (!value || std::isinf(*value)) {
                return input_error(fmt::format(
                    "{}:{}: cannot read value {} of row {} (of {} x {} cells): {}",
                    file,
                    word.empty() ? line_of(text, text.substr(text.size())) : line_of(text, word),
                    ix + 1,
                    row + 1,
                    geometry->nx,
                    geometry->ny,
                    word.empty()              ? "missing"
                    : has_decimal_comma(word) ? why_no_number(word)
                                              : quoted(word)));
            }
            if (!is_no_data(*value, header->no_data)) out[ix] = static_cast<float>(*value);
        }
    }
    if (const std::string_view extra = words.next(); !extra.empty()) {
        return input_error(
            fmt::format("{}: found {} after the {} x {} cells; correct ncols and nrows, or remove "
                        "the extra values",
                        file,
                        quoted(extra),
                        geometry->nx,
                        geometry->ny));
    }
    return dem;
}

Result<Dem> read_esri_grid(const std::string& path) {
    const Result<std::string> text = read_file(path, limits::kMapBytes);
    if (!text) return text.error();
    return parse_esri_grid(*text, path);
}

Result<Dem> parse_height_grid(std::string_view text, const std::string& file) {
    Result<Dem> dem = parse_esri_grid(text, file);
    if (dem) dem->notes = drop_impossible_heights(dem->values);
    return dem;
}

Result<Dem> read_height_grid(const std::string& path) {
    const Result<std::string> text = read_file(path);
    if (!text) return text.error();
    return parse_height_grid(*text, path);
}

std::string format_esri_grid(const grid::GridGeometry& geometry, const grid::Layer& values) {
    std::string out = fmt::format(
        "ncols {}\nnrows {}\nxllcorner {}\nyllcorner {}\ncellsize {}\nNODATA_value {}\n",
        geometry.nx,
        geometry.ny,
        geometry.origin_m.x(),
        geometry.origin_m.y(),
        geometry.resolution_m,
        kNoData);
    for (int iy = values.height() - 1; iy >= 0; --iy) {
        for (int ix = 0; ix < values.width(); ++ix) {
            out += format_cell(values.row(iy)[ix]);
            out += ix + 1 < values.width() ? ' ' : '\n';
        }
    }
    return out;
}

Status write_esri_grid(const std::string& path,
                       const grid::GridGeometry& geometry,
                       const grid::Layer& values) {
    if (Status status = check_layer(path, geometry, values); !status) return status;
    return write_file(path, format_esri_grid(geometry, values));
}

Result<Dem> parse_dem_image(std::string_view bytes,
                            const std::string& file,
                            double scale_m,
                            double full_height_m) {
    if (!is_cell_size(scale_m) || !std::isfinite(full_height_m)) {
        return usage_error(
            fmt::format("{}: a height image needs a scale of {:g} to {:g} m per pixel (is {}) "
                        "and a finite full height (is {} m)",
                        file,
                        kFinest_m,
                        kCoarsest_m,
                        scale_m,
                        full_height_m));
    }
    if (std::abs(full_height_m) > kMaxHeight_m) {
        return usage_error(
            fmt::format("{}: the full height of {} m exceeds {:g} m: give it in metres",
                        file,
                        full_height_m,
                        kMaxHeight_m));
    }
    const Result<ImageHeader> header = check_image(bytes, file);
    if (!header) return header.error();
    if (header->bits == 16) {
        const Result<DepthCodes> image = parse_depth_codes(bytes, file);
        if (!image) return image.error();
        return dem_from_image(*image, scale_m, full_height_m);
    }
    const Result<GreyImage> image = parse_grey_image(bytes, file);
    if (!image) return image.error();
    return dem_from_image(*image, scale_m, full_height_m);
}

Result<Dem> read_dem_image(const std::string& path, double scale_m, double full_height_m) {
    const Result<std::string> bytes = read_file(path, limits::kImageBytes);
    if (!bytes) return bytes.error();
    return parse_dem_image(*bytes, path, scale_m, full_height_m);
}

}  // namespace surefoot::io
