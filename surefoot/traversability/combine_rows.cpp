// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/combine_rows.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/traversability/combine_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace surefoot::traversability::rows::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// One of the three combined ratings.
struct Share {
    const float* rating;
    double weight;
    bool dominates;  ///< an exact 0 of this rating forces the result to 0
};

template <class D>
HWY_INLINE void combine_here(D d, const Share (&shares)[3], int i, float* out) {
    const hn::Rebind<float, D> half;
    auto mean = hn::Zero(d);
    auto zero = hn::Gt(hn::Zero(half), hn::Zero(half));
    for (const Share& share : shares) {
        const auto rating = hn::LoadU(half, share.rating + i);
        // A NaN passes through the sum even with weight 0.
        mean = hn::Add(mean, hn::Mul(hn::Set(d, share.weight), hn::PromoteTo(d, rating)));
        if (share.dominates) zero = hn::Or(zero, hn::Eq(rating, hn::Zero(half)));
    }
    hn::StoreU(hn::IfThenZeroElse(zero, hn::DemoteTo(half, mean)), half, out + i);
}

void combine_row(const Share (&shares)[3], int count, float* out) {
    const hn::CappedTag<double, 8> whole;
    const hn::CappedTag<double, 1> single;
    const int lanes = static_cast<int>(hn::Lanes(whole));
    int i = 0;
    for (; i + lanes <= count; i += lanes) combine_here(whole, shares, i, out);
    for (; i < count; ++i) combine_here(single, shares, i, out);
}

void combine_block(Combine rule,
                   const TraversabilityConfig::Weights& weights,
                   const grid::Layer& slope,
                   const grid::Layer& step,
                   const grid::Layer& roughness,
                   const CellRect& rect,
                   grid::Layer& traversability) {
    const double sum = weights.slope + weights.step + weights.roughness;
    for (int iy = rect.iy0; iy < rect.iy0 + rect.ny; ++iy) {
        const auto share = [&](const grid::Layer& layer, double weight) {
            const double normalised = weight / sum;
            return Share{layer.row(iy) + rect.ix0,
                         normalised,
                         rule == Combine::zero_dominates && normalised > 0.0};
        };
        const Share shares[3] = {share(slope, weights.slope),
                                 share(step, weights.step),
                                 share(roughness, weights.roughness)};
        combine_row(shares, rect.nx, traversability.row(iy) + rect.ix0);
    }
}

}  // namespace
}  // namespace surefoot::traversability::rows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::traversability::rows {

HWY_EXPORT(combine_block);

void combine(Combine rule,
             const TraversabilityConfig::Weights& weights,
             const grid::Layer& slope,
             const grid::Layer& step,
             const grid::Layer& roughness,
             const CellRect& rect,
             grid::Layer& traversability) {
    HWY_DYNAMIC_DISPATCH(combine_block)
    (rule, weights, slope, step, roughness, rect, traversability);
}

}  // namespace surefoot::traversability::rows
#endif  // HWY_ONCE
