// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/step_rows.hpp"

#include "surefoot/core/unknown.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/traversability/step_rows.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>

// The lanes hold neighbouring columns; a stripe of columns is as wide as a register. The code goes
// down a stripe row by row. For each row it computes one `StepRun` for every half width, in
// ascending order. A ring keeps the runs of the rows that a disc covers.

#ifndef SUREFOOT_STEP_RATING_CONSTANTS
#define SUREFOOT_STEP_RATING_CONSTANTS
namespace surefoot::traversability::rows {
namespace {

struct RatingConstants {
    float largest_below;   ///< largest float that is not above the critical step
    float smallest_above;  ///< smallest float that is not below the critical step
    float inverse;         ///< 1 / critical step
    float enough;          ///< number of critical cells for the full step height
    float share;           ///< 1 / `enough`
};

}  // namespace
}  // namespace surefoot::traversability::rows
#endif

HWY_BEFORE_NAMESPACE();
namespace surefoot::traversability::rows::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
constexpr hn::CappedTag<float, StepRun::kLanes> kFloats;
using Floats = hn::VFromD<decltype(kFloats)>;

/// Prefetch distance in columns, for later stripes. Down a stripe every row is on another memory
/// page, which no processor predicts; on maps wider than the cache every row would wait.
constexpr int kAhead = 32;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Two figures of a run in each lane.
struct Pair {
    Floats a, b;
};
HWY_INLINE Pair load(const StepRun& run) {
    return {hn::Load(kFloats, run.figures[0]), hn::Load(kFloats, run.figures[1])};
}
HWY_INLINE void store(const Pair& pair, StepRun& run) {
    hn::Store(pair.a, kFloats, run.figures[0]);
    hn::Store(pair.b, kFloats, run.figures[1]);
}

/// Lowest and highest known height; +inf and -inf without known heights.
struct Range {
    HWY_INLINE Pair cell(const float* at) const {
        const Floats z = hn::LoadU(kFloats, at);
        const auto unknown = hn::IsNaN(z);
        return {hn::IfThenElse(unknown, hn::Set(kFloats, kInfinity), z),
                hn::IfThenElse(unknown, hn::Set(kFloats, -kInfinity), z)};
    }
    HWY_INLINE Pair join(const Pair& one, const Pair& other) const {
        return {hn::Min(one.a, other.a), hn::Max(one.b, other.b)};
    }
};

/// Highest step height (-1 without any), and the number of critical steps.
struct Critical {
    Floats limit_m;  ///< the largest float that is not critical

    HWY_INLINE Pair cell(const float* at) const {
        const Floats step_m = hn::LoadU(kFloats, at);
        // NaN compares false.
        return {hn::IfThenElse(hn::IsNaN(step_m), hn::Set(kFloats, -1.0F), step_m),
                hn::IfThenElseZero(hn::Gt(step_m, limit_m), hn::Set(kFloats, 1.0F))};
    }
    HWY_INLINE Pair join(const Pair& one, const Pair& other) const {
        return {hn::Max(one.a, other.a), hn::Add(one.b, other.b)};
    }
};

template <class Figures>
HWY_INLINE void reduce_row(const Figures& figures,
                           const float* center,
                           const std::vector<int>& half_widths,
                           StepRun* runs) {
    Pair run = figures.cell(center);
    int dx = 0;
    for (const int half_width : half_widths) {
        for (; dx < half_width; ++dx) {
            run = figures.join(
                run, figures.join(figures.cell(center - dx - 1), figures.cell(center + dx + 1)));
        }
        store(run, *runs);
        ++runs;
    }
}

/// Computes the figures of the discs around one vector of columns, `ix` and the columns after it,
/// and calls finish(iy, figures) for each row of `rect`.
template <class Figures, class Finish>
HWY_INLINE void down_the_stripe(const Figures& figures,
                                const PaddedLayer& layer,
                                const RunsOfDiscs& widths,
                                const DiscRuns& disc,
                                const CellRect& rect,
                                int ix,
                                StepRun* ring,
                                const Finish& finish) {
    const int reach = disc.reach;
    const int kept = 2 * reach + 1;
    StepRun* row[2 * DiscRuns::kMaxReach + 1];  // row dy of the current disc is [dy + reach]
    for (int k = 0; k < kept; ++k)
        row[k] = ring + static_cast<std::size_t>(k) * widths.half_widths().size();
    for (int iy = rect.iy0 - reach; iy < rect.iy0 + rect.ny + reach; ++iy) {
        std::rotate(row, row + 1, row + kept);
        hwy::Prefetch(layer.cell(ix, iy) + kAhead);
        reduce_row(figures, layer.cell(ix, iy), widths.half_widths(), row[kept - 1]);
        if (iy < rect.iy0 + reach) continue;
        const auto run = [&](int dy) {
            return load(row[dy + reach][disc.width[static_cast<std::size_t>(std::abs(dy))]]);
        };
        Pair sum = run(0);
        for (int dy = 1; dy <= reach; ++dy)
            sum = figures.join(sum, figures.join(run(-dy), run(dy)));
        finish(iy - reach, sum);
    }
}

HWY_INLINE void store_some(Floats value, int count, float* to) {
    if (count >= static_cast<int>(hn::Lanes(kFloats))) {
        hn::StoreU(value, kFloats, to);
    } else {
        HWY_ALIGN float lanes[StepRun::kLanes];
        hn::Store(value, kFloats, lanes);
        std::copy(lanes, lanes + count, to);
    }
}

void step_heights_block(const PaddedLayer& height_m,
                        const RunsOfDiscs& widths,
                        const DiscRuns& first_disc,
                        const CellRect& rect,
                        StepRun* ring,
                        PaddedLayer& step_height_m) {
    const int end = rect.ix0 + rect.nx;
    for (int ix = rect.ix0; ix < end; ix += static_cast<int>(hn::Lanes(kFloats))) {
        const auto finish = [&](int iy, const Pair& range) {
            const auto unknown = hn::IsNaN(hn::LoadU(kFloats, height_m.cell(ix, iy)));
            const Floats step_m =
                hn::IfThenElse(unknown, hn::Set(kFloats, kNanF), hn::Sub(range.b, range.a));
            hwy::Prefetch(step_height_m.cell(ix, iy) + kAhead);
            store_some(step_m, end - ix, step_height_m.cell(ix, iy));
        };
        down_the_stripe(Range{}, height_m, widths, first_disc, rect, ix, ring, finish);
    }
}

HWY_INLINE Floats rating(const RatingConstants& k, const Pair& critical) {
    const Floats highest = critical.a;
    const Floats partly = hn::Mul(hn::Mul(critical.b, hn::Set(kFloats, k.share)), highest);
    const auto all = hn::Ge(critical.b, hn::Set(kFloats, k.enough));
    const Floats step_m = hn::IfThenElse(all, highest, hn::Min(partly, highest));
    const Floats one = hn::Set(kFloats, 1.0F);
    const Floats passable = hn::Sub(one, hn::Mul(step_m, hn::Set(kFloats, k.inverse)));
    // Keeps at least the smallest float, because a step below the critical step is not rated 0.
    const Floats positive = hn::Max(passable, hn::Set(kFloats, std::numeric_limits<float>::min()));
    const auto below = hn::Lt(step_m, hn::Set(kFloats, k.smallest_above));
    const auto known = hn::Ge(highest, hn::Zero(kFloats));
    return hn::IfThenElse(known, hn::IfThenElseZero(below, positive), hn::Set(kFloats, kNanF));
}

void rate_step_block(const RatingConstants& constants,
                     const PaddedLayer& step_height_m,
                     const RunsOfDiscs& widths,
                     const DiscRuns& second_disc,
                     const CellRect& rect,
                     StepRun* ring,
                     grid::Layer& step) {
    const Critical figures{hn::Set(kFloats, constants.largest_below)};
    const int end = rect.ix0 + rect.nx;
    for (int ix = rect.ix0; ix < end; ix += static_cast<int>(hn::Lanes(kFloats))) {
        const auto finish = [&](int iy, const Pair& critical) {
            hwy::Prefetch(step.row(iy) + ix + kAhead);
            store_some(rating(constants, critical), end - ix, step.row(iy) + ix);
        };
        down_the_stripe(figures, step_height_m, widths, second_disc, rect, ix, ring, finish);
    }
}

}  // namespace
}  // namespace surefoot::traversability::rows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::traversability::rows {

HWY_EXPORT(step_heights_block);
HWY_EXPORT(rate_step_block);

namespace {

/// Holds the limit as the two floats next to it. Comparing a float with them gives the same result
/// as comparing it with the double limit.
RatingConstants constants_of(const TraversabilityConfig::Step& config) {
    const auto nearest = static_cast<float>(config.critical_m);
    const double rounded = static_cast<double>(nearest);
    return {rounded > config.critical_m
                ? std::nextafter(nearest, -std::numeric_limits<float>::infinity())
                : nearest,
            rounded < config.critical_m
                ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
                : nearest,
            static_cast<float>(1.0 / config.critical_m),
            static_cast<float>(config.critical_cells),
            static_cast<float>(1.0 / config.critical_cells)};
}

}  // namespace

void step_heights(const PaddedLayer& height_m,
                  const RunsOfDiscs& widths,
                  const DiscRuns& first_disc,
                  const CellRect& rect,
                  StepRun* ring,
                  PaddedLayer& step_height_m) {
    HWY_DYNAMIC_DISPATCH(step_heights_block)
    (height_m, widths, first_disc, rect, ring, step_height_m);
}
void rate_step(const TraversabilityConfig::Step& config,
               const PaddedLayer& step_height_m,
               const RunsOfDiscs& widths,
               const DiscRuns& second_disc,
               const CellRect& rect,
               StepRun* ring,
               grid::Layer& step) {
    HWY_DYNAMIC_DISPATCH(rate_step_block)
    (constants_of(config), step_height_m, widths, second_disc, rect, ring, step);
}

}  // namespace surefoot::traversability::rows
#endif  // HWY_ONCE
