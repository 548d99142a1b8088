// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/reduce_cells.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/elevation/reduce_cells.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cmath>
#include <cstring>
#include <limits>

// Sixteen samples of a cell side by side, in one, two or four registers. What is added in floats is
// added in sixteen columns first and in the same tree then, as `LaneSum` does it one by one: so the
// width of the registers does not show.

HWY_BEFORE_NAMESPACE();
namespace surefoot::elevation::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr int kWidth = static_cast<int>(hn::MaxLanes(D()));
constexpr int kParts = 16 / kWidth;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Ranks up to this are found by taking one extreme after the other, others bit by bit.
constexpr int kFewRanks = 32;

/// Samples of one cell.
struct Samples {
    const float* z_m;
    const float* var_m2;
    int n;
};

/// Sixteen columns of a sum.
struct Columns {
    V part[kParts];

    HWY_INLINE Columns() {
        for (V& p : part) p = hn::Zero(D());
    }
    /// (0 + 8) + (4 + 12), ... : see LaneSum.
    HWY_INLINE float total() const {
        HWY_ALIGN float column[16];
        for (int p = 0; p < kParts; ++p) hn::Store(part[p], D(), column + p * kWidth);
        return tree(column);
    }
};

HWY_INLINE M present(int index, int n) {
    return hn::FirstN(D(), static_cast<std::size_t>(n > index ? n - index : 0));
}

/// Calls f(part, offset of its first sample, which of its samples exist).
template <class F>
HWY_INLINE void for_each_part(int n, const F& f) {
    for (int i = 0; i < n; i += 16) {
        for (int p = 0; p < kParts; ++p) {
            const int at = i + p * kWidth;
            f(p, at, present(at, n));
        }
    }
}

HWY_INLINE int count_from(const Samples& samples, V flip, V least) {
    std::size_t count = 0;
    for_each_part(samples.n, [&](int, int at, M exists) {
        const V value = hn::Xor(hn::LoadU(D(), samples.z_m + at), flip);
        count += hn::CountTrue(D(), hn::And(exists, hn::Ge(value, least)));
    });
    return static_cast<int>(count);
}

/// The value with `rank` values at or above it, by taking the largest, the next one, ...
HWY_INLINE float by_extremes(const Samples& samples, V flip, int rank) {
    V below = hn::Set(D(), kInfinity);
    while (true) {
        V largest = hn::Set(D(), -kInfinity);
        for_each_part(samples.n, [&](int, int at, M exists) {
            const V value = hn::Xor(hn::LoadU(D(), samples.z_m + at), flip);
            const M counts = hn::And(exists, hn::Lt(value, below));
            largest = hn::IfThenElse(counts, hn::Max(largest, value), largest);
        });
        below = hn::MaxOfLanes(D(), largest);
        if (hn::GetLane(below) == -kInfinity) return -kInfinity;
        if (count_from(samples, flip, below) >= rank) return hn::GetLane(below);
    }
}

/// The same bit by bit: floats in the order of integers (sign and magnitude to two's complement).
HWY_INLINE float by_bits(const Samples& samples, bool from_below, int rank) {
    const auto float_of = [](std::uint32_t key) {
        const std::uint32_t bits = key & 0x80000000U ? key ^ 0x80000000U : ~key;
        float value = 0.0F;
        std::memcpy(&value, &bits, sizeof value);
        return value;
    };
    const V flip = hn::Set(D(), from_below ? -0.0F : 0.0F);
    std::uint32_t key = 0;
    for (std::uint32_t bit = 0x80000000U; bit != 0; bit >>= 1) {
        const float least = float_of(key | bit);
        // NaN stands beyond infinity on either side: nothing is above the one, all above the other.
        const bool is_reached = std::isnan(least)
                                    ? (key | bit) < 0x80000000U
                                    : count_from(samples, flip, hn::Set(D(), least)) >= rank;
        if (is_reached) key |= bit;
    }
    return float_of(key);
}

/// Height with `rank` samples at or above it (rank 1 = the maximum), or at or below it.
HWY_INLINE float ranked(const Samples& samples, bool from_below, int rank) {
    const V flip = hn::Set(D(), from_below ? -0.0F : 0.0F);
    const float value =
        rank <= kFewRanks ? by_extremes(samples, flip, rank) : by_bits(samples, from_below, rank);
    return (from_below ? -value : value) + 0.0F;  // zero has no sign
}

HWY_INLINE Surface surface_around(const Samples& samples, float center_m, float half_width_m) {
    const V center = hn::Set(D(), center_m);
    const V half_width = hn::Set(D(), half_width_m);
    Columns sum_m;
    Columns sum_sq_m2;
    Columns sum_var_m2;
    std::size_t points = 0;
    for_each_part(samples.n, [&](int p, int at, M exists) {
        const V offset = hn::Sub(hn::LoadU(D(), samples.z_m + at), center);
        const M near = hn::And(exists, hn::Le(hn::Abs(offset), half_width));
        points += hn::CountTrue(D(), near);
        const V counted = hn::IfThenElseZero(near, offset);
        sum_m.part[p] = hn::Add(sum_m.part[p], counted);
        sum_sq_m2.part[p] = hn::Add(sum_sq_m2.part[p], hn::Mul(counted, counted));
        const V var = hn::IfThenElseZero(near, hn::LoadU(D(), samples.var_m2 + at));
        sum_var_m2.part[p] = hn::Add(sum_var_m2.part[p], var);
    });
    if (points == 0) return {};
    return surface_of(
        static_cast<int>(points), center_m, sum_m.total(), sum_sq_m2.total(), sum_var_m2.total());
}

HWY_INLINE Surface climb(const Samples& samples, float start_m, float half_width_m) {
    Surface surface = surface_around(samples, start_m, half_width_m);
    for (int round = 1; round < kClimbs && surface.points > 0; ++round) {
        surface = surface_around(samples, surface.mean_m, half_width_m);
    }
    return surface;
}

HWY_INLINE float mean_variance(const Samples& samples) {
    Columns sum_m2;
    for_each_part(samples.n, [&](int p, int at, M exists) {
        const V var = hn::IfThenElseZero(exists, hn::LoadU(D(), samples.var_m2 + at));
        sum_m2.part[p] = hn::Add(sum_m2.part[p], var);
    });
    return sum_m2.total() / static_cast<float>(samples.n);
}

HWY_INLINE CellMeasurement reduce(const ReductionConfig& config, const Samples& samples) {
    const int support = support_of(config, samples.n);
    if (samples.n < support) return {};
    CellMeasurement measured;
    measured.lowest_m = ranked(samples, true, support);
    measured.highest_m = ranked(samples, false, support);
    const float half_width_m = half_width(config, mean_variance(samples));
    float start_m = measured.highest_m;
    int rank = support;
    for (int attempt = 0; attempt < kMaxTries; ++attempt) {
        const Surface surface = climb(samples, start_m, half_width_m);
        if (surface.points >= support) {
            measured.z_m = surface.mean_m;
            measured.var_m2 = measurement_variance(config, surface);
            measured.points = surface.points;
            return measured;
        }
        rank += support;
        if (rank > samples.n) break;
        start_m = ranked(samples, false, rank);
    }
    return face_of(config, measured, samples.n, half_width_m);
}

void reduce_all(const ReductionConfig& config,
                const std::uint32_t* begin,
                int cells,
                const float* z_m,
                const float* var_m2,
                CellMeasurement* measured) {
    for (int i = 0; i < cells; ++i) {
        const auto n = static_cast<int>(begin[i + 1] - begin[i]);
        measured[i] =
            n == 0 ? CellMeasurement{} : reduce(config, {z_m + begin[i], var_m2 + begin[i], n});
    }
}

}  // namespace
}  // namespace surefoot::elevation::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::elevation {

HWY_EXPORT(reduce_all);

void reduce_cells(const ReductionConfig& config,
                  const std::uint32_t* begin,
                  int cells,
                  const float* z_m,
                  const float* var_m2,
                  CellMeasurement* measured) {
    HWY_DYNAMIC_DISPATCH(reduce_all)(config, begin, cells, z_m, var_m2, measured);
}

}  // namespace surefoot::elevation
#endif  // HWY_ONCE
