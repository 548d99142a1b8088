// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/match_rows.hpp"

#define HWY_WANT_AVX3_DL
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/stereo/match_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace surefoot::stereo::rows::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Known disparities, and less than all of them for an unknown one: they are positive.
template <class D>
HWY_INLINE hn::Vec<D> ordered(D d, const float* from) {
    const auto value = hn::LoadU(d, from);
    return hn::IfThenElse(hn::IsNaN(value), hn::Set(d, -1.0F), value);
}

template <class V>
HWY_INLINE void sort(V& a, V& b) {
    const V low = hn::Min(a, b);
    b = hn::Max(a, b);
    a = low;
}

/// The middle of the nine around `u`, whose neighbours are `before` and `after` it.
template <class D>
HWY_INLINE void median_here(
    D d, const float* const lines[3], int before, int u, int after, float* HWY_RESTRICT out) {
    using V = hn::Vec<D>;
    V p0 = ordered(d, lines[0] + before);
    V p1 = ordered(d, lines[0] + u);
    V p2 = ordered(d, lines[0] + after);
    V p3 = ordered(d, lines[1] + before);
    V p4 = ordered(d, lines[1] + u);
    V p5 = ordered(d, lines[1] + after);
    V p6 = ordered(d, lines[2] + before);
    V p7 = ordered(d, lines[2] + u);
    V p8 = ordered(d, lines[2] + after);
    // 19 exchanges (Paeth 1990).
    sort(p1, p2), sort(p4, p5), sort(p7, p8);
    sort(p0, p1), sort(p3, p4), sort(p6, p7);
    sort(p1, p2), sort(p4, p5), sort(p7, p8);
    sort(p0, p3), sort(p5, p8), sort(p4, p7);
    sort(p3, p6), sort(p1, p4), sort(p2, p5);
    sort(p4, p7), sort(p4, p2), sort(p6, p4), sort(p4, p2);
    hn::StoreU(hn::IfThenElse(hn::Gt(p4, hn::Zero(d)), p4, hn::Set(d, kNan)), d, out + u);
}

void median_row(const float* const lines[3], int width, float* HWY_RESTRICT out) {
    const hn::ScalableTag<float> whole;
    const hn::CappedTag<float, 1> single;
    const int lanes = static_cast<int>(hn::Lanes(whole));
    const int last = width - 1;
    median_here(single, lines, 0, 0, std::min(1, last), out);
    int u = 1;
    for (; u + lanes <= last; u += lanes) median_here(whole, lines, u - 1, u, u + 1, out);
    for (; u < last; ++u) median_here(single, lines, u - 1, u, u + 1, out);
    if (last > 0) median_here(single, lines, last - 1, last, last, out);
}

void settle_row(const SettleRow& row) {
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
        // Vertex of the parabola through the costs at -1, 0 and 1; none beside the ends.
        const int curvature = below + above - 2 * cost;
        const bool curved = static_cast<int>(below != kNoCost) &
                            static_cast<int>(above != kNoCost) & static_cast<int>(curvature > 0);
        const int divisor = curved ? 2 * curvature : 1;
        const int dividend = curved ? below - above : 0;
        const float vertex = static_cast<float>(dividend) / static_cast<float>(divisor);
        out[u] = good ? static_cast<float>(d) + vertex : kNan;
    }
}

/// 255 where two pixels are further apart than `limit`; NaN compares false.
HWY_INLINE std::uint8_t torn(float a, float b, float limit) {
    return std::abs(a - b) > limit ? 255 : 0;
}

/// Jumps across holes, which have no neighbour to compare with.
void mark_across_holes(const float* d, int width, JumpRule rule, std::uint8_t* mark) {
    int last = width;  // the last known pixel
    for (int u = 0; u < width; ++u) {
        if (d[u] != d[u]) continue;
        if (u - last > 1 &&
            torn(d[u], d[last], rule.step_px + rule.slope * static_cast<float>(u - last)))
            mark[u] = mark[last] = 255;
        last = u;
    }
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
        const bool jump = static_cast<int>(std::abs(d[u] - d[u - 1]) > step) |
                          static_cast<int>(std::abs(d[u] - d[u + 1]) > step) |
                          static_cast<int>(std::abs(d[u - r] - d[u + r]) > ramp);
        mark[u] = jump ? 255 : 0;
    }
    for (int u = std::max(r, width - r); u < width; ++u) beside_end(u);
    mark_across_holes(d, width, rule, mark);
}

void mark_ramps_row(const float* HWY_RESTRICT above,
                    const float* HWY_RESTRICT below,
                    int width,
                    JumpRule rule,
                    std::uint8_t* HWY_RESTRICT mark) {
    const float ramp = rule.step_px + rule.slope * static_cast<float>(2 * kRampHalf_px);
    for (int u = 0; u < width; ++u) mark[u] |= torn(above[u], below[u], ramp);
}

void mark_from_last_row(const float* HWY_RESTRICT d,
                        int width,
                        JumpRule rule,
                        float* HWY_RESTRICT last_px,
                        float* HWY_RESTRICT rows_since,
                        std::uint8_t* HWY_RESTRICT mark) {
    for (int u = 0; u < width; ++u) {
        const float distance = rows_since[u] + 1.0F;
        const bool known = d[u] == d[u];
        mark[u] |= torn(d[u], last_px[u], rule.step_px + rule.slope * distance);
        last_px[u] = known ? d[u] : last_px[u];
        rows_since[u] = known ? 0.0F : distance;
    }
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

void unknown_share_row(const std::uint8_t* HWY_RESTRICT counts,
                       int width,
                       int radius,
                       int rows,
                       float* HWY_RESTRICT share) {
    const auto share_at = [&](int u) {
        int unknown = 0;
        for (int k = -radius; k <= radius; ++k) unknown += counts[u + k];
        const int columns = std::min(width - 1, u + radius) - std::max(0, u - radius) + 1;
        return static_cast<float>(unknown) / static_cast<float>(rows * columns);
    };
    const int inner = std::max(radius, width - radius);
    for (int u = 0; u < std::min(radius, width); ++u) share[u] = share_at(u);
    // Inside, where every window is whole, column after column of it for all pixels.
    const auto area = static_cast<float>(rows * (2 * radius + 1));
    constexpr int kChunk = 256;
    std::uint8_t unknown[kChunk];
    for (int first = radius; first < inner; first += kChunk) {
        const int count = std::min(kChunk, inner - first);
        std::fill_n(unknown, kChunk, std::uint8_t{0});
        for (int k = -radius; k <= radius; ++k) {
            for (int i = 0; i < count; ++i)
                unknown[i] = static_cast<std::uint8_t>(unknown[i] + counts[first + k + i]);
        }
        for (int i = 0; i < count; ++i) share[first + i] = static_cast<float>(unknown[i]) / area;
    }
    for (int u = inner; u < width; ++u) share[u] = share_at(u);
}

void nearer_row(const std::uint8_t* HWY_RESTRICT other,
                int steps,
                int farthest,
                int width,
                std::uint8_t* HWY_RESTRICT here) {
    const auto most = static_cast<std::uint8_t>(farthest - steps);
    const auto step = static_cast<std::uint8_t>(steps);
    for (int u = 0; u < width; ++u) {
        const auto longer = static_cast<std::uint8_t>(other[u] + step);
        const std::uint8_t far = other[u] > most ? std::uint8_t{255} : longer;
        here[u] = here[u] < far ? here[u] : far;
    }
}

}  // namespace
}  // namespace surefoot::stereo::rows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::stereo::rows {

HWY_EXPORT(median_row);
HWY_EXPORT(settle_row);
HWY_EXPORT(mark_along_row);
HWY_EXPORT(mark_ramps_row);
HWY_EXPORT(mark_from_last_row);
HWY_EXPORT(count_unknown_row);
HWY_EXPORT(unknown_share_row);
HWY_EXPORT(nearer_row);

void median(const float* const lines[3], int width, float* out) {
    HWY_DYNAMIC_DISPATCH(median_row)(lines, width, out);
}
void settle(const SettleRow& row) {
    HWY_DYNAMIC_DISPATCH(settle_row)(row);
}
void mark_along(const float* disparity_px, int width, JumpRule rule, std::uint8_t* mark) {
    HWY_DYNAMIC_DISPATCH(mark_along_row)(disparity_px, width, rule, mark);
}
void mark_ramps(
    const float* above, const float* below, int width, JumpRule rule, std::uint8_t* mark) {
    HWY_DYNAMIC_DISPATCH(mark_ramps_row)(above, below, width, rule, mark);
}
void mark_from_last(const float* disparity_px,
                    int width,
                    JumpRule rule,
                    float* last_px,
                    float* rows_since,
                    std::uint8_t* mark) {
    HWY_DYNAMIC_DISPATCH(mark_from_last_row)
    (disparity_px, width, rule, last_px, rows_since, mark);
}

void count_unknown(const float* disparity_px, int width, std::int8_t sign, std::uint8_t* counts) {
    HWY_DYNAMIC_DISPATCH(count_unknown_row)(disparity_px, width, sign, counts);
}
void unknown_share(const std::uint8_t* counts, int width, int radius, int rows, float* share) {
    HWY_DYNAMIC_DISPATCH(unknown_share_row)(counts, width, radius, rows, share);
}
void nearer(const std::uint8_t* other, int steps, int farthest, int width, std::uint8_t* here) {
    HWY_DYNAMIC_DISPATCH(nearer_row)(other, steps, farthest, width, here);
}

}  // namespace surefoot::stereo::rows
#endif  // HWY_ONCE
