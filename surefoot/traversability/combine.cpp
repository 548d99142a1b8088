// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/combine.hpp"

namespace surefoot::traversability {

void combine(Combine rule,
             const TraversabilityConfig::Weights& weights,
             const grid::Layer& slope,
             const grid::Layer& step,
             const grid::Layer& roughness,
             const CellRect& rect,
             grid::Layer& traversability) {
    const bool zero_dominates = rule == Combine::zero_dominates;
    const double sum = weights.slope + weights.step + weights.roughness;
    const double w_slope = weights.slope / sum;
    const double w_step = weights.step / sum;
    const double w_roughness = weights.roughness / sum;
    const auto forces_zero = [](double weight, float rating) {
        return weight > 0.0 && rating == 0.0F;
    };
    for (int iy = rect.iy0; iy < rect.iy0 + rect.ny; ++iy) {
        for (int ix = rect.ix0; ix < rect.ix0 + rect.nx; ++ix) {
            const float a = slope.row(iy)[ix];
            const float b = step.row(iy)[ix];
            const float c = roughness.row(iy)[ix];
            const bool zero =
                zero_dominates &&
                (forces_zero(w_slope, a) || forces_zero(w_step, b) || forces_zero(w_roughness, c));
            // A NaN passes through the sum even with weight 0.
            const double mean = w_slope * static_cast<double>(a) + w_step * static_cast<double>(b) +
                                w_roughness * static_cast<double>(c);
            traversability.row(iy)[ix] = zero ? 0.0F : static_cast<float>(mean);
        }
    }
}

}  // namespace surefoot::traversability
