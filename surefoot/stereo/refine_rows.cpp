// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/refine_rows.hpp"

#define HWY_WANT_AVX3_DL
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/stereo/refine_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "surefoot/stereo/columns-inl.hpp"
#include "surefoot/stereo/confidence.hpp"
#include "surefoot/stereo/consistency.hpp"
#include "surefoot/stereo/divisor.hpp"

HWY_BEFORE_NAMESPACE();
namespace surefoot::stereo::rows::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Grey levels are stored in sixteenths.
constexpr float kScale = 16.0F;
/// Limit of a grey difference, 32 grey levels. A larger difference means another point; its size
/// does not matter.
constexpr float kMaxError = 512.0F;
/// Limit of a gradient, 64 grey levels per pixel. The sum of 33 x 33 squares of this limit fits an
/// int32: 1089 * 1024^2 = 1.1e9.
constexpr float kMaxGradient = 1024.0F;

void smooth_image_row(const std::uint8_t* const in[3],
                      int width,
                      std::uint16_t* HWY_RESTRICT scratch,
                      std::int16_t* HWY_RESTRICT out) {
    std::uint16_t* HWY_RESTRICT sum = scratch + 1;
    const std::uint8_t* const above = in[0];
    const std::uint8_t* const here = in[1];
    const std::uint8_t* const below = in[2];
    for (int u = 0; u < width; ++u)
        sum[u] = static_cast<std::uint16_t>(above[u] + 2 * here[u] + below[u]);
    sum[-1] = sum[0];
    sum[width] = sum[width - 1];
    for (int u = 0; u < width; ++u)
        out[u] = static_cast<std::int16_t>(sum[u - 1] + 2 * sum[u] + sum[u + 1]);
}

/// Averages the lanes from `u` on with their neighbours in `steps` lines on either side.
template <class D>
HWY_INLINE void smooth_here(D d, const SmoothRow& row, int steps, int u) {
    const auto center = hn::LoadU(d, row.center + u);
    const auto limit = hn::Set(d, row.same_surface_px);
    auto sum = hn::Zero(d);
    auto count = hn::Set(d, 1.0F);
    for (int k = 0; k < steps; ++k) {
        const auto low = hn::Sub(hn::LoadU(d, row.before[k] + u), center);
        const auto high = hn::Sub(hn::LoadU(d, row.after[k] + u), center);
        // NaN compares false.
        const auto same = hn::And(hn::Le(hn::Abs(low), limit), hn::Le(hn::Abs(high), limit));
        sum = hn::Add(sum, hn::IfThenElseZero(same, hn::Add(low, high)));
        count = hn::Add(count, hn::IfThenElseZero(same, hn::Set(d, 2.0F)));
    }
    hn::StoreU(hn::Add(center, hn::Div(sum, count)), d, row.out + u);
}

void smooth_along_row(const SmoothRow& row) {
    for_columns(0, row.width, [&](auto d, int u) { smooth_here(d, row, row.steps, u); });
}

/// Writes the position in the right row of the lanes from `u` on: whole pixel (0 = outside the row
/// or beside a jump) and fraction.
template <class D>
HWY_INLINE void place_here(D d, const WarpRow& row, int u) {
    const hn::RebindToSigned<D> d32;
    const hn::Rebind<std::uint8_t, D> d8;
    const auto column = hn::ConvertTo(d, hn::Iota(d32, u));
    const auto x = hn::Sub(column, hn::LoadU(d, row.disparity_px + u));
    const auto jump_px =
        hn::ConvertTo(d, hn::PromoteTo(d32, hn::LoadU(d8, row.jump_distance_px + u)));
    const auto far = hn::Gt(jump_px, hn::Set(d, static_cast<float>(row.jump_margin_px)));
    // NaN compares false. The gradients need one more column on each side.
    const auto inside = hn::And(hn::Ge(x, hn::Set(d, 1.0F)),
                                hn::Lt(x, hn::Set(d, static_cast<float>(row.width - 3))));
    const auto kept = hn::IfThenElseZero(hn::And(inside, far), x);
    const auto place = hn::ConvertTo(d32, kept);
    hn::StoreU(place, d32, row.place + u);
    hn::StoreU(hn::Sub(kept, hn::ConvertTo(d, place)), d, row.fraction + u);
}

/// Loads the four pixels of the right row around each position, side by side. A separate gather of
/// each pixel would take four times as many loads.
void take_pairs(const WarpRow& row) {
    const std::int16_t* HWY_RESTRICT right = row.right;
    const std::int32_t* HWY_RESTRICT place = row.place;
    std::int32_t* HWY_RESTRICT pairs = row.pairs;
    // A local copy, because the compiler must assume that the stores below change `row`.
    const int end = row.width - 1;
    for (int u = 1; u < end; ++u)
        std::memcpy(pairs + 2 * u, right + place[u] - 1, 2 * sizeof(std::int32_t));
}

/// Loads the pixel pairs of the lanes from `u` on: `front` lies left of the fractional position,
/// `back` right of this position.
template <class D32>
HWY_INLINE void load_pairs(
    D32 d32, const WarpRow& row, int u, hn::Vec<D32>& front, hn::Vec<D32>& back) {
    const std::int32_t* const pairs = row.pairs + 2 * u;
    if constexpr (hn::MaxLanes(d32) == 1) {
        front = hn::LoadU(d32, pairs);
        back = hn::LoadU(d32, pairs + 1);
    }
#if HWY_TARGET != HWY_SCALAR
    else {
        const auto low = hn::LoadU(d32, pairs);
        const auto high = hn::LoadU(d32, pairs + hn::Lanes(d32));
        front = hn::ConcatEven(d32, high, low);
        back = hn::ConcatOdd(d32, high, low);
    }
#endif
}

/// Returns the nearest integers of |x| < 4096. Halves round up.
template <class D>
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> rounded(D d, hn::Vec<D> x) {
    const hn::RebindToSigned<D> d32;
    const auto shifted = hn::ConvertTo(d32, hn::Add(x, hn::Set(d, 4096.5F)));
    return hn::Sub(shifted, hn::Set(d32, 4096));
}

template <class D>
HWY_INLINE void warp_here(D d, const WarpRow& row, int u) {
    const hn::RebindToSigned<D> d32;
    const hn::Rebind<std::int16_t, D> d16;
    const auto lower_half = hn::Set(d32, 0xffff);
    const auto left = [&](int at) { return hn::PromoteTo(d32, hn::LoadU(d16, row.left + at)); };
    const auto real = [&](auto whole) { return hn::ConvertTo(d, whole); };
    auto front = hn::Zero(d32);
    auto back = hn::Zero(d32);
    load_pairs(d32, row, u, front, back);
    // No pixel value is negative, so the upper half of a word needs no sign.
    const auto before = hn::And(front, lower_half);
    const auto low = hn::ShiftRight<16>(front);
    const auto high = hn::And(back, lower_half);
    const auto after = hn::ShiftRight<16>(back);
    const auto s = hn::LoadU(d, row.fraction + u);
    const auto seen = hn::Add(real(low), hn::Mul(s, real(hn::Sub(high, low))));
    const auto error = hn::Sub(real(left(u)), seen);
    const auto slope_right =
        hn::Add(hn::Mul(hn::Sub(hn::Set(d, 1.0F), s), real(hn::Sub(high, before))),
                hn::Mul(s, real(hn::Sub(after, low))));
    const auto slope_left = real(hn::Sub(left(u + 1), left(u - 1)));
    const auto slope = hn::Mul(hn::Set(d, 0.25F), hn::Add(slope_left, slope_right));
    const auto kept = hn::Min(hn::Max(slope, hn::Set(d, -kMaxGradient)), hn::Set(d, kMaxGradient));
    const auto valid = hn::And(hn::Gt(hn::LoadU(d32, row.place + u), hn::Zero(d32)),
                               hn::RebindMask(d32, hn::Le(hn::Abs(error), hn::Set(d, kMaxError))));
    const auto pair =
        hn::Or(hn::ShiftLeft<16>(rounded(d, error)), hn::And(rounded(d, kept), lower_half));
    hn::StoreU(hn::IfThenElse(valid, pair, hn::Set(d32, kUnused)), d32, row.evidence + u);
}

void warp_row(const WarpRow& row) {
    const int width = row.width;
    if (width < 5) return static_cast<void>(std::fill_n(row.evidence, width, kUnused));
    row.evidence[0] = row.evidence[width - 1] = kUnused;
    for_columns(1, width - 1, [&](auto d, int u) { place_here(d, row, u); });
    take_pairs(row);
    for_columns(1, width - 1, [&](auto d, int u) { warp_here(d, row, u); });
}

void slide_row(const std::int32_t* HWY_RESTRICT entering,
               const std::int32_t* HWY_RESTRICT leaving,
               int width,
               std::int32_t* const sums[kSums]) {
    std::int32_t* HWY_RESTRICT count_error = sums[0];
    std::int32_t* HWY_RESTRICT sum_g = sums[1];
    std::int32_t* HWY_RESTRICT sum_gg = sums[2];
    std::int32_t* HWY_RESTRICT sum_ge = sums[3];
    std::int32_t* HWY_RESTRICT sum_ee = sums[4];
    for (int u = 0; u < width; ++u) {
        const std::int32_t a = entering[u];
        const std::int32_t b = leaving[u];
        const std::int32_t a_used = a != kUnused ? 1 : 0;
        const std::int32_t b_used = b != kUnused ? 1 : 0;
        const std::int32_t a_g = static_cast<std::int16_t>(a);
        const std::int32_t b_g = static_cast<std::int16_t>(b);
        const std::int32_t a_e = a != kUnused ? a >> 16 : 0;
        const std::int32_t b_e = b != kUnused ? b >> 16 : 0;
        count_error[u] += (a_e - b_e) * kCounted + (a_used - b_used);
        sum_g[u] += a_g - b_g;
        sum_gg[u] += (a_g - b_g) * (a_g + b_g);
        sum_ge[u] += a_g * a_e - b_g * b_e;
        sum_ee[u] += (a_e - b_e) * (a_e + b_e);
    }
}

/// Returns prefix sums over the lanes.
template <class D32>
HWY_INLINE hn::Vec<D32> sums_so_far(D32 d32, hn::Vec<D32> x) {
    const auto lane = hn::Iota(d32, 0);
    for (int step = 1; step < static_cast<int>(hn::Lanes(d32)); step *= 2) {
        const auto from = hn::Sub(lane, hn::Set(d32, step));
        const auto inside = hn::Gt(from, hn::Set(d32, -1));
        const auto index = hn::IndicesFromVec(d32, hn::Max(from, hn::Zero(d32)));
        x = hn::Add(x, hn::IfThenElseZero(inside, hn::TableLookupLanes(x, index)));
    }
    return x;
}

/// Computes prefix[k][u + radius + 1] = sum of columns[k][0 ... u]; 0 before the start, the total
/// beyond the end. The prefix sums may wrap around. Differences of prefix sums are still correct if
/// they fit in 32 bits.
void sum_up(const SolveRow& row) {
    const hn::ScalableTag<std::int32_t> d32;
    const int lanes = static_cast<int>(hn::Lanes(d32));
    const auto last_lane = hn::IndicesFromVec(d32, hn::Set(d32, lanes - 1));
    for (int k = 0; k < kSums; ++k) {
        std::fill_n(row.prefix[k], row.radius_px + 1, 0);
        std::int32_t* HWY_RESTRICT prefix = row.prefix[k] + row.radius_px + 1;
        const std::int32_t* HWY_RESTRICT column = row.columns[k];
        auto before = hn::Zero(d32);
        for (int u = 0; u < row.width + row.radius_px; u += lanes) {
            const auto here = sums_so_far(d32, hn::LoadU(d32, column + u));
            const auto sum = hn::Add(before, here);
            hn::StoreU(sum, d32, prefix + u);
            before = hn::TableLookupLanes(sum, last_lane);
        }
    }
}

void solve_row(const SolveRow& row) {
    sum_up(row);
    const int span = 2 * row.radius_px + 1;
    const std::int32_t* HWY_RESTRICT count_error = row.prefix[0];
    const std::int32_t* HWY_RESTRICT pg = row.prefix[1];
    const std::int32_t* HWY_RESTRICT pgg = row.prefix[2];
    const std::int32_t* HWY_RESTRICT pge = row.prefix[3];
    const std::int32_t* HWY_RESTRICT pee = row.prefix[4];
    float* HWY_RESTRICT disparity_px = row.disparity_px;
    float* HWY_RESTRICT shift_px = row.shift_px;
    float* HWY_RESTRICT residual = row.residual_grey;
    float* HWY_RESTRICT gradient = row.gradient_grey_px;
    const auto window = [span](const std::int32_t* prefix, int u) {
        // Subtracts as unsigned, because prefix sums may have wrapped around.
        return static_cast<std::int32_t>(static_cast<std::uint32_t>(prefix[u + span]) -
                                         static_cast<std::uint32_t>(prefix[u]));
    };
    const auto real_window = [window](const std::int32_t* prefix, int u) {
        return static_cast<float>(window(prefix, u));
    };
    constexpr float kUnit = 1.0F / (kScale * kScale);
    const float least_variance = row.min_noise_grey * row.min_noise_grey;
    const float prior_weight = 1.0F / (row.prior_sigma_px * row.prior_sigma_px);
    for (int u = 0; u < row.width; ++u) {
        const std::int32_t packed = window(count_error, u);
        const auto count = static_cast<float>(packed & (kCounted - 1));
        const bool solvable = count >= row.enough;
        const float n = solvable ? count : 1.0F;
        const float per_pixel = 1.0F / n;
        const float g = real_window(pg, u);
        const auto e = static_cast<float>(packed >> kCountBits);
        const float mean_g = g * per_pixel;
        const float gg = std::max(0.0F, (real_window(pgg, u) - mean_g * g) * kUnit);
        const float ge = (real_window(pge, u) - mean_g * e) * kUnit;
        const float ee = (real_window(pee, u) - e * per_pixel * e) * kUnit;
        const float explained = gg > 0.0F ? ge * ge / gg : 0.0F;
        const float variance = std::max(least_variance, (ee - explained) * per_pixel);
        // Least squares correction, damped by the prior; both are weighted by the variance.
        const float step = -ge / (gg + row.correlation * variance * prior_weight);
        const float shift = std::min(std::max(step, -row.max_step_px), row.max_step_px);
        const bool known = disparity_px[u] == disparity_px[u];
        const float unknown = disparity_px[u];  // NaN in the pixels that use this value
        const float kept_shift = solvable ? shift : 0.0F;
        const float noise = solvable ? std::sqrt(variance) : kMaxError / kScale;
        const float slope = solvable ? std::sqrt(gg * per_pixel) : 0.0F;
        shift_px[u] = known ? kept_shift : unknown;
        residual[u] = known ? noise : unknown;
        gradient[u] = known ? slope : unknown;
        disparity_px[u] += kept_shift;
    }
}

/// Vector version of Divisor::divide.
template <class D>
HWY_INLINE hn::Vec<D> divide(D d, const Divisor& by, hn::Vec<D> x) {
    const hn::RebindToUnsigned<D> bits;
    const auto upper = hn::Set(bits, Divisor::kUpperHalf);
    const auto high = hn::BitCast(d, hn::And(hn::BitCast(bits, x), upper));
    const auto rest = hn::Add(hn::Mul(high, hn::Set(d, by.lower())),
                              hn::Mul(hn::Sub(x, high), hn::Set(d, by.inverse())));
    return hn::Add(hn::Mul(high, hn::Set(d, by.upper())), rest);
}

/// Returns c + x * y with two roundings on every processor.
template <class D>
HWY_INLINE hn::Vec<D> plus_product(D d, float c, hn::Vec<D> x, hn::Vec<D> y) {
    return hn::Add(hn::Set(d, c), hn::Mul(x, y));
}

/// Returns ln x of a positive normal number, computed as 2 atanh((m - 1) / (m + 1)) of its mantissa
/// m. Error < 1e-6.
template <class D>
HWY_INLINE hn::Vec<D> log_of(D d, hn::Vec<D> x) {
    const hn::RebindToSigned<D> d32;
    const auto one = hn::Set(d, 1.0F);
    const auto bits = hn::BitCast(d32, x);
    const auto fraction = hn::And(bits, hn::Set(d32, 0x7fffff));
    const auto large = hn::Gt(fraction, hn::Set(d32, 0x3504f3));  // mantissa above sqrt 2
    const auto scale = hn::IfThenElse(large, hn::Set(d32, 0x3f000000), hn::Set(d32, 0x3f800000));
    const auto bias = hn::IfThenElse(large, hn::Set(d32, 126), hn::Set(d32, 127));
    const auto exponent = hn::ConvertTo(d, hn::Sub(hn::ShiftRight<23>(bits), bias));
    const auto m = hn::BitCast(d, hn::Or(fraction, scale));
    const auto t = hn::Div(hn::Sub(m, one), hn::Add(m, one));
    const auto t2 = hn::Mul(t, t);
    auto series = plus_product(d, 0.2F, t2, hn::Set(d, 1.0F / 7.0F));
    series = plus_product(d, 1.0F / 3.0F, t2, series);
    series = plus_product(d, 1.0F, t2, series);
    return hn::Add(hn::Mul(hn::Set(d, 0.69314718F), exponent),
                   hn::Mul(hn::Mul(hn::Set(d, 2.0F), t), series));
}

/// Returns e^x for |x| <= 80, computed as 2^n times the series of the remainder. Relative error <
/// 1e-6.
template <class D>
HWY_INLINE hn::Vec<D> exp_of(D d, hn::Vec<D> x) {
    constexpr Divisor k720(720);
    const hn::RebindToSigned<D> d32;
    const auto kept = hn::Min(hn::Max(x, hn::Set(d, -80.0F)), hn::Set(d, 80.0F));
    const auto shifted = plus_product(d, 256.5F, kept, hn::Set(d, 1.44269504F));
    const auto n = hn::Sub(hn::ConvertTo(d32, shifted), hn::Set(d32, 256));
    const auto r = hn::Sub(kept, hn::Mul(hn::ConvertTo(d, n), hn::Set(d, 0.69314718F)));
    auto series = hn::Add(hn::Set(d, 1.0F / 120.0F), divide(d, k720, r));
    for (const float next : {1.0F / 24.0F, 1.0F / 6.0F, 0.5F, 1.0F, 1.0F})
        series = plus_product(d, next, r, series);
    const auto power = hn::ShiftLeft<23>(hn::Add(n, hn::Set(d32, 127)));
    return hn::Mul(series, hn::BitCast(d, power));
}

// The formulae of confidence.cpp, in two loops. In a single loop each step would wait for too many
// earlier steps.

/// Computes sigma and score of the lanes from `u` on. The windows in which unknown pixels are
/// counted have `area` pixels. The score is stored in place of the probability.
template <class D>
HWY_INLINE void score_here(D d, const RateRow& row, const Divisor& area, int u) {
    constexpr Divisor kReach_px(static_cast<int>(kJumpReach_px));         // in range: constants
    constexpr Divisor kMaxNoise(static_cast<int>(kMaxNoisePerPixel_px));  // in range: constants
    const hn::RebindToSigned<D> d32;
    const hn::Rebind<std::uint8_t, D> d8;
    const auto set = [d](float value) { return hn::Set(d, value); };
    const auto square = [](auto value) { return hn::Mul(value, value); };
    const auto real = [&](const std::uint8_t* from) {
        return hn::ConvertTo(d, hn::PromoteTo(d32, hn::LoadU(d8, from + u)));
    };
    const auto jump_px = real(row.jump_distance_px);
    const auto near = hn::Max(hn::Sub(set(1.0F), divide(d, kReach_px, jump_px)), hn::Zero(d));
    const auto unknown = divide(d, area, real(row.unknown_count));
    const auto residual = hn::LoadU(d, row.residual_grey + u);
    const auto gradient = hn::LoadU(d, row.gradient_grey_px + u);
    const auto shift = hn::LoadU(d, row.shift_px + u);

    const auto textured = hn::Gt(gradient, divide(d, kMaxNoise, residual));
    const auto noise =
        hn::IfThenElse(textured,
                       hn::Div(residual, hn::IfThenElse(textured, gradient, set(1.0F))),
                       set(kMaxNoisePerPixel_px));
    auto variance =
        hn::Add(set(kSigmaFloor_px * kSigmaFloor_px), square(hn::Mul(set(kSigmaGain), noise)));
    variance = hn::Add(variance, square(hn::Mul(set(kSigmaShiftShare), shift)));
    variance = hn::Add(variance, square(hn::Mul(set(kSigmaJump_px), near)));
    variance = hn::Add(variance, square(hn::Mul(set(kSigmaHole_px), unknown)));
    const auto sigma = hn::Min(hn::Sqrt(variance), set(kMaxSigma_px));

    auto score = plus_product(d, kScoreConstant, set(kScoreNearJump), near);
    score = hn::Add(score, hn::Mul(set(kScoreNoise), log_of(d, noise)));
    score = hn::Add(score, hn::Mul(set(kScoreShift), hn::Abs(shift)));
    score = hn::Add(score, hn::Mul(set(kScoreUnknown), unknown));
    const auto disparity = hn::LoadU(d, row.disparity_px + u);
    const auto known = hn::Eq(disparity, disparity);
    hn::StoreU(hn::IfThenElse(known, sigma, disparity), d, row.sigma_px + u);
    hn::StoreU(score, d, row.outlier_probability + u);
}

/// Computes the outlier probability of the lanes from `u` on.
template <class D>
HWY_INLINE void weigh_here(D d, const RateRow& row, int u) {
    const auto one = hn::Set(d, 1.0F);
    const auto score = hn::LoadU(d, row.outlier_probability + u);
    const auto chance = hn::Div(one, hn::Add(one, exp_of(d, hn::Neg(score))));
    const auto disparity = hn::LoadU(d, row.disparity_px + u);
    const auto nearer_by_px = hn::Sub(disparity, hn::LoadU(d, row.smallest_px + u));
    const auto least = hn::IfThenElseZero(hn::Gt(nearer_by_px, hn::Set(d, kNearSideStep_px)),
                                          hn::Set(d, kNearSideOutlierProbability));
    const auto known = hn::Eq(disparity, disparity);
    hn::StoreU(hn::IfThenElse(known, hn::Max(chance, least), one), d, row.outlier_probability + u);
}

void rate_row(const RateRow& row) {
    const int radius = row.unknown_radius_px;
    const int inner = std::max(radius, row.width - radius);
    const auto beside_end = [&](int u) {
        const Divisor area(row.unknown_rows * window_span(u, radius, row.width));
        score_here(hn::CappedTag<float, 1>(), row, area, u);
    };
    for (int u = 0; u < std::min(radius, row.width); ++u) beside_end(u);
    const Divisor whole(row.unknown_rows * (2 * radius + 1));
    for_columns(radius, inner, [&](auto d, int u) { score_here(d, row, whole, u); });
    for (int u = inner; u < row.width; ++u) beside_end(u);
    // This loop must rate each value exactly once, so its registers do not overlap.
    const hn::ScalableTag<float> d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    int u = 0;
    for (; u + lanes <= row.width; u += lanes) weigh_here(d, row, u);
    for (; u < row.width; ++u) weigh_here(hn::CappedTag<float, 1>(), row, u);
}

}  // namespace
}  // namespace surefoot::stereo::rows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::stereo::rows {

HWY_EXPORT(smooth_image_row);
HWY_EXPORT(smooth_along_row);
HWY_EXPORT(warp_row);
HWY_EXPORT(slide_row);
HWY_EXPORT(solve_row);
HWY_EXPORT(rate_row);

void smooth_image(const std::uint8_t* const in[3],
                  int width,
                  std::uint16_t* scratch,
                  std::int16_t* out) {
    HWY_DYNAMIC_DISPATCH(smooth_image_row)(in, width, scratch, out);
}
void smooth_along(const SmoothRow& row) {
    HWY_DYNAMIC_DISPATCH(smooth_along_row)(row);
}
void warp(const WarpRow& row) {
    HWY_DYNAMIC_DISPATCH(warp_row)(row);
}
void slide(const std::int32_t* entering,
           const std::int32_t* leaving,
           int width,
           std::int32_t* const columns[kSums]) {
    HWY_DYNAMIC_DISPATCH(slide_row)(entering, leaving, width, columns);
}
void solve(const SolveRow& row) {
    HWY_DYNAMIC_DISPATCH(solve_row)(row);
}
void rate(const RateRow& row) {
    HWY_DYNAMIC_DISPATCH(rate_row)(row);
}

}  // namespace surefoot::stereo::rows
#endif  // HWY_ONCE
