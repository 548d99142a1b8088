// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/visibility/visibility.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::elevation {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

grid::GridGeometry geometry(int cells = 160) {
    grid::GridGeometry geometry;
    geometry.resolution_m = 0.025;
    geometry.nx = cells;
    geometry.ny = cells;
    geometry.origin_m = {5.0, -2.0};
    return geometry;
}

struct End {
    grid::Cell cell;
    float z_m;
};

/// Position of a cell's middle relative to the line from the camera to the middle of another cell:
/// distance beside the line, and share of the line before it.
struct Along {
    double beside_cells = 0.0;
    double beside_end_cells = 0.0;  ///< the same, scaled to the end of the line
    double share = 0.0;
    double beyond_cells = 0.0;
};

Along along(const Eigen::Vector2d& camera_cells, grid::Cell cell, grid::Cell end) {
    const Eigen::Vector2d to_cell = Eigen::Vector2d(cell.ix + 0.5, cell.iy + 0.5) - camera_cells;
    const Eigen::Vector2d to_end = Eigen::Vector2d(end.ix + 0.5, end.iy + 0.5) - camera_cells;
    const double length = to_end.norm();
    const Eigen::Vector2d unit = to_end / length;
    const double way = unit.dot(to_cell);
    const double beside = std::abs(unit.x() * to_cell.y() - unit.y() * to_cell.x());
    return {beside, beside * length / way, way / length, length - way};
}

/// Casts every line. Over a cell it returns the lowest line that passes closer than `beside_cells`
/// and, scaled to its end, closer than `beside_end_cells`.
double cast_all(const std::vector<End>& ends,
                const Eigen::Vector3d& camera_m,
                const grid::GridGeometry& g,
                grid::Cell cell,
                double beside_cells,
                double beside_end_cells,
                double beyond_cells) {
    const Eigen::Vector2d camera_cells = (camera_m.head<2>() - g.origin_m) / g.resolution_m;
    double lowest_m = std::numeric_limits<double>::infinity();
    for (const End& end : ends) {
        const Along line = along(camera_cells, cell, end.cell);
        if (line.beside_cells > beside_cells || line.beyond_cells < beyond_cells) continue;
        if (line.share <= 0.0 || line.beside_end_cells > beside_end_cells) continue;
        lowest_m = std::min(
            lowest_m, camera_m.z() + line.share * (static_cast<double>(end.z_m) - camera_m.z()));
    }
    return lowest_m;
}

TEST(FreeSpaceRays, LieBetweenTheNarrowAndTheWideCast) {
    Rng rng(3);
    const grid::GridGeometry g = geometry();
    const Eigen::Vector3d camera_m(7.013, 0.004, 1.2);
    std::vector<End> ends;
    FreeSpaceRays lines;
    lines.reset(g, camera_m);
    for (int i = 0; i < 400; ++i) {
        const End end{{static_cast<int>(rng.below(160)), static_cast<int>(rng.below(160))},
                      static_cast<float>(rng.uniform(-0.3, 0.9))};
        ends.push_back(end);
        lines.add(end.cell, end.z_m);
    }
    lines.finish();
    int passed = 0;
    for (int iy = 0; iy < g.ny; iy += 3) {
        for (int ix = 0; ix < g.nx; ix += 3) {
            const float lowest_m = lines.lowest_over({ix, iy});
            const double wide_m = cast_all(ends, camera_m, g, {ix, iy}, 2.0, 1e9, 1.0);
            // A returned height belongs to a real line: some line passes within two cells at about
            // that height. A line's height differs, by its slope, along the cells to which it is
            // rounded.
            constexpr double kSlopeOfTwoCells_m = 0.06;
            if (std::isfinite(lowest_m)) {
                ++passed;
                EXPECT_GE(static_cast<double>(lowest_m), wide_m - kSlopeOfTwoCells_m)
                    << ix << ", " << iy;
            }
            // The table contains every line that passes near the middle.
            const double narrow_m = cast_all(ends, camera_m, g, {ix, iy}, 0.1, 0.3, 6.0);
            const double from_camera_cells = (Eigen::Vector2d(ix + 0.5, iy + 0.5) -
                                              (camera_m.head<2>() - g.origin_m) / g.resolution_m)
                                                 .norm();
            if (std::isfinite(narrow_m) && from_camera_cells > 4.0) {
                EXPECT_LE(static_cast<double>(lowest_m), narrow_m + kSlopeOfTwoCells_m)
                    << ix << ", " << iy;
            }
        }
    }
    EXPECT_GT(passed, 500);
}

TEST(FreeSpaceRays, SayNothingOfTheirEndsAndOfWhatIsBeyond) {
    const grid::GridGeometry g = geometry();
    const Eigen::Vector3d camera_m(5.0, 0.0, 1.0);
    FreeSpaceRays lines;
    lines.reset(g, camera_m);
    lines.add({100, 80}, 0.0F);
    lines.finish();
    EXPECT_EQ(lines.lowest_over({100, 80}), kInfinity);
    EXPECT_EQ(lines.lowest_over({99, 80}), kInfinity);
    EXPECT_EQ(lines.lowest_over({120, 80}), kInfinity);
    EXPECT_EQ(lines.lowest_over({50, 120}), kInfinity);
    // At half the distance the line is half way down, except for the half cell between the cell
    // middles and the axis.
    EXPECT_NEAR(lines.lowest_over({50, 80}), 0.5F, 0.01F);
}

TEST(FreeSpaceRays, CameraOverOrBesideTheMap) {
    const grid::GridGeometry g = geometry(8);
    for (const double x_m : {5.1, 4.0, -1e9, std::numeric_limits<double>::quiet_NaN()}) {
        FreeSpaceRays lines;
        lines.reset(g, {x_m, -1.9, 1.0});
        for (int iy = 0; iy < 8; ++iy) {
            for (int ix = 0; ix < 8; ++ix) lines.add({ix, iy}, 0.0F);
        }
        lines.finish();
        for (int iy = 0; iy < 8; ++iy) {
            for (int ix = 0; ix < 8; ++ix) {
                EXPECT_FALSE(lines.lowest_over({ix, iy}) < -1e-6F) << "no line is below its end";
            }
        }
    }
}

}  // namespace
}  // namespace surefoot::elevation
