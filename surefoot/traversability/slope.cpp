// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/slope.hpp"

#include <cmath>

namespace surefoot::traversability {
namespace {

float slope_rating(float normal_z, double critical_rad) noexcept {
    if (std::isnan(normal_z)) return normal_z;
    const double slope_rad = std::acos(static_cast<double>(normal_z));
    return slope_rad < critical_rad ? static_cast<float>(1.0 - slope_rad / critical_rad) : 0.0F;
}

}  // namespace

void rate_slope(const TraversabilityConfig::Slope& config,
                const grid::Layer& normal_z,
                const CellRect& rect,
                grid::Layer& slope) {
    for (int iy = rect.iy0; iy < rect.iy0 + rect.ny; ++iy) {
        for (int ix = rect.ix0; ix < rect.ix0 + rect.nx; ++ix) {
            slope.row(iy)[ix] = slope_rating(normal_z.row(iy)[ix], config.critical_rad);
        }
    }
}

}  // namespace surefoot::traversability
