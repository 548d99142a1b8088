// SPDX-License-Identifier: Apache-2.0
#include "studies/clouds/cloud_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "service/console/writes.hpp"
#include "surefoot/eval/maps/dem.hpp"
#include "surefoot/eval/report/line_plot.hpp"
#include "surefoot/eval/report/picture.hpp"
#include "surefoot/io/clouds/cloud_writer.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

constexpr double kMillimetres = 1e3;

/// Returns the range of values to draw. It starts at 0, or is symmetric about 0 if the distances
/// are signed. It contains 98 % of the values.
eval::ValueRange shown(const PlacedDistances& placed) {
    std::vector<float> sizes_m;
    for (const float d_m : placed.distances_m) {
        if (!std::isnan(d_m)) sizes_m.push_back(std::abs(d_m));
    }
    constexpr double kShare = 0.98;
    constexpr double kLeast_m = 0.001;
    double high_m = kLeast_m;
    if (!sizes_m.empty()) {
        const auto at =
            // in range: kShare is below 1
            static_cast<std::ptrdiff_t>(kShare * static_cast<double>(sizes_m.size() - 1));
        std::nth_element(sizes_m.begin(), sizes_m.begin() + at, sizes_m.end());
        high_m = std::max(kLeast_m, static_cast<double>(sizes_m[static_cast<std::size_t>(at)]));
    }
    return {placed.is_signed ? -high_m : 0.0, high_m};
}

/// Returns a grid whose cells hold about five points each, so that a picture has few holes but
/// sharp edges.
Result<eval::DemGrid> grid_of(const std::vector<Eigen::Vector3d>& points_m) {
    eval::CloudBounds bounds;
    bounds.add(points_m);
    Eigen::Vector2d low_m = points_m.front().head<2>();
    Eigen::Vector2d high_m = low_m;
    for (const Eigen::Vector3d& p_m : points_m) {
        low_m = low_m.cwiseMin(p_m.head<2>());
        high_m = high_m.cwiseMax(p_m.head<2>());
    }
    const Eigen::Vector2d side_m = (high_m - low_m).cwiseMax(1e-3);
    constexpr double kPointsPerCell = 5.0;
    constexpr double kMostCells = 640.0;  ///< largest number of cells along a side
    const double by_density_m =
        std::sqrt(kPointsPerCell * side_m.prod() / static_cast<double>(points_m.size()));
    return bounds.grid(std::max(by_density_m, side_m.maxCoeff() / kMostCells), eval::Lattice::cell);
}

Status write_from_above(const std::string& path,
                        const PlacedDistances& placed,
                        const eval::ValueRange& range) {
    std::vector<Eigen::Vector3d> at_m;  // z holds the distance instead of the height
    for (std::size_t i = 0; i < placed.points_m.size(); ++i) {
        if (std::isnan(placed.distances_m[i])) continue;
        at_m.emplace_back(static_cast<double>(placed.points_m[i].x()),
                          static_cast<double>(placed.points_m[i].y()),
                          static_cast<double>(placed.distances_m[i]));
    }
    const auto grid = grid_of(at_m);
    if (!grid) return grid.error();
    eval::DemBuilder builder(*grid, eval::Reduce::mean);
    builder.add(at_m);
    eval::LayerStyle style;
    style.text = {placed.title, placed.subtitle};
    style.unit = "mm";
    style.map = placed.is_signed ? eval::ColorMap::balance : eval::ColorMap::viridis;
    style.range = eval::ValueRange{kMillimetres * range.low, kMillimetres * range.high};
    style.value_scale = kMillimetres;
    if (placed.is_signed) {
        style.centre = 0.0;
        style.low_word = "compared cloud is lower";
        style.high_word = "compared cloud is higher";
    }
    const auto png =
        eval::encode_png(eval::render_layer(grid->geometry, builder.heights_m(), style, {}));
    return io::write_file(path, png);
}

Status write_histogram(const std::string& path,
                       const PlacedDistances& placed,
                       const eval::ValueRange& range) {
    constexpr int kBins = 80;
    std::vector<int> counts(kBins, 0);
    int known = 0;
    for (const float d_m : placed.distances_m) {
        if (std::isnan(d_m)) continue;
        ++known;
        const double s = (static_cast<double>(d_m) - range.low) / (range.high - range.low);
        // in range: the condition keeps s in [0, 1)
        if (s >= 0.0 && s < 1.0) ++counts[static_cast<std::size_t>(s * kBins)];
    }
    eval::LinePlot plot;
    plot.title = placed.title;
    plot.x_label =
        placed.is_signed ? "distance minus the smallest shown distance [mm]" : "distance [mm]";
    plot.y_label = "share of the points in each bin [%]";
    eval::LinePlot::Line line;
    const double bin_mm = kMillimetres * (range.high - range.low) / kBins;
    for (int i = 0; i < kBins; ++i) {
        line.points.push_back(
            {(i + 0.5) * bin_mm, 100.0 * counts[static_cast<std::size_t>(i)] / std::max(known, 1)});
    }
    plot.lines.push_back(std::move(line));
    return io::write_file(path, eval::line_plot_svg(plot));
}

Status write_coloured(const std::string& path,
                      const PlacedDistances& placed,
                      const eval::ValueRange& range,
                      const Eigen::Vector3d& shift_m) {
    const eval::ColorScale scale{
        placed.is_signed ? eval::ColorMap::balance : eval::ColorMap::viridis,
        range.low,
        range.high,
        placed.is_signed ? 0.0 : 0.5 * (range.low + range.high)};
    constexpr io::Rgb kNone{128, 128, 128};
    auto writer = io::CloudWriter::create(path, {true, !shift_m.isZero()});
    if (!writer) return writer.error();
    constexpr std::size_t kBlock = 1U << 16U;
    for (std::size_t from = 0; from < placed.points_m.size(); from += kBlock) {
        io::PointCloud block;
        block.scalars.push_back({"distance_m", {}});
        for (std::size_t i = from; i < std::min(from + kBlock, placed.points_m.size()); ++i) {
            const float d_m = placed.distances_m[i];
            block.points_m.emplace_back(placed.points_m[i].cast<double>() + shift_m);
            const auto colour = scale(std::isnan(d_m) ? 0.0 : static_cast<double>(d_m));
            block.colours.push_back(std::isnan(d_m) ? kNone
                                                    : io::Rgb{colour.r, colour.g, colour.b});
            block.scalars[0].floats().push_back(d_m);
        }
        block.width = static_cast<int>(block.points_m.size());
        if (auto status = writer->add(block); !status) return status;
    }
    return writer->finish();
}

}  // namespace

Status write_cloud_pictures(const std::string& folder,
                            const PlacedDistances& placed,
                            const Eigen::Vector3d& shift_m) {
    if (auto status = io::make_folder(folder); !status) return status;
    const eval::ValueRange range = shown(placed);
    Writes writes;
    writes += write_from_above(folder + "/distances.png", placed, range);
    writes += write_histogram(folder + "/histogram.svg", placed, range);
    writes += write_coloured(folder + "/distances.ply", placed, range, shift_m);
    return writes.first();
}

std::string heights_svg(const eval::HeightHistogram& heights,
                        std::int64_t points,
                        const std::string& title) {
    eval::LinePlot plot;
    plot.title = fmt::format("{}: {} levels", title, heights.levels.size());
    plot.x_label = fmt::format("height above {:.3f} m [m]",
                               heights.low_m);  // the axis of a plot begins at zero
    plot.y_label =
        fmt::format("share of the level points in each bin of {:g} mm [%]", 1e3 * heights.bin_m);
    eval::LinePlot::Line line;
    for (std::size_t i = 0; i < heights.counts.size(); ++i) {
        line.points.push_back(
            {(static_cast<double>(i) + 0.5) * heights.bin_m,
             100.0 * static_cast<double>(heights.counts[i]) / static_cast<double>(points)});
    }
    plot.lines.push_back(std::move(line));
    return eval::line_plot_svg(plot);
}

}  // namespace surefoot::app
