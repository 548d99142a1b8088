// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/match_rows.hpp"

#define HWY_WANT_AVX3_DL
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/stereo/match_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "surefoot/core/unknown.hpp"
#include "surefoot/stereo/columns-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace surefoot::stereo::rows::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

std::uint64_t bits_of(hn::ScalableTag<float> d, hn::Mask<hn::ScalableTag<float>> mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    std::uint64_t bits = 0;
    std::memcpy(&bits, bytes, sizeof(bits));
    return bits;
}

void link_row(const float* disparity_px,
              int width,
              float same_px,
              std::uint64_t* HWY_RESTRICT known,
              std::uint64_t* HWY_RESTRICT linked) {
    constexpr int kWord = 64;
    const hn::ScalableTag<float> d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const auto limit = hn::Set(d, same_px);
    float rest[kWord + 1];  // rest of the row, then unknown pixels
    for (int u = 0; u < width; u += kWord) {
        const float* from = disparity_px + u;
        if (u + kWord >= width) {
            std::fill(std::copy(from, disparity_px + width, rest), rest + kWord + 1, kNanF);
            from = rest;
        }
        std::uint64_t known_bits = 0;
        std::uint64_t linked_bits = 0;
        for (int i = 0; i < kWord; i += lanes) {
            const auto here = hn::LoadU(d, from + i);
            const auto step = hn::Abs(hn::Sub(hn::LoadU(d, from + i + 1), here));
            known_bits |= bits_of(d, hn::Eq(here, here)) << i;
            linked_bits |= bits_of(d, hn::Le(step, limit)) << i;
        }
        known[u / kWord] = known_bits;
        linked[u / kWord] = linked_bits;
    }
}

/// Maps an unknown disparity to a value below all known ones, which are positive.
template <class D>
HWY_INLINE hn::Vec<D> ordered(D d, const float* from) {
    const auto value = hn::LoadU(d, from);
    return hn::IfThenElse(hn::IsNaN(value), hn::Set(d, -1.0F), value);
}

void smallest_along_row(const float* disparity_px, int width, float* scratch, float* out) {
    constexpr float kNone = std::numeric_limits<float>::infinity();
    std::fill_n(scratch, kNearby_px, kNone);
    std::fill_n(scratch + kNearby_px + width, kNearby_px, kNone);
    for_columns(0, width, [&](auto d, int u) {
        const auto value = hn::LoadU(d, disparity_px + u);
        const auto known_or_none = hn::IfThenElse(hn::IsNaN(value), hn::Set(d, kNone), value);
        hn::StoreU(known_or_none, d, scratch + kNearby_px + u);
    });
    for_columns(0, width, [&](auto d, int u) {
        auto least = hn::LoadU(d, scratch + u);
        for (int k = 1; k <= 2 * kNearby_px; ++k)
            least = hn::Min(least, hn::LoadU(d, scratch + u + k));
        hn::StoreU(least, d, out + u);
    });
}

void smallest_across_rows(const float* const lines[2 * kNearby_px + 1], int width, float* out) {
    for_columns(0, width, [&](auto d, int u) {
        auto least = hn::LoadU(d, lines[0] + u);
        for (int k = 1; k <= 2 * kNearby_px; ++k)
            least = hn::Min(least, hn::LoadU(d, lines[k] + u));
        hn::StoreU(least, d, out + u);
    });
}

template <class V>
HWY_INLINE void sort(V& a, V& b) {
    const V low = hn::Min(a, b);
    b = hn::Max(a, b);
    a = low;
}

/// Sorts the three values of a column.
template <class D>
HWY_INLINE void sort_column(
    D d, const float* const lines[3], int u, float* low, float* middle, float* high) {
    auto a = ordered(d, lines[0] + u);
    auto b = ordered(d, lines[1] + u);
    auto c = ordered(d, lines[2] + u);
    sort(a, b), sort(b, c), sort(a, b);
    hn::StoreU(a, d, low + u);
    hn::StoreU(b, d, middle + u);
    hn::StoreU(c, d, high + u);
}

template <class V>
HWY_INLINE V middle_of(V a, V b, V c) {
    return hn::Max(hn::Min(a, b), hn::Min(hn::Max(a, b), c));
}

/// Computes the median of nine values in three sorted columns. It is the median of three numbers:
/// the largest low value, the median of the middle values, and the smallest high value. The
/// pointers refer to the previous column.
template <class D>
HWY_INLINE void median_here(
    D d, const float* low, const float* middle, const float* high, float* out) {
    const auto at = [d](const float* from, int k) { return hn::LoadU(d, from + k); };
    const auto lows = hn::Max(hn::Max(at(low, 0), at(low, 1)), at(low, 2));
    const auto middles = middle_of(at(middle, 0), at(middle, 1), at(middle, 2));
    const auto highs = hn::Min(hn::Min(at(high, 0), at(high, 1)), at(high, 2));
    const auto median = middle_of(lows, middles, highs);
    hn::StoreU(hn::IfThenElse(hn::Gt(median, hn::Zero(d)), median, hn::Set(d, kNanF)), d, out);
}

void median_row(const float* const lines[3], int width, float* scratch, float* out) {
    float* const low = scratch + 1;
    float* const middle = low + width + 2;
    float* const high = middle + width + 2;
    for_columns(0, width, [&](auto d, int u) { sort_column(d, lines, u, low, middle, high); });
    for (float* const sorted : {low, middle, high}) {
        sorted[-1] = sorted[0];
        sorted[width] = sorted[width - 1];
    }
    for_columns(0, width, [&](auto d, int u) {
        median_here(d, low + u - 1, middle + u - 1, high + u - 1, out + u);
    });
}

void claim_row(const std::uint8_t* HWY_RESTRICT disparity,
               const std::uint8_t* HWY_RESTRICT cost,
               int width,
               std::int32_t* HWY_RESTRICT place,
               std::uint16_t* HWY_RESTRICT offer) {
    for (int u = 0; u < width; ++u) place[u] = u - disparity[u];
    for (int u = 0; u < width; ++u)
        offer[u] = static_cast<std::uint16_t>(256 * cost[u] + disparity[u]);
}

void select_row(const SelectionRow& row) {
    constexpr int kNoCost = 255;
    const std::uint8_t* HWY_RESTRICT disparity = row.disparity;
    const std::uint8_t* HWY_RESTRICT least = row.cost;
    const std::uint8_t* HWY_RESTRICT cost_below = row.cost_below;
    const std::uint8_t* HWY_RESTRICT cost_above = row.cost_above;
    const std::uint8_t* HWY_RESTRICT second = row.second_cost;
    const std::uint8_t* HWY_RESTRICT claimed = row.claimed;
    float* HWY_RESTRICT out = row.disparity_px;
    const int unique = 100 - row.uniqueness_percent;
    const int tolerance = row.left_right_px;
    for (int u = 0; u < row.width; ++u) {
        const int d = disparity[u];
        const int cost = least[u];
        const int below = cost_below[u];
        const int above = cost_above[u];
        const int apart = std::abs(claimed[u] - d);
        const bool good = static_cast<int>(d != 0) & static_cast<int>(d <= u) &
                          static_cast<int>(second[u] * unique >= 100 * cost) &
                          static_cast<int>(apart <= tolerance);
        // Vertex of the parabola through the costs at -1, 0 and 1. At the ends of the search
        // range one of these costs is missing, so the vertex stays 0.
        const int curvature = below + above - 2 * cost;
        const bool curved = static_cast<int>(below != kNoCost) &
                            static_cast<int>(above != kNoCost) & static_cast<int>(curvature > 0);
        const int divisor = curved ? 2 * curvature : 1;
        const int dividend = curved ? below - above : 0;
        const float vertex = static_cast<float>(dividend) / static_cast<float>(divisor);
        out[u] = good ? static_cast<float>(d) + vertex : kNanF;
    }
}

/// Returns 255 if two disparities differ by more than `limit`, else 0; NaN gives 0.
HWY_INLINE std::uint8_t torn(float a, float b, float limit) {
    return std::abs(a - b) > limit ? 255 : 0;
}

void mark_along_row(const float* d, int width, JumpRule rule, std::uint8_t* HWY_RESTRICT mark) {
    const float step = rule.step_px + rule.slope;
    const float ramp = rule.step_px + rule.slope * static_cast<float>(2 * kRampHalf_px);
    const int r = kRampHalf_px;
    const int last = width - 1;
    const auto beside_end = [&](int u) {
        const std::uint8_t before = u > 0 ? torn(d[u], d[u - 1], step) : std::uint8_t{0};
        const std::uint8_t after = u < last ? torn(d[u], d[u + 1], step) : std::uint8_t{0};
        mark[u] = before > after ? before : after;
    };
    for (int u = 0; u < std::min(r, width); ++u) beside_end(u);
    for (int u = r; u < width - r; ++u) {
        // in range: each comparison gives 0 or 1
        const bool jump =
            static_cast<int>(std::abs(d[u] - d[u - 1]) > step) |
            static_cast<int>(std::abs(d[u] - d[u + 1]) > step) |
            static_cast<int>(std::abs(d[u - r] - d[u + r]) > ramp);  // in range: 0 or 1
        mark[u] = jump ? 255 : 0;
    }
    for (int u = std::max(r, width - r); u < width; ++u) beside_end(u);
}

void mark_ramps_row(const float* HWY_RESTRICT above,
                    const float* HWY_RESTRICT below,
                    int width,
                    JumpRule rule,
                    std::uint8_t* HWY_RESTRICT mark) {
    const float ramp = rule.step_px + rule.slope * static_cast<float>(2 * kRampHalf_px);
    for (int u = 0; u < width; ++u) mark[u] |= torn(above[u], below[u], ramp);
}

/// Returns 255 in the lanes of the mask, else 0.
template <class D>
HWY_INLINE hn::Vec<hn::Rebind<std::uint8_t, D>> bytes_of(D /*d*/, hn::Mask<D> mask) {
    const hn::RebindToSigned<D> d32;
    const hn::Rebind<std::uint8_t, D> d8;
    return hn::DemoteTo(d8, hn::IfThenElseZero(hn::RebindMask(d32, mask), hn::Set(d32, 255)));
}

/// Does the work of mark_down for one register of columns.
template <class D>
HWY_INLINE void mark_down_here(D d,
                               const float* disparity_px,
                               JumpRule rule,
                               float* last_px,
                               float* rows_since,
                               std::uint8_t* mark,
                               std::ptrdiff_t stride) {
    const hn::Rebind<std::uint8_t, D> d8;
    const auto here = hn::LoadU(d, disparity_px);
    const auto last = hn::LoadU(d, last_px);
    const auto since = hn::LoadU(d, rows_since);
    const auto distance = hn::Add(since, hn::Set(d, 1.0F));
    const auto limit = hn::Add(hn::Set(d, rule.step_px), hn::Mul(hn::Set(d, rule.slope), distance));
    const auto torn = hn::Gt(hn::Abs(hn::Sub(here, last)), limit);
    const auto known = hn::Eq(here, here);
    hn::StoreU(hn::IfThenElse(known, here, last), d, last_px);
    hn::StoreU(hn::IfThenElse(known, hn::Zero(d), distance), d, rows_since);
    if (hn::AllFalse(d, torn)) return;
    HWY_ALIGN float sides[hn::MaxLanes(d)];
    hn::Store(hn::IfThenElseZero(torn, distance), d, sides);
    hn::StoreU(hn::Or(hn::LoadU(d8, mark), bytes_of(d, torn)), d8, mark);
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
        // in range: a number of rows of the image
        if (sides[i] > 0.0F) *(mark + i - static_cast<std::ptrdiff_t>(sides[i]) * stride) = 255;
    }
}

void mark_down_row(const float* disparity_px,
                   int width,
                   JumpRule rule,
                   float* last_px,
                   float* rows_since,
                   std::uint8_t* mark,
                   std::ptrdiff_t stride) {
    const auto here = [&](auto d, int u) {
        mark_down_here(d, disparity_px + u, rule, last_px + u, rows_since + u, mark + u, stride);
    };
    const hn::ScalableTag<float> whole;
    const hn::CappedTag<float, 1> single;
    const int lanes = static_cast<int>(hn::Lanes(whole));
    int u = 0;
    for (; u + lanes <= width; u += lanes) here(whole, u);
    for (; u < width; ++u) here(single, u);
}

void count_unknown_row(const float* HWY_RESTRICT d,
                       int width,
                       std::int8_t sign,
                       std::uint8_t* HWY_RESTRICT counts) {
    const auto one = static_cast<std::uint8_t>(sign);
    for (int u = 0; u < width; ++u) {
        const std::uint8_t more = d[u] != d[u] ? one : std::uint8_t{0};
        counts[u] = static_cast<std::uint8_t>(counts[u] + more);
    }
}

void sum_windows_row(const std::uint8_t* counts,
                     int width,
                     int radius,
                     std::uint8_t* HWY_RESTRICT sums) {
    std::fill_n(sums, width, std::uint8_t{0});
    for (int k = -radius; k <= radius; ++k) {
        const std::uint8_t* HWY_RESTRICT beside = counts + k;
        for (int u = 0; u < width; ++u) sums[u] = static_cast<std::uint8_t>(sums[u] + beside[u]);
    }
}

/// Spreads in steps of 1, 2, 4 and 8. Every distance up to kFarthest_px is a sum of these steps.
void spread_along_row(const std::uint8_t* HWY_RESTRICT mark,
                      int width,
                      std::uint8_t* scratch,
                      std::uint8_t* HWY_RESTRICT distance_px) {
    static_assert(kFarthest_px == 1 + 2 + 4 + 8);
    const hn::ScalableTag<std::uint8_t> d8;
    const int lanes = static_cast<int>(hn::Lanes(d8));
    const int padded = width + 2 * kSpreadMargin;
    std::fill_n(scratch, 2 * padded, std::uint8_t{255});
    std::uint8_t* from = scratch + kSpreadMargin;
    std::uint8_t* to = from + padded;
    for (int u = 0; u < width; ++u) from[u] = mark[u] != 0 ? 0 : 255;
    for (int step = 1; step <= kFarthest_px; step *= 2) {
        const auto more = hn::Set(d8, static_cast<std::uint8_t>(step));
        for (int u = 0; u < width; u += lanes) {
            const auto beside =
                hn::Min(hn::LoadU(d8, from + u - step), hn::LoadU(d8, from + u + step));
            const auto longer = hn::SaturatedAdd(beside, more);
            hn::StoreU(hn::Min(hn::LoadU(d8, from + u), longer), d8, to + u);
        }
        // Registers wrote beyond the end of the row. These values are not distances, so they become
        // 255.
        std::fill_n(to + width, kSpreadMargin, std::uint8_t{255});
        std::swap(from, to);
    }
    std::copy_n(from, width, distance_px);
}

template <class D>
HWY_INLINE void spread_here(
    D d8, const std::uint8_t* from, int before, int u, int after, std::uint8_t* to) {
    const auto least = hn::Min(hn::Min(hn::LoadU(d8, from + before), hn::LoadU(d8, from + after)),
                               hn::LoadU(d8, from + u));
    const auto longer = hn::SaturatedAdd(least, hn::Set(d8, std::uint8_t{1}));
    const auto farther = hn::Gt(longer, hn::Set(d8, std::uint8_t{kFarthest_px}));
    const auto counted = hn::IfThenElse(farther, hn::Set(d8, std::uint8_t{255}), longer);
    hn::StoreU(hn::Min(hn::LoadU(d8, to + u), counted), d8, to + u);
}

void spread_across_row(const std::uint8_t* from, int width, std::uint8_t* distance_px) {
    const hn::ScalableTag<std::uint8_t> whole;
    const hn::CappedTag<std::uint8_t, 1> single;
    const int lanes = static_cast<int>(hn::Lanes(whole));
    const int last = width - 1;
    spread_here(single, from, 0, 0, std::min(1, last), distance_px);
    int u = 1;
    for (; u + lanes <= last; u += lanes) spread_here(whole, from, u - 1, u, u + 1, distance_px);
    for (; u < last; ++u) spread_here(single, from, u - 1, u, u + 1, distance_px);
    if (last > 0) spread_here(single, from, last - 1, last, last, distance_px);
}

}  // namespace
}  // namespace surefoot::stereo::rows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::stereo::rows {

HWY_EXPORT(link_row);
HWY_EXPORT(median_row);
HWY_EXPORT(claim_row);
HWY_EXPORT(select_row);
HWY_EXPORT(mark_along_row);
HWY_EXPORT(mark_ramps_row);
HWY_EXPORT(mark_down_row);
HWY_EXPORT(count_unknown_row);
HWY_EXPORT(sum_windows_row);
HWY_EXPORT(smallest_along_row);
HWY_EXPORT(smallest_across_rows);
HWY_EXPORT(spread_along_row);
HWY_EXPORT(spread_across_row);

void link(const float* disparity_px,
          int width,
          float same_px,
          std::uint64_t* known,
          std::uint64_t* linked) {
    HWY_DYNAMIC_DISPATCH(link_row)(disparity_px, width, same_px, known, linked);
}
void median(const float* const lines[3], int width, float* scratch, float* out) {
    HWY_DYNAMIC_DISPATCH(median_row)(lines, width, scratch, out);
}
void claim(const std::uint8_t* disparity,
           const std::uint8_t* cost,
           int width,
           std::int32_t* place,
           std::uint16_t* offer) {
    HWY_DYNAMIC_DISPATCH(claim_row)(disparity, cost, width, place, offer);
}
void select(const SelectionRow& row) {
    HWY_DYNAMIC_DISPATCH(select_row)(row);
}
void mark_along(const float* disparity_px, int width, JumpRule rule, std::uint8_t* mark) {
    HWY_DYNAMIC_DISPATCH(mark_along_row)(disparity_px, width, rule, mark);
}
void mark_ramps(
    const float* above, const float* below, int width, JumpRule rule, std::uint8_t* mark) {
    HWY_DYNAMIC_DISPATCH(mark_ramps_row)(above, below, width, rule, mark);
}
void mark_down(const float* disparity_px,
               int width,
               JumpRule rule,
               float* last_px,
               float* rows_since,
               std::uint8_t* mark,
               std::ptrdiff_t stride) {
    HWY_DYNAMIC_DISPATCH(mark_down_row)
    (disparity_px, width, rule, last_px, rows_since, mark, stride);
}
void count_unknown(const float* disparity_px, int width, std::int8_t sign, std::uint8_t* counts) {
    HWY_DYNAMIC_DISPATCH(count_unknown_row)(disparity_px, width, sign, counts);
}
void sum_windows(const std::uint8_t* counts, int width, int radius, std::uint8_t* sums) {
    HWY_DYNAMIC_DISPATCH(sum_windows_row)(counts, width, radius, sums);
}
void smallest_along(const float* disparity_px, int width, float* scratch, float* out) {
    HWY_DYNAMIC_DISPATCH(smallest_along_row)(disparity_px, width, scratch, out);
}
void smallest_across(const float* const lines[2 * kNearby_px + 1], int width, float* out) {
    HWY_DYNAMIC_DISPATCH(smallest_across_rows)(lines, width, out);
}
void spread_along(const std::uint8_t* mark,
                  int width,
                  std::uint8_t* scratch,
                  std::uint8_t* distance_px) {
    HWY_DYNAMIC_DISPATCH(spread_along_row)(mark, width, scratch, distance_px);
}
void spread_across(const std::uint8_t* from, int width, std::uint8_t* distance_px) {
    HWY_DYNAMIC_DISPATCH(spread_across_row)(from, width, distance_px);
}

}  // namespace surefoot::stereo::rows
#endif  // HWY_ONCE
