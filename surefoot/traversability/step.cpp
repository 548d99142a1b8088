// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/step.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/unknown.hpp"

namespace surefoot::traversability {
namespace {

float step_height_at(const float* center, const Disc& disc) noexcept {
    if (std::isnan(*center) || disc.cells.size() < 2) return kNanF;
    float lowest = *center;
    float highest = *center;
    for (const DiscCell& cell : disc.cells) {
        const float height_m = center[cell.offset];
        // Comparisons with an unknown height are false.
        if (height_m < lowest) lowest = height_m;
        if (height_m > highest) highest = height_m;
    }
    return highest - lowest;
}

float step_rating(const TraversabilityConfig::Step& config,
                  const float* center,
                  const Disc& disc) noexcept {
    float highest = -1.0F;  // below every step height
    int critical = 0;
    for (const DiscCell& cell : disc.cells) {
        const float step_m = center[cell.offset];
        if (step_m > highest) highest = step_m;
        if (static_cast<double>(step_m) > config.critical_m) ++critical;
    }
    if (highest < 0.0F) return kNanF;
    const double max_m = static_cast<double>(highest);
    const double step_m =
        std::min(max_m, critical / static_cast<double>(config.critical_cells) * max_m);
    return step_m < config.critical_m ? static_cast<float>(1.0 - step_m / config.critical_m) : 0.0F;
}

}  // namespace

void step_heights(const PaddedLayer& height_m,
                  const Disc& first_disc,
                  const CellRect& rect,
                  PaddedLayer& step_height_m) {
    for (int iy = rect.iy0; iy < rect.iy0 + rect.ny; ++iy) {
        for (int ix = rect.ix0; ix < rect.ix0 + rect.nx; ++ix) {
            *step_height_m.cell(ix, iy) = step_height_at(height_m.cell(ix, iy), first_disc);
        }
    }
}

void rate_step(const TraversabilityConfig::Step& config,
               const PaddedLayer& step_height_m,
               const Disc& second_disc,
               const CellRect& rect,
               grid::Layer& step) {
    for (int iy = rect.iy0; iy < rect.iy0 + rect.ny; ++iy) {
        for (int ix = rect.ix0; ix < rect.ix0 + rect.nx; ++ix) {
            step.row(iy)[ix] = step_rating(config, step_height_m.cell(ix, iy), second_disc);
        }
    }
}

}  // namespace surefoot::traversability
