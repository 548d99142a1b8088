// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/reduce_cells.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/elevation/fusion/reduce_cells.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

// `SmallCells` reduces cells with at most sixteen samples, one cell per lane. `reduce` processes
// sixteen samples of one cell at a time, in one, two or four registers. It reduces larger cells,
// and small cells whose highest samples are isolated. Every float sum first fills sixteen columns
// and then adds the columns in one fixed tree, as `LaneSum` does. So the register width does not
// change the result. Most cells hold no more than sixteen samples.

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
/// Largest rank that is found by removing one extreme after the other. Higher ranks are found bit
/// by bit.
constexpr int kFewRanks = 32;

/// Samples of one cell.
struct Samples {
    const float* z_m;
    const float* var_m2;
    int n;
};

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE float sum_of(const V (&part)[kParts]) {
    float column[16];
    for (int p = 0; p < kParts; ++p) hn::Store(part[p], D(), column + p * kWidth);
    return tree(column);
}
#else
template <class DV, class W>
HWY_INLINE auto add_halves(DV, W value) {
    const hn::Half<DV> half;
    return hn::Add(hn::LowerHalf(half, value), hn::UpperHalf(half, value));
}

/// Adds columns i, i + 4, i + 8 and i + 12 for i from 0 to 3.
template <int kHere>
HWY_INLINE auto four_of(const V (&part)[kHere]) {
    if constexpr (kHere == 1) {
        return add_halves(hn::Half<D>(), add_halves(D(), part[0]));
    } else if constexpr (kHere == 2) {
        return add_halves(D(), hn::Add(part[0], part[1]));
    } else {
        return hn::Add(hn::Add(part[0], part[2]), hn::Add(part[1], part[3]));
    }
}

/// Computes `tree` in registers: ((0 + 8) + (4 + 12)) + ((2 + 10) + (6 + 14)), ...
HWY_INLINE float sum_of(const V (&part)[kParts]) {
    const auto four = four_of(part);
    const auto two = hn::Add(four, hn::Shuffle1032(four));
    return hn::GetLane(hn::Add(two, hn::Shuffle2301(two)));
}
#endif

/// Sixteen columns of a sum.
struct Columns {
    V part[kParts];

    HWY_INLINE Columns() {
        for (V& p : part) p = hn::Zero(D());
    }
    HWY_INLINE void add(int p, V value) { part[p] = hn::Add(part[p], value); }
    HWY_INLINE float total() const { return sum_of(part); }
};

HWY_INLINE M present(int index, int n) {
    return hn::FirstN(D(), static_cast<std::size_t>(n > index ? n - index : 0));
}

/// Calls f(part, offset of its first sample, mask of its existing samples). `kFew`: the cell has at
/// most sixteen samples.
template <bool kFew, class F>
HWY_INLINE void for_each_part(int n, const F& f) {
    if constexpr (kFew) {
        for (int p = 0; p < kParts; ++p) f(p, p * kWidth, present(p * kWidth, n));
    } else {
        for (int i = 0; i < n; i += 16) {
            for (int p = 0; p < kParts; ++p) {
                const int at = i + p * kWidth;
                f(p, at, present(at, n));
            }
        }
    }
}

HWY_INLINE int count_from(const Samples& samples, V flip, V least) {
    std::size_t count = 0;
    for_each_part<false>(samples.n, [&](int, int at, M exists) {
        const V value = hn::Xor(hn::LoadU(D(), samples.z_m + at), flip);
        count += hn::CountTrue(D(), hn::And(exists, hn::Ge(value, least)));
    });
    return static_cast<int>(count);
}

/// Returns the value with `rank` values at or above it. Removes the largest value again and
/// again.
HWY_INLINE float by_extremes(const Samples& samples, V flip, int rank) {
    V below = hn::Set(D(), kInfinity);
    std::size_t from_below = 0;  // number of values at or above `below`
    while (true) {
        V largest = hn::Set(D(), -kInfinity);
        for_each_part<false>(samples.n, [&](int, int at, M exists) {
            const V value = hn::Xor(hn::LoadU(D(), samples.z_m + at), flip);
            const M less = hn::And(exists, hn::Lt(value, below));
            from_below += hn::CountTrue(D(), hn::And(exists, hn::Eq(value, below)));
            largest = hn::IfThenElse(less, hn::Max(largest, value), largest);
        });
        if (from_below >= static_cast<std::size_t>(rank)) return hn::GetLane(below);
        below = hn::MaxOfLanes(D(), largest);
        if (hn::GetLane(below) == -kInfinity) return -kInfinity;
    }
}

/// Returns the same value as `by_extremes`, found bit by bit. Maps floats to unsigned integers that
/// have the same order.
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
        // In integer order NaN lies beyond infinity on either side: no value is above +NaN, and all
        // values are above -NaN.
        const bool is_reached = std::isnan(least)
                                    ? (key | bit) < 0x80000000U
                                    : count_from(samples, flip, hn::Set(D(), least)) >= rank;
        if (is_reached) key |= bit;
    }
    return float_of(key);
}

/// Heights by their rank among many samples.
struct RanksOfMany {
    const Samples& samples;

    /// Returns the height with `rank` samples at or above it (rank 1 = the maximum). With
    /// `from_below`, counts samples at or below the height.
    HWY_INLINE float ranked(bool from_below, int rank) const {
        const V flip = hn::Set(D(), from_below ? -0.0F : 0.0F);
        const float value = rank <= kFewRanks ? by_extremes(samples, flip, rank)
                                              : by_bits(samples, from_below, rank);
        return (from_below ? -value : value) + 0.0F;  // removes the sign of zero
    }
};

/// Heights by their rank among up to sixteen samples. Counts for each sample how many samples are
/// at least as high, and how many at least as low.
struct RanksOfFew {
    V z_m[kParts];
    V as_high[kParts];  ///< number of samples at or above this one; 0 if absent
    V as_low[kParts];

    HWY_INLINE explicit RanksOfFew(const Samples& samples) {
        const V one = hn::Set(D(), 1.0F);
        for (int p = 0; p < kParts; ++p) {
            z_m[p] = hn::LoadU(D(), samples.z_m + p * kWidth);
            as_high[p] = hn::Zero(D());
            as_low[p] = hn::Zero(D());
        }
        for (int i = 0; i < samples.n; ++i) {
            const V other = hn::Set(D(), samples.z_m[i]);
            for (int p = 0; p < kParts; ++p) {
                as_high[p] = hn::Add(as_high[p], hn::IfThenElseZero(hn::Ge(other, z_m[p]), one));
                as_low[p] = hn::Add(as_low[p], hn::IfThenElseZero(hn::Le(other, z_m[p]), one));
            }
        }
        for (int p = 0; p < kParts; ++p) {
            const M exists = present(p * kWidth, samples.n);
            as_high[p] = hn::IfThenElseZero(exists, as_high[p]);
            as_low[p] = hn::IfThenElseZero(exists, as_low[p]);
        }
    }

    HWY_INLINE float ranked(bool from_below, int rank) const {
        const V least = hn::Set(D(), static_cast<float>(rank));
        const V none = hn::Set(D(), from_below ? kInfinity : -kInfinity);
        V best = none;
        for (int p = 0; p < kParts; ++p) {
            const M enough = hn::Ge(from_below ? as_low[p] : as_high[p], least);
            const V value = hn::IfThenElse(enough, z_m[p], none);
            best = from_below ? hn::Min(best, value) : hn::Max(best, value);
        }
        const V extreme = from_below ? hn::MinOfLanes(D(), best) : hn::MaxOfLanes(D(), best);
        return hn::GetLane(extreme) + 0.0F;  // removes the sign of zero
    }
};

/// Number of the points within a window around a height, and the sum of their offsets from it.
struct Window {
    std::size_t points = 0;
    float sum_m = 0.0F;
};

template <bool kFew>
HWY_INLINE Window window_around(const Samples& samples, float center_m, float half_width_m) {
    const V center = hn::Set(D(), center_m);
    const V half_width = hn::Set(D(), half_width_m);
    Columns sum_m;
    Window window;
    for_each_part<kFew>(samples.n, [&](int p, int at, M exists) {
        const V offset = hn::Sub(hn::LoadU(D(), samples.z_m + at), center);
        const M near = hn::And(exists, hn::Le(hn::Abs(offset), half_width));
        window.points += hn::CountTrue(D(), near);
        sum_m.add(p, hn::IfThenElseZero(near, offset));
    });
    window.sum_m = sum_m.total();
    return window;
}

template <bool kFew>
HWY_INLINE Surface surface_around(const Samples& samples, float center_m, float half_width_m) {
    const V center = hn::Set(D(), center_m);
    const V half_width = hn::Set(D(), half_width_m);
    Columns sum_m;
    Columns sum_sq_m2;
    Columns sum_var_m2;
    std::size_t points = 0;
    for_each_part<kFew>(samples.n, [&](int p, int at, M exists) {
        const V offset = hn::Sub(hn::LoadU(D(), samples.z_m + at), center);
        const M near = hn::And(exists, hn::Le(hn::Abs(offset), half_width));
        points += hn::CountTrue(D(), near);
        const V counted = hn::IfThenElseZero(near, offset);
        sum_m.add(p, counted);
        sum_sq_m2.add(p, hn::Mul(counted, counted));
        sum_var_m2.add(p, hn::IfThenElseZero(near, hn::LoadU(D(), samples.var_m2 + at)));
    });
    if (points == 0) return {};
    return surface_of(
        static_cast<int>(points), center_m, sum_m.total(), sum_sq_m2.total(), sum_var_m2.total());
}

/// Finds a surface by mean shift. The steps need only the position of the surface, not its spread.
template <bool kFew>
HWY_INLINE Surface climb(const Samples& samples, float start_m, float half_width_m) {
    float center_m = start_m;
    for (int round = 1; round < kClimbs; ++round) {
        const Window window = window_around<kFew>(samples, center_m, half_width_m);
        if (window.points == 0) return {};
        center_m += window.sum_m / static_cast<float>(window.points);
    }
    return surface_around<kFew>(samples, center_m, half_width_m);
}

template <bool kFew>
HWY_INLINE float mean_variance(const Samples& samples) {
    Columns sum_m2;
    for_each_part<kFew>(samples.n, [&](int p, int at, M exists) {
        sum_m2.add(p, hn::IfThenElseZero(exists, hn::LoadU(D(), samples.var_m2 + at)));
    });
    return sum_m2.total() / static_cast<float>(samples.n);
}

template <bool kFew, class Ranks>
HWY_INLINE CellMeasurement
reduce(const ReductionConfig& config, const Samples& samples, int support, const Ranks& ranks) {
    CellMeasurement measured;
    measured.lowest_m = ranks.ranked(true, support);
    measured.highest_m = ranks.ranked(false, support);
    const float half_width_m = half_width(config, mean_variance<kFew>(samples));
    float start_m = measured.highest_m;
    int rank = support;
    for (int attempt = 0; attempt < kMaxTries; ++attempt) {
        const Surface surface = climb<kFew>(samples, start_m, half_width_m);
        if (surface.points >= support) {
            measured.z_m = surface.mean_m;
            measured.var_m2 = measurement_variance(config, surface);
            measured.points = surface.points;
            return measured;
        }
        rank += support;
        if (rank > samples.n) break;
        start_m = ranks.ranked(false, rank);
    }
    return face_of(config, measured, samples.n, half_width_m);
}

CellMeasurement reduce(const ReductionConfig& config, const Samples& samples) {
    const int support = support_of(config, samples.n);
    if (samples.n < support) return {};
    return samples.n <= 16 ? reduce<true>(config, samples, support, RanksOfFew(samples))
                           : reduce<false>(config, samples, support, RanksOfMany{samples});
}

/// Reduces one cell per lane, each with up to kMost samples. Column i holds sample i of all cells.
/// The sum over a cell adds columns in the order of `tree`.
template <int kMost>
class SmallCells {
  public:
    SmallCells(const ReductionConfig& config, const float* z_m, const float* var_m2)
        : config_(config), z_m_(z_m), var_m2_(var_m2) {}

    /// Adds a cell with enough support; the next `reduce_all` writes `measured`.
    HWY_INLINE void add(std::uint32_t begin, int n, int support, CellMeasurement* measured) {
        begin_[cells_] = static_cast<std::int32_t>(begin);
        n_[cells_] = static_cast<float>(n);
        support_[cells_] = static_cast<float>(support);
        measured_[cells_] = measured;
        if (++cells_ == kLanes) reduce_all();
    }

    HWY_NOINLINE void reduce_all() {
        if (cells_ == 0) return;
        load();
        HWY_ALIGN float highest_m[kWidth];
        HWY_ALIGN float lowest_m[kWidth];
        rank(highest_m, lowest_m);
        HWY_ALIGN float half_width_m[kWidth];
        half_widths(half_width_m);
        V center = hn::Load(D(), highest_m);
        const V half_width = hn::Load(D(), half_width_m);
        for (int round = 1; round < kClimbs; ++round) center = climbed(center, half_width);
        finish(center, half_width, highest_m, lowest_m);
        cells_ = 0;
    }

  private:
    static constexpr auto kLanes = static_cast<std::size_t>(kWidth);
    using PerSample = V[static_cast<std::size_t>(kMost)];

    HWY_INLINE M exists(int i) const {
        return hn::Lt(hn::Set(D(), static_cast<float>(i)), hn::Load(D(), n_));
    }
    /// Computes `tree`. The columns from kMost on are zero.
    static HWY_INLINE V sum_of(const PerSample& column) {
        V four[4];
        for (int i = 0; i < 4; ++i) {
            if constexpr (kMost == 16) {
                four[i] = hn::Add(hn::Add(column[i], column[i + 8]),
                                  hn::Add(column[i + 4], column[i + 12]));
            } else {
                four[i] = hn::Add(column[i], column[i + 4]);
            }
        }
        return hn::Add(hn::Add(four[0], four[2]), hn::Add(four[1], four[3]));
    }

    HWY_INLINE void load() {
        for (std::size_t k = cells_; k < kLanes; ++k) {
            begin_[k] = begin_[0];
            n_[k] = 0.0F;
        }
        const hn::RebindToSigned<D> di;
        const auto begin = hn::Load(di, begin_);
        for (int i = 0; i < kMost; ++i) z_[i] = hn::GatherIndex(D(), z_m_ + i, begin);
    }

    /// Sorts by Batcher's odd-even merges; absent samples come last.
    HWY_INLINE void rank(float* highest_m, float* lowest_m) const {
        PerSample sorted;
        for (int i = 0; i < kMost; ++i)
            sorted[i] = hn::IfThenElse(exists(i), z_[i], hn::Set(D(), kInfinity));
        for (int p = 1; p < kMost; p *= 2) {
            for (int k = p; k > 0; k /= 2) {
                for (int i = k % p; i + k < kMost; ++i) {
                    if ((i - k % p) % (2 * k) >= k || i / (2 * p) != (i + k) / (2 * p)) continue;
                    const V low = hn::Min(sorted[i], sorted[i + k]);
                    sorted[i + k] = hn::Max(sorted[i], sorted[i + k]);
                    sorted[i] = low;
                }
            }
        }
        const V support = hn::Load(D(), support_);
        const V from_above = hn::Sub(hn::Load(D(), n_), support);
        const V from_below = hn::Sub(support, hn::Set(D(), 1.0F));
        V highest = hn::Zero(D());
        V lowest = hn::Zero(D());
        for (int i = 0; i < kMost; ++i) {
            const V at = hn::Set(D(), static_cast<float>(i));
            highest = hn::IfThenElse(hn::Eq(at, from_above), sorted[i], highest);
            lowest = hn::IfThenElse(hn::Eq(at, from_below), sorted[i], lowest);
        }
        // Adding 0 removes the sign of zero.
        hn::Store(hn::Add(highest, hn::Zero(D())), D(), highest_m);
        hn::Store(hn::Add(lowest, hn::Zero(D())), D(), lowest_m);
    }

    HWY_INLINE void half_widths(float* half_width_m) const {
        const hn::RebindToSigned<D> di;
        const auto begin = hn::Load(di, begin_);
        PerSample column;
        for (int i = 0; i < kMost; ++i) {
            const V var = hn::GatherIndex(D(), var_m2_ + i, begin);
            column[i] = hn::IfThenElseZero(exists(i), var);
        }
        HWY_ALIGN float mean_m2[kWidth];
        hn::Store(hn::Div(sum_of(column), hn::Load(D(), n_)), D(), mean_m2);
        for (std::size_t k = 0; k < cells_; ++k) half_width_m[k] = half_width(config_, mean_m2[k]);
        std::fill(half_width_m + cells_, half_width_m + kWidth, 0.0F);
    }

    /// Selects the samples near the centres, and returns their offsets.
    HWY_INLINE M near(int i, V center, V half_width, V& offset) const {
        offset = hn::Sub(z_[i], center);
        return hn::And(exists(i), hn::Le(hn::Abs(offset), half_width));
    }

    /// Returns the mean of the samples near `center`. Returns NaN if no sample is near; later steps
    /// then also find no sample.
    HWY_INLINE V climbed(V center, V half_width) const {
        V points = hn::Zero(D());
        PerSample column;
        for (int i = 0; i < kMost; ++i) {
            V offset;
            const M counts = near(i, center, half_width, offset);
            points = hn::Add(points, hn::IfThenElseZero(counts, hn::Set(D(), 1.0F)));
            column[i] = hn::IfThenElseZero(counts, offset);
        }
        return hn::Add(center, hn::Div(sum_of(column), points));
    }

    HWY_INLINE void finish(V center, V half_width, const float* highest_m, const float* lowest_m) {
        const hn::RebindToSigned<D> di;
        const auto begin = hn::Load(di, begin_);
        V points = hn::Zero(D());
        PerSample offsets;
        PerSample squares;
        PerSample variances;
        for (int i = 0; i < kMost; ++i) {
            V offset;
            const M counts = near(i, center, half_width, offset);
            const V var = hn::GatherIndex(D(), var_m2_ + i, begin);
            points = hn::Add(points, hn::IfThenElseZero(counts, hn::Set(D(), 1.0F)));
            offsets[i] = hn::IfThenElseZero(counts, offset);
            squares[i] = hn::Mul(offsets[i], offsets[i]);
            variances[i] = hn::IfThenElseZero(counts, var);
        }
        HWY_ALIGN float figures[5][kWidth];
        hn::Store(points, D(), figures[0]);
        hn::Store(center, D(), figures[1]);
        hn::Store(sum_of(offsets), D(), figures[2]);
        hn::Store(sum_of(squares), D(), figures[3]);
        hn::Store(sum_of(variances), D(), figures[4]);
        for (std::size_t k = 0; k < cells_; ++k) {
            CellMeasurement& measured = *measured_[k];
            if (figures[0][k] < support_[k]) {
                // The highest samples are isolated: try lower starts, one cell after the other.
                const int n = static_cast<int>(n_[k]);  // in range: a number of points
                measured = reduce(config_, {z_m_ + begin_[k], var_m2_ + begin_[k], n});
                continue;
            }
            // in range: a number of points, at most n
            const Surface surface = surface_of(static_cast<int>(figures[0][k]),
                                               figures[1][k],
                                               figures[2][k],
                                               figures[3][k],
                                               figures[4][k]);
            measured = {surface.mean_m,
                        measurement_variance(config_, surface),
                        highest_m[k],
                        lowest_m[k],
                        surface.points};
        }
    }

    const ReductionConfig& config_;
    const float* z_m_;
    const float* var_m2_;
    HWY_ALIGN std::int32_t begin_[kWidth] = {};
    HWY_ALIGN float n_[kWidth] = {};
    HWY_ALIGN float support_[kWidth] = {};
    CellMeasurement* measured_[kWidth] = {};
    std::size_t cells_ = 0;
    PerSample z_;
};

void reduce_all(const ReductionConfig& config,
                const std::uint32_t* begin,
                int cells,
                const float* z_m,
                const float* var_m2,
                CellMeasurement* measured) {
    constexpr int kFew = 8;
    constexpr int kSome = 16;
    SmallCells<kFew> few(config, z_m, var_m2);
    SmallCells<kSome> some(config, z_m, var_m2);
    int support[kSome + 1];
    for (int n = 0; n <= kSome; ++n) support[n] = support_of(config, n);
    for (int i = 0; i < cells; ++i) {
        const auto n = static_cast<int>(begin[i + 1] - begin[i]);
        if (n > kSome) {
            measured[i] = reduce(config, {z_m + begin[i], var_m2 + begin[i], n});
        } else if (n < support[n]) {
            measured[i] = {};
        } else if (n > kFew) {
            some.add(begin[i], n, support[n], measured + i);
        } else {
            few.add(begin[i], n, support[n], measured + i);
        }
    }
    few.reduce_all();
    some.reduce_all();
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
