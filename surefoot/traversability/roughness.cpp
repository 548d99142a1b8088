// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/roughness.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::traversability {
namespace {

struct Normal {
    double x, y, z;
};

/// Returns the roughness; NaN for a single cell.
double roughness_m(const float* center, const Disc& disc, const Normal& normal) noexcept {
    const double center_m = static_cast<double>(*center);
    double n = 0.0;
    double sum_m = 0.0;
    double sum_m2 = 0.0;
    for (const DiscCell& cell : disc.cells) {
        const float height_m = center[cell.offset];
        if (std::isnan(height_m)) continue;
        // Distance from the plane through the centre cell. On a smooth patch it is as small as the
        // roughness itself, so the difference of the two sums keeps its precision.
        const double distance_m = normal.x * cell.x_m + normal.y * cell.y_m +
                                  normal.z * (static_cast<double>(height_m) - center_m);
        n += 1.0;
        sum_m += distance_m;
        sum_m2 += distance_m * distance_m;
    }
    return std::sqrt(std::max(sum_m2 - sum_m * sum_m / n, 0.0) / (n - 1.0));
}

}  // namespace

void rate_roughness(const TraversabilityConfig::Roughness& config,
                    const PaddedLayer& height_m,
                    const Disc& disc,
                    const grid::Layer& normal_x,
                    const grid::Layer& normal_y,
                    const grid::Layer& normal_z,
                    const CellRect& rect,
                    grid::Layer& roughness) {
    for (int iy = rect.iy0; iy < rect.iy0 + rect.ny; ++iy) {
        for (int ix = rect.ix0; ix < rect.ix0 + rect.nx; ++ix) {
            const Normal normal{static_cast<double>(normal_x.row(iy)[ix]),
                                static_cast<double>(normal_y.row(iy)[ix]),
                                static_cast<double>(normal_z.row(iy)[ix])};
            if (std::isnan(normal.x)) {
                roughness.row(iy)[ix] = normal_x.row(iy)[ix];
                continue;
            }
            const double value_m = roughness_m(height_m.cell(ix, iy), disc, normal);
            // False for NaN too: a cell without neighbours is rated 0.
            const bool passable = value_m < config.critical_m;
            roughness.row(iy)[ix] =
                passable ? static_cast<float>(1.0 - value_m / config.critical_m) : 0.0F;
        }
    }
}

}  // namespace surefoot::traversability
