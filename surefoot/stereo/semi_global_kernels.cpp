// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/semi_global_kernels.hpp"

// The target with byte-wise population counts (Ice Lake, Zen 4) is not built unless it is asked
// for.
#define HWY_WANT_AVX3_DL
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/stereo/semi_global_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace surefoot::stereo::kernels::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
constexpr hn::CappedTag<std::uint8_t, kLanes> kBytes;
using Bytes = hn::VFromD<decltype(kBytes)>;

int lanes() {
    return static_cast<int>(hn::Lanes(kBytes));
}

void census_row(const std::uint8_t* grey,
                std::ptrdiff_t stride,
                int width,
                std::uint8_t* const out[kCensusBytes]) {
    constexpr auto kWindow = census_window();
    for (int u = 0; u < width; u += lanes()) {
        const Bytes center = hn::LoadU(kBytes, grey + u);
        for (int byte = 0; byte < kCensusBytes; ++byte) {
            Bytes word = hn::Zero(kBytes);
            for (std::size_t bit = 0; bit < 8; ++bit) {
                const std::size_t index = 8 * static_cast<std::size_t>(byte) + bit;
                if (index >= kWindow.size()) break;
                const Bytes neighbour =
                    hn::LoadU(kBytes, grey + u + kWindow[index].du + kWindow[index].dv * stride);
                const Bytes flag = hn::Set(kBytes, static_cast<std::uint8_t>(1U << bit));
                word = hn::Or(word, hn::IfThenElseZero(hn::Lt(neighbour, center), flag));
            }
            hn::StoreU(word, kBytes, out[byte] + u);
        }
    }
}

#if HWY_TARGET == HWY_SCALAR
/// Row y holds column y, all of it.
void turn(const std::uint8_t* in, std::ptrdiff_t stride, std::uint8_t* turned) {
    for (int y = 0; y < kLanes; ++y) {
        for (int x = 0; x < kLanes; ++x) turned[x * kLanes + y] = in[y * stride + x];
    }
}
constexpr int kPiece = kLanes;
std::ptrdiff_t piece_at(int x, int /*y*/) {
    return x * kLanes;
}
#else
/// Four rounds of interleaving row i with row i + 8 turn 16 rows into columns, in every block of 16
/// lanes apart: piece_at tells where column x, rows y to y + 15, has come to lie.
void turn(const std::uint8_t* in, std::ptrdiff_t stride, std::uint8_t* turned) {
    Bytes rows[16];
    Bytes mixed[16];
    for (int y = 0; y < kLanes; y += 16) {
        for (int x = 0; x < kLanes; x += lanes()) {
            for (int i = 0; i < 16; ++i) rows[i] = hn::LoadU(kBytes, in + (y + i) * stride + x);
            for (int round = 0; round < 2; ++round) {
                for (int i = 0; i < 8; ++i) {
                    mixed[2 * i] = hn::InterleaveLower(kBytes, rows[i], rows[i + 8]);
                    mixed[2 * i + 1] = hn::InterleaveUpper(kBytes, rows[i], rows[i + 8]);
                }
                for (int i = 0; i < 8; ++i) {
                    rows[2 * i] = hn::InterleaveLower(kBytes, mixed[i], mixed[i + 8]);
                    rows[2 * i + 1] = hn::InterleaveUpper(kBytes, mixed[i], mixed[i + 8]);
                }
            }
            for (int i = 0; i < 16; ++i) hn::Store(rows[i], kBytes, turned + (y + i) * kLanes + x);
        }
    }
}
constexpr int kPiece = 16;
std::ptrdiff_t piece_at(int x, int y) {
    return (y + x % 16) * kLanes + x / 16 * 16;
}
#endif

void transpose_block(const std::uint8_t* in,
                     std::ptrdiff_t in_stride,
                     std::uint8_t* out,
                     std::ptrdiff_t out_stride) {
    HWY_ALIGN std::uint8_t turned[kLanes * kLanes];
    turn(in, in_stride, turned);
    for (int x = 0; x < kLanes; ++x) {
        for (int y = 0; y < kLanes; y += kPiece)
            std::memcpy(out + x * out_stride + y, turned + piece_at(x, y), kPiece);
    }
}

/// Bytes have no shift of their own.
HWY_INLINE Bytes shift_right(Bytes value, int shift) {
#if HWY_TARGET == HWY_SCALAR
    return hn::Set(kBytes, static_cast<std::uint8_t>(hn::GetLane(value) >> shift));
#else
    const hn::Repartition<std::uint16_t, decltype(kBytes)> pairs;
    const Bytes moved = hn::BitCast(kBytes, hn::ShiftRightSame(hn::BitCast(pairs, value), shift));
    return hn::And(moved, hn::Set(kBytes, static_cast<std::uint8_t>(255 >> shift)));
#endif
}

/// P2: falls with the grey step.
HWY_INLINE Bytes jump_penalty(const Penalties& penalties, Bytes grey, Bytes grey_before) {
    const Bytes step = hn::Sub(hn::Max(grey, grey_before), hn::Min(grey, grey_before));
    const Bytes relief = shift_right(step, penalties.contrast_shift);
    return hn::Max(hn::SaturatedSub(hn::Set(kBytes, penalties.jump), relief),
                   hn::Set(kBytes, penalties.min_jump));
}

struct Word {
    Bytes byte0, byte1, byte2, byte3;
};

HWY_INLINE Bytes distance(const Word& a, const Word& b) {
    return hn::Add(hn::Add(hn::PopulationCount(hn::Xor(a.byte0, b.byte0)),
                           hn::PopulationCount(hn::Xor(a.byte1, b.byte1))),
                   hn::Add(hn::PopulationCount(hn::Xor(a.byte2, b.byte2)),
                           hn::PopulationCount(hn::Xor(a.byte3, b.byte3))));
}

HWY_INLINE Word word_at(const std::uint8_t* place) {
    return {hn::Load(kBytes, place),
            hn::Load(kBytes, place + kLanes),
            hn::Load(kBytes, place + 2 * kLanes),
            hn::Load(kBytes, place + 3 * kLanes)};
}

/// One path, in the lanes from `first_lane`; the second one adds to the sums of the first.
template <bool kForward>
void follow(const RowStrip& strip, int first_lane) {
    const Bytes slope = hn::Set(kBytes, strip.penalties.slope);
    const Bytes none = hn::Set(kBytes, std::uint8_t{255});
    std::uint8_t* const state = strip.state + first_lane;
    for (int d = 0; d < strip.disparities; ++d)
        hn::Store(hn::Zero(kBytes), kBytes, state + d * kLanes);
    hn::Store(none, kBytes, state + strip.disparities * kLanes);
    Bytes least = hn::Zero(kBytes);
    const int start = kForward ? 0 : strip.width - 1;
    Bytes grey_before = hn::Load(kBytes, strip.grey + start * kLanes + first_lane);
    for (int i = 0; i < strip.width; ++i) {
        const std::ptrdiff_t u = kForward ? i : strip.width - 1 - i;
        const Bytes grey = hn::Load(kBytes, strip.grey + u * kLanes + first_lane);
        const Bytes jump = hn::Add(least, jump_penalty(strip.penalties, grey, grey_before));
        grey_before = grey;
        const Word left = word_at(strip.left + u * kCensusRow + first_lane);
        const std::uint8_t* right = strip.right + u * kCensusRow + first_lane;
        std::uint8_t* const sums = strip.sums + u * strip.sums_stride + first_lane;
        Bytes below = none;
        Bytes here = hn::Load(kBytes, state);
        Bytes new_least = none;
        for (int d = 0; d < strip.disparities; ++d) {
            const Bytes above = hn::Load(kBytes, state + (d + 1) * kLanes);
            const Bytes neighbour = hn::SaturatedAdd(hn::Min(below, above), slope);
            const Bytes best = hn::Min(hn::Min(neighbour, here), jump);
            const Bytes cost = hn::Add(hn::Sub(best, least), distance(left, word_at(right)));
            hn::Store(cost, kBytes, state + d * kLanes);
            const Bytes sum = kForward ? cost : hn::Add(cost, hn::Load(kBytes, sums + d * kLanes));
            hn::Store(sum, kBytes, sums + d * kLanes);
            new_least = hn::Min(new_least, cost);
            below = here;
            here = above;
            right -= kCensusRow;
        }
        least = new_least;
        // Turned while it is still near.
        const bool complete = !kForward && first_lane + lanes() == kLanes && u % kLanes == 0;
        if (!complete) continue;
        for (int d = 0; d < strip.disparities; ++d) {
            std::uint8_t* const block = strip.sums + u * strip.sums_stride + d * kLanes;
            transpose_block(block, strip.sums_stride, block, strip.sums_stride);
        }
    }
}

void follow_rows_here(const RowStrip& strip) {
    for (int lane = 0; lane < kLanes; lane += lanes()) {
        follow<true>(strip, lane);
        follow<false>(strip, lane);
    }
}

HWY_INLINE Word word_of(const std::uint8_t* const bytes[kCensusBytes], std::ptrdiff_t at) {
    return {hn::LoadU(kBytes, bytes[0] + at),
            hn::LoadU(kBytes, bytes[1] + at),
            hn::LoadU(kBytes, bytes[2] + at),
            hn::LoadU(kBytes, bytes[3] + at)};
}

/// One step of the path from above, and the winner of all three paths on the way. Second best so
/// far: `second` holds what is at least two away from the best of all d so far, `older` the least
/// of all that is at least two before the next d.
void follow_lanes(const ColumnStep& step, int lane, WinnerRows& out) {
    const Bytes slope = hn::Set(kBytes, step.penalties.slope);
    const Bytes none = hn::Set(kBytes, std::uint8_t{255});
    const Bytes one = hn::Set(kBytes, std::uint8_t{1});
    std::uint8_t* const state = step.state + lane;
    const Bytes least = hn::Load(kBytes, step.least + lane);
    const Bytes jump = hn::Add(least,
                               jump_penalty(step.penalties,
                                            hn::LoadU(kBytes, step.grey + lane),
                                            hn::LoadU(kBytes, step.grey_above + lane)));
    const Word left = word_of(step.left, lane);
    Bytes below = none;
    Bytes here = hn::Load(kBytes, state);
    Bytes new_least = none;

    Bytes best_cost = none;
    Bytes best = hn::Zero(kBytes);
    Bytes cost_below = none;
    Bytes cost_above = none;
    Bytes second = none;
    Bytes older = none;
    Bytes sum_before = none;
    Bytes disparity = hn::Zero(kBytes);
    auto was_best = hn::Lt(none, none);
    for (int d = 0; d < step.disparities; ++d) {
        const Bytes above = hn::Load(kBytes, state + (d + 1) * kLanes);
        const Bytes neighbour = hn::SaturatedAdd(hn::Min(below, above), slope);
        const Bytes path = hn::Min(hn::Min(neighbour, here), jump);
        const Bytes cost =
            hn::Add(hn::Sub(path, least), distance(left, word_of(step.right, lane - d)));
        hn::Store(cost, kBytes, state + d * kLanes);
        new_least = hn::Min(new_least, cost);
        below = here;
        here = above;

        const Bytes sum = hn::Add(cost, hn::Load(kBytes, step.sums + d * kLanes + lane));
        const auto is_best = hn::Lt(sum, best_cost);
        const Bytes rest = hn::IfThenElse(was_best, second, hn::Min(second, sum));
        second = hn::IfThenElse(is_best, older, rest);
        cost_above = hn::IfThenElse(is_best, none, hn::IfThenElse(was_best, sum, cost_above));
        cost_below = hn::IfThenElse(is_best, sum_before, cost_below);
        best = hn::IfThenElse(is_best, disparity, best);
        best_cost = hn::Min(best_cost, sum);
        older = hn::Min(older, sum_before);
        sum_before = sum;
        was_best = is_best;
        disparity = hn::Add(disparity, one);
    }
    hn::Store(new_least, kBytes, step.least + lane);
    hn::StoreU(best, kBytes, out.disparity + lane);
    hn::StoreU(best_cost, kBytes, out.cost + lane);
    hn::StoreU(cost_below, kBytes, out.cost_below + lane);
    hn::StoreU(cost_above, kBytes, out.cost_above + lane);
    hn::StoreU(second, kBytes, out.second_cost + lane);
}

void follow_columns_here(const ColumnStep& step, WinnerRows& out) {
    for (int lane = 0; lane < kLanes; lane += lanes()) follow_lanes(step, lane, out);
}

}  // namespace
}  // namespace surefoot::stereo::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::stereo::kernels {

HWY_EXPORT(census_row);
HWY_EXPORT(transpose_block);
HWY_EXPORT(follow_rows_here);
HWY_EXPORT(follow_columns_here);

void census(const std::uint8_t* grey,
            std::ptrdiff_t stride,
            int width,
            std::uint8_t* const out[kCensusBytes]) {
    HWY_DYNAMIC_DISPATCH(census_row)(grey, stride, width, out);
}
void transpose(const std::uint8_t* in,
               std::ptrdiff_t in_stride,
               std::uint8_t* out,
               std::ptrdiff_t out_stride) {
    HWY_DYNAMIC_DISPATCH(transpose_block)(in, in_stride, out, out_stride);
}
void follow_rows(const RowStrip& strip) {
    HWY_DYNAMIC_DISPATCH(follow_rows_here)(strip);
}
void follow_columns(const ColumnStep& step, WinnerRows& out) {
    HWY_DYNAMIC_DISPATCH(follow_columns_here)(step, out);
}

}  // namespace surefoot::stereo::kernels
#endif  // HWY_ONCE
