// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/visibility/ray_endpoints.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::elevation {
namespace {

constexpr float kMargin_m = 0.05F;
const Eigen::Vector3d kCamera_m(5.013, 0.21, 1.04);

/// A grid of 6 m x 3 m ahead of the camera.
grid::GridGeometry geometry() {
    grid::GridGeometry geometry;
    geometry.resolution_m = 0.025;
    geometry.nx = 240;
    geometry.ny = 120;
    geometry.origin_m = {5.0, -1.5};
    return geometry;
}

std::size_t index_of(const grid::GridGeometry& g, grid::Cell cell) {
    return static_cast<std::size_t>(cell.iy) * static_cast<std::size_t>(g.nx) +
           static_cast<std::size_t>(cell.ix);
}

struct CellObservation {
    float z_m = kNanF;
    float bottom_m = kNanF;
};

/// Sets every cell of the map for which `look(x, y)` gives a height.
template <class FrameObservation>
RayEndpoints seen(const FrameObservation& look, const Eigen::Vector3d& camera_m = kCamera_m) {
    const grid::GridGeometry g = geometry();
    RayEndpoints ends;
    ends.reset(g, camera_m);
    for (int iy = 0; iy < g.ny; ++iy) {
        for (int ix = 0; ix < g.nx; ++ix) {
            const Eigen::Vector2d at = g.center_m({ix, iy});
            const CellObservation cell = look(at.x(), at.y());
            if (std::isnan(cell.z_m)) continue;
            ends.set(index_of(g, {ix, iy}), cell.z_m, cell.bottom_m);
        }
    }
    return ends;
}

/// A table top without legs over floor at 0.
constexpr float kTop_m = 0.72F;
bool is_table(double x_m, double y_m) {
    return x_m > 6.0 && x_m < 6.9 && y_m > -0.3 && y_m < 0.4;
}
/// True if the line from the camera to a place on the floor meets the top.
bool in_its_shadow(double x_m, double y_m) {
    const double share = (kCamera_m.z() - static_cast<double>(kTop_m)) / kCamera_m.z();
    return is_table(kCamera_m.x() + share * (x_m - kCamera_m.x()),
                    kCamera_m.y() + share * (y_m - kCamera_m.y()));
}

/// Limit of wrong cells out of 1008: cells at corners may look like the free space beside them.
constexpr int kCorners = 8;

/// Number of cells of the top that lines of sight contradict.
int contradicted(const RayEndpoints& ends) {
    const grid::GridGeometry g = geometry();
    int cells = 0;
    for (int iy = 0; iy < g.ny; ++iy) {
        for (int ix = 0; ix < g.nx; ++ix) {
            const Eigen::Vector2d at = g.center_m({ix, iy});
            if (!is_table(at.x(), at.y())) continue;
            cells += ends.passed_through({ix, iy}, kTop_m - kMargin_m, kTop_m + kMargin_m);
        }
    }
    return cells;
}

TEST(RayEndpoints, FloorSeenUnderATableDoesNotContradictItsTop) {
    // From this near, the camera observes floor under the table but no part of the top, which is
    // below the image.
    const RayEndpoints ends = seen([](double x_m, double y_m) {
        return in_its_shadow(x_m, y_m) ? CellObservation{} : CellObservation{0.0F, 0.0F};
    });
    int under = 0;
    const grid::GridGeometry g = geometry();
    for (int ix = 0; ix < g.nx; ++ix) {
        const Eigen::Vector2d at = g.center_m({ix, 60});
        under += is_table(at.x(), at.y()) && !std::isnan(ends.z_m(index_of(g, {ix, 60})));
    }
    ASSERT_GT(under, 15) << "cells of a row in which floor is seen";
    EXPECT_LE(contradicted(ends), kCorners);
}

TEST(RayEndpoints, NorDoesTheTopItself) {
    const RayEndpoints ends = seen([](double x_m, double y_m) {
        if (is_table(x_m, y_m)) return CellObservation{kTop_m, kTop_m};
        return in_its_shadow(x_m, y_m) ? CellObservation{} : CellObservation{0.0F, 0.0F};
    });
    EXPECT_LE(contradicted(ends), kCorners);
}

TEST(RayEndpoints, FloorBehindItDoes) {
    const RayEndpoints ends = seen([](double, double) { return CellObservation{0.0F, 0.0F}; });
    // The lines through the others end beyond the map.
    EXPECT_GT(contradicted(ends), 300);
    // A third of the floor is enough.
    Rng rng(7);
    const RayEndpoints sparse = seen([&](double, double) {
        return rng.below(3) == 0 ? CellObservation{0.0F, 0.0F} : CellObservation{};
    });
    EXPECT_GT(contradicted(sparse), 100);
}

TEST(RayEndpoints, AWallBehindItDoes) {
    const auto wall = [](float bottom_m) {
        return [bottom_m](double x_m, double) {
            return x_m > 7.2 ? CellObservation{0.9F, bottom_m} : CellObservation{};
        };
    };
    EXPECT_GT(contradicted(seen(wall(0.0F))), 900);
    EXPECT_EQ(contradicted(seen(wall(0.9F))), 0) << "a shelf: its lines ended at its height alone";
}

TEST(RayEndpoints, SayNothingWithoutADirection) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Eigen::Vector3d& camera_m : {Eigen::Vector3d(6.0, 0.0, 1.0),
                                            Eigen::Vector3d(nan, 0.0, 1.0),
                                            Eigen::Vector3d(-1e12, 0.0, 1.0),
                                            Eigen::Vector3d(6.0, 0.0, nan)}) {
        const RayEndpoints ends = seen(
            [](double, double) {
                return CellObservation{0.0F, 0.0F};
            },
            camera_m);
        EXPECT_FALSE(ends.passed_through({39, 59}, 0.3F, 0.4F));  // beside (6, 0)
        EXPECT_FALSE(ends.passed_through({39, 59}, kNanF, kNanF));
    }
}

/// Marches along the line in small steps, in doubles, over a fully observed map. Returns where the
/// line ends: `inside` is more than 3 cells from the border, `near_the_border` is closer.
enum class End : std::uint8_t { inside, outside, near_the_border };
End march(const RayEndpoints& ends, grid::Cell cell, double z_m) {
    const grid::GridGeometry g = geometry();
    const Eigen::Vector2d from_m = g.center_m(cell);
    const Eigen::Vector2d away_m = from_m - kCamera_m.head<2>();
    const double fall = (kCamera_m.z() - z_m) / away_m.norm();
    for (double s_m = 3.5 * g.resolution_m;; s_m += 0.001) {
        const Eigen::Vector2d at_m = from_m + s_m * away_m.normalized();
        const Eigen::Vector2d beside_m = (at_m - g.origin_m) / g.resolution_m;
        const double margin =
            std::min({beside_m.x(), beside_m.y(), g.nx - beside_m.x(), g.ny - beside_m.y()});
        if (margin < 0.0) return End::outside;
        const auto ground_m = static_cast<double>(ends.z_m(
            index_of(g, {static_cast<int>(beside_m.x()), static_cast<int>(beside_m.y())})));
        if (z_m - fall * s_m > ground_m) continue;
        return margin > 3.0 ? End::inside : End::near_the_border;
    }
}

TEST(RayEndpoints, AgreesWithMarchingAlongTheLine) {
    Rng rng(11);
    int inside = 0;
    int outside = 0;
    for (int scene = 0; scene < 20; ++scene) {
        const double phase = rng.uniform(0.0, 6.0);
        // The ground is nowhere steeper than the lines, so no line enters a cell from the side.
        const double rise = rng.uniform(0.01, 0.04);
        const RayEndpoints ends = seen([&](double x_m, double y_m) {
            const double z_m = rise * std::sin(3.0 * x_m + phase) * std::cos(2.0 * y_m);
            return CellObservation{static_cast<float>(z_m), static_cast<float>(z_m)};
        });
        for (int i = 0; i < 200; ++i) {
            const grid::Cell cell{10 + static_cast<int>(rng.below(90)),
                                  static_cast<int>(rng.below(120))};
            const double z_m = rng.uniform(0.2, 0.6);
            const End end = march(ends, cell, z_m);
            if (end == End::near_the_border) continue;
            const auto line_m = static_cast<float>(z_m);
            const bool passed = ends.passed_through(cell, line_m, line_m);
            // Rounding may put the end of a line that leaves the map just above the ground onto the
            // ground.
            if (end == End::outside && passed) continue;
            EXPECT_EQ(passed, end == End::inside) << cell.ix << ", " << cell.iy << ", " << z_m;
            (passed ? inside : outside) += 1;
        }
    }
    EXPECT_GT(inside, 500);
    EXPECT_GT(outside, 500);
}

}  // namespace
}  // namespace surefoot::elevation
