// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/semi_global_simd.hpp"

// Highway builds the target with byte-wise population counts (Ice Lake, Zen 4) only on request.
#define HWY_WANT_AVX3_DL
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/stereo/semi_global_simd.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
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
        for (std::size_t byte = 0; byte < kCensusBytes; ++byte) {
            Bytes word = hn::Zero(kBytes);
            for (std::size_t bit = 0; bit < 8 && 8 * byte + bit < kWindow.size(); ++bit) {
                const CensusNeighbour at = kWindow[8 * byte + bit];
                const Bytes neighbour = hn::LoadU(kBytes, grey + u + at.du + at.dv * stride);
                const Bytes flag = hn::Set(kBytes, static_cast<std::uint8_t>(1U << bit));
                word = hn::Or(word, hn::IfThenElseZero(hn::Lt(neighbour, center), flag));
            }
            hn::StoreU(word, kBytes, out[byte] + u);
        }
    }
}

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void turn(const std::uint8_t* in,
                     std::ptrdiff_t in_stride,
                     std::uint8_t* out,
                     std::ptrdiff_t out_stride) {
    for (int x = 0; x < kLanes; ++x) {
        for (int y = 0; y < kLanes; ++y) out[x * out_stride + y] = in[y * in_stride + x];
    }
}
#else
/// Lanes 16 b ... 16 b + 15 of the result are the 16 bytes at from + 16 b stride. The function uses
/// blends, and loads that repeat 16 bytes. It uses no shuffles, because a processor does only one
/// shuffle of wide registers at a time.
HWY_INLINE Bytes load_pieces(const std::uint8_t* from, std::ptrdiff_t stride) {
#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4
    return static_cast<void>(stride), hn::LoadU(kBytes, from);
#else
    const auto piece = [&](int b) { return hn::LoadDup128(kBytes, from + 16 * b * stride); };
#if HWY_TARGET == HWY_AVX2
    return hn::ConcatUpperLower(kBytes, piece(1), piece(0));
#else
    return hn::ConcatUpperLower(
        kBytes, hn::OddEvenBlocks(piece(3), piece(2)), hn::OddEvenBlocks(piece(1), piece(0)));
#endif
#endif
}

/// Transposes 16 columns of `lanes()` rows by four rounds of interleaving row i with row i + 8.
HWY_INLINE void turn_sixteen(const std::uint8_t* in,
                             std::ptrdiff_t in_stride,
                             std::uint8_t* out,
                             std::ptrdiff_t out_stride) {
    Bytes rows[16];
    Bytes mixed[16];
    for (int i = 0; i < 16; ++i) rows[i] = load_pieces(in + i * in_stride, in_stride);
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
    for (int i = 0; i < 16; ++i) hn::Store(rows[i], kBytes, out + i * out_stride);
}

HWY_INLINE void turn(const std::uint8_t* in,
                     std::ptrdiff_t in_stride,
                     std::uint8_t* out,
                     std::ptrdiff_t out_stride) {
    for (int x = 0; x < kLanes; x += 16) {
        for (int y = 0; y < kLanes; y += lanes())
            turn_sixteen(in + y * in_stride + x, in_stride, out + x * out_stride + y, out_stride);
    }
}
#endif

void transpose_block(const std::uint8_t* in,
                     std::ptrdiff_t in_stride,
                     std::uint8_t* out,
                     std::ptrdiff_t out_stride) {
    turn(in, in_stride, out, out_stride);
}

/// This function is separate from transpose_block, because its constant strides save address
/// arithmetic.
HWY_NOINLINE void turn_sums(std::uint8_t* plane) {
    turn(plane, kCostLine, plane - kCostGroup, kCostLine);
}

/// Shifts each byte to the right. x86 has no instruction that shifts single bytes.
HWY_INLINE Bytes shift_right(Bytes value, int shift) {
#if HWY_TARGET == HWY_SCALAR
    return hn::Set(kBytes, static_cast<std::uint8_t>(hn::GetLane(value) >> shift));
#else
    const hn::Repartition<std::uint16_t, decltype(kBytes)> pairs;
    const Bytes moved = hn::BitCast(kBytes, hn::ShiftRightSame(hn::BitCast(pairs, value), shift));
    return hn::And(moved, hn::Set(kBytes, static_cast<std::uint8_t>(255 >> shift)));
#endif
}

/// Returns the jump penalty P2, which falls with the grey step.
HWY_INLINE Bytes jump_penalty(const Penalties& penalties, Bytes grey, Bytes grey_before) {
    const Bytes step = hn::Sub(hn::Max(grey, grey_before), hn::Min(grey, grey_before));
    const Bytes relief = shift_right(step, penalties.contrast_shift);
    return hn::Max(hn::SaturatedSub(hn::Set(kBytes, penalties.jump), relief),
                   hn::Set(kBytes, penalties.min_jump));
}

struct Word {
    Bytes byte0, byte1;
};

HWY_INLINE Bytes distance(const Word& a, const Word& b) {
    return hn::Add(hn::PopulationCount(hn::Xor(a.byte0, b.byte0)),
                   hn::PopulationCount(hn::Xor(a.byte1, b.byte1)));
}

HWY_INLINE Word word_at(const std::uint8_t* place) {
    return {hn::Load(kBytes, place), hn::Load(kBytes, place + kLanes)};
}

/// Loads half as many bytes as there are lanes, each into two lanes.
HWY_INLINE Bytes load_twice(const std::uint8_t* from) {
#if HWY_TARGET == HWY_SCALAR
    return hn::Load(kBytes, from);
#else
    const hn::Half<decltype(kBytes)> half;
    const hn::Repartition<std::uint16_t, decltype(kBytes)> pairs;
    const auto wide = hn::PromoteTo(pairs, hn::LoadU(half, from));
    return hn::BitCast(kBytes, hn::Or(wide, hn::ShiftLeft<8>(wide)));
#endif
}

void spread_prior_here(const PriorBlock& block, int line, int begin, int end, std::uint8_t* out) {
    const Bytes outside = hn::Set(kBytes, block.outside);
    const std::uint8_t* const costs = block.costs + line * kCostLine;
    for (int lane = 0; lane < kLanes; lane += lanes()) {
        const auto prior = [&](int d) {
            d = std::min(d, block.disparities - 1);
            return d < block.begin || d >= block.end ? outside
                                                     : load_twice(costs + cost_at(d) + lane / 2);
        };
        Bytes here = prior(begin / 2);
        for (int d = begin; d < end; d += 2) {
            const Bytes next = prior(d / 2 + 1);
            std::uint8_t* const to = out + (d - begin) * kLanes + lane;
            hn::Store(here, kBytes, to);
            if (d + 1 < end) hn::Store(hn::AverageRound(here, next), kBytes, to + kLanes);
            here = next;
        }
    }
}

/// Prefetch distance for memory that is written without being read before. Without the prefetch,
/// every cache line would wait for memory.
constexpr std::ptrdiff_t kPrefetchAhead_bytes = std::ptrdiff_t{2} * kCostGroup;

/// Returns the least path cost without the matching cost. The disparity stays, changes by one, or
/// jumps. Additions saturate. The entry beyond the last disparity is 255.
HWY_INLINE Bytes cheapest(Bytes below, Bytes here, Bytes above, Bytes slope, Bytes jump) {
    const Bytes neighbour = hn::SaturatedAdd(hn::Min(below, above), slope);
    return hn::Min(hn::Min(neighbour, here), jump);
}

enum class Sums : std::uint8_t { left_alone, written, added_to };

/// Moves a path to its next column `u`, in the lanes from `lane` on.
template <Sums kSums>
HWY_INLINE void follow_column(const RowBlock& block,
                              std::ptrdiff_t u,
                              const std::uint8_t* grey_before,
                              std::ptrdiff_t lane) {
    const Bytes slope = hn::Set(kBytes, block.penalties.slope);
    const Bytes none = hn::Set(kBytes, std::uint8_t{255});
    const Bytes least = hn::Load(kBytes, block.least + lane);
    const Bytes jump = hn::Add(least,
                               jump_penalty(block.penalties,
                                            hn::Load(kBytes, block.grey + u * kLanes + lane),
                                            hn::Load(kBytes, grey_before + lane)));
    const Word left = word_at(block.left + u * kCensusRow + lane);
    const std::uint8_t* right = block.right + (u - block.begin) * kCensusRow + lane;
    const std::uint8_t* prior = block.prior_costs + lane;
    std::uint8_t* state = block.state + block.begin * kLanes + lane;
    Bytes below = none;
    Bytes here = hn::Load(kBytes, state);
    Bytes new_least = none;
    for (int first = block.begin; first < block.end; first += kGroup) {
        const int count = std::min(kGroup, block.end - first);
        const std::ptrdiff_t place = cost_at(first - block.begin) + u * kCostLine + lane;
        [[maybe_unused]] std::uint8_t* sums = nullptr;
        [[maybe_unused]] std::uint8_t* matches = nullptr;
        if constexpr (kSums != Sums::left_alone) {
            sums = block.sums + place;
            matches = block.match + place;
        }
        for (std::ptrdiff_t at = 0; at < count * kLanes; at += kLanes) {
            const Bytes above = hn::Load(kBytes, state + kLanes);
            const Bytes match = kSums == Sums::added_to ? hn::Load(kBytes, matches + at)
                                                        : hn::Add(distance(left, word_at(right)),
                                                                  hn::Load(kBytes, prior));
            const Bytes cost =
                hn::Add(hn::Sub(cheapest(below, here, above, slope, jump), least), match);
            hn::Store(cost, kBytes, state);
            if constexpr (kSums == Sums::written) {
                hwy::Prefetch(sums + at + kPrefetchAhead_bytes);
                hn::Store(cost, kBytes, sums + at);
                hwy::Prefetch(matches + at + kPrefetchAhead_bytes);
                hn::Store(match, kBytes, matches + at);
            }
            if constexpr (kSums == Sums::added_to)
                hn::Store(hn::Add(cost, hn::Load(kBytes, sums + at)), kBytes, sums + at);
            new_least = hn::Min(new_least, cost);
            below = here;
            here = above;
            state += kLanes;
            right -= kCensusRow;
            prior += kLanes;
        }
    }
    hn::Store(new_least, kBytes, block.least + lane);
}

template <Sums kSums>
void follow(const RowBlock& block) {
    const std::uint8_t* grey_before = block.grey_before;
    for (int i = 0; i < block.columns; ++i) {
        const std::ptrdiff_t u = kSums == Sums::added_to ? block.columns - 1 - i : i;
        if (kSums != Sums::added_to && i % 2 == 0 && block.prior.costs != nullptr)
            spread_prior_here(block.prior, i / 2, block.begin, block.end, block.prior_costs);
        for (int lane = 0; lane < kLanes; lane += lanes())
            follow_column<kSums>(block, u, grey_before, lane);
        grey_before = block.grey + u * kLanes;
    }
}

void pass_right_here(const RowBlock& block) {
    follow<Sums::left_alone>(block);
}

void follow_right_here(const RowBlock& block) {
    follow<Sums::written>(block);
}

void follow_left_here(const RowBlock& block) {
    follow<Sums::added_to>(block);
    for (int d = 0; d < block.end - block.begin; ++d) {
        turn_sums(block.sums + cost_at(d));
        turn_sums(block.match + cost_at(d));
    }
}

/// The best disparity so far, in a scan over disparities upward.
struct Winner {
    Bytes disparity, cost, cost_below, cost_above;
    Bytes second;  ///< least cost at least two away from the winner
    Bytes older;   ///< least cost of all disparities except the last
    Bytes last;
    Bytes next;                            ///< next disparity of the scan
    hn::Mask<decltype(kBytes)> older_won;  ///< the last disparity is not the winner

    HWY_INLINE Winner(Bytes none, Bytes first)
        : disparity(first),
          cost(none),
          cost_below(none),
          cost_above(none),
          second(none),
          older(none),
          last(none),
          next(first),
          older_won(hn::Eq(none, none)) {}

    HWY_INLINE void see(Bytes sum) {
        const Bytes least = hn::Min(cost, sum);
        const auto stays = hn::Eq(least, cost);  // ordering bytes is slower than this comparison
        const Bytes rest = hn::IfThenElse(older_won, hn::Min(second, sum), second);
        second = hn::IfThenElse(stays, rest, older);
        cost_above = hn::IfThenElse(older_won, cost_above, sum);
        cost_below = hn::IfThenElse(stays, cost_below, last);
        disparity = hn::IfThenElse(stays, disparity, next);
        cost = least;
        older = hn::Min(older, last);
        last = sum;
        older_won = stays;
        next = hn::Add(next, hn::Set(kBytes, std::uint8_t{1}));
    }
    HWY_INLINE void store(const WinnerRows& out, std::ptrdiff_t lane, Bytes none) const {
        hn::StoreU(disparity, kBytes, out.disparity + lane);
        hn::StoreU(cost, kBytes, out.cost + lane);
        hn::StoreU(cost_below, kBytes, out.cost_below + lane);
        hn::StoreU(hn::IfThenElse(older_won, cost_above, none), kBytes, out.cost_above + lane);
        hn::StoreU(second, kBytes, out.second_cost + lane);
    }
};

/// Moves a path down or up by one row in the lanes from `lane` on. `match(d)` returns the matching
/// cost of a disparity; `use(d, cost)` receives the path cost.
template <class Match, class Use>
HWY_INLINE void follow_lanes(const ColumnStep& step,
                             std::ptrdiff_t lane,
                             const Match& match,
                             const Use& use) {
    const Bytes slope = hn::Set(kBytes, step.penalties.slope);
    const Bytes none = hn::Set(kBytes, std::uint8_t{255});
    std::uint8_t* state = step.state + step.begin * kLanes + lane;
    const Bytes least = hn::Load(kBytes, step.least + lane);
    const Bytes jump = hn::Add(least,
                               jump_penalty(step.penalties,
                                            hn::LoadU(kBytes, step.grey + lane),
                                            hn::LoadU(kBytes, step.grey_before + lane)));
    // A local copy, because the compiler must assume that the stores below change `step`.
    const int count = step.end - step.begin;
    Bytes below = none;
    Bytes here = hn::Load(kBytes, state);
    Bytes new_least = none;
    for (int first = 0; first < count; first += kGroup) {
        const std::ptrdiff_t group = cost_at(first) + lane;
        const int last = std::min(kGroup, count - first);
        for (std::ptrdiff_t k = 0; k < last; ++k) {
            const Bytes above = hn::Load(kBytes, state + kLanes);
            const Bytes cost = hn::Add(hn::Sub(cheapest(below, here, above, slope, jump), least),
                                       match(first + k, group + k * kLanes));
            hn::Store(cost, kBytes, state);
            use(first + k, group + k * kLanes, cost);
            new_least = hn::Min(new_least, cost);
            below = here;
            here = above;
            state += kLanes;
        }
    }
    hn::Store(new_least, kBytes, step.least + lane);
}

void pass_row_here(const ColumnStep& step) {
    for (std::ptrdiff_t lane = 0; lane < kLanes; lane += lanes()) {
        const Word left{hn::LoadU(kBytes, step.left[0] + lane),
                        hn::LoadU(kBytes, step.left[1] + lane)};
        const std::uint8_t* const right0 = step.right[0] + lane - step.begin;
        const std::uint8_t* const right1 = step.right[1] + lane - step.begin;
        const std::uint8_t* const prior = step.prior_costs + lane;
        follow_lanes(
            step,
            lane,
            [=](std::ptrdiff_t k, std::ptrdiff_t) {
                const Word right{hn::LoadU(kBytes, right0 - k), hn::LoadU(kBytes, right1 - k)};
                return hn::Add(distance(left, right), hn::Load(kBytes, prior + k * kLanes));
            },
            [](std::ptrdiff_t, std::ptrdiff_t, Bytes) {});
    }
}

void follow_row_here(const ColumnStep& step) {
    const std::uint8_t* const match = step.match;
    std::uint8_t* const sums = step.sums;
    for (std::ptrdiff_t lane = 0; lane < kLanes; lane += lanes()) {
        follow_lanes(
            step,
            lane,
            [=](std::ptrdiff_t, std::ptrdiff_t at) { return hn::Load(kBytes, match + at); },
            [=](std::ptrdiff_t, std::ptrdiff_t at, Bytes cost) {
                hn::Store(hn::SaturatedAdd(cost, hn::Load(kBytes, sums + at)), kBytes, sums + at);
            });
    }
}

void finish_row_here(const ColumnStep& step, const WinnerRows& out) {
    const std::uint8_t* const match = step.match;
    const std::uint8_t* const sums = step.sums;
    const Bytes none = hn::Set(kBytes, std::uint8_t{255});
    for (std::ptrdiff_t lane = 0; lane < kLanes; lane += lanes()) {
        Winner winner(none, hn::Set(kBytes, static_cast<std::uint8_t>(step.begin)));
        follow_lanes(
            step,
            lane,
            [=](std::ptrdiff_t, std::ptrdiff_t at) { return hn::Load(kBytes, match + at); },
            [=, &winner](std::ptrdiff_t, std::ptrdiff_t at, Bytes cost) {
                winner.see(hn::SaturatedAdd(cost, hn::Load(kBytes, sums + at)));
            });
        winner.store(out, lane, none);
    }
}

void finish_prior_row_here(const ColumnStep& step, const PriorRow& out) {
    const std::uint8_t* const match = step.match;
    const std::uint8_t* const sums = step.sums;
    const int count = step.end - step.begin;
    for (std::ptrdiff_t lane = 0; lane < kLanes; lane += lanes()) {
        std::uint8_t* const kept = out.sums + lane;
        Bytes least = hn::Set(kBytes, std::uint8_t{255});
        follow_lanes(
            step,
            lane,
            [=](std::ptrdiff_t, std::ptrdiff_t at) { return hn::Load(kBytes, match + at); },
            [=, &least](std::ptrdiff_t k, std::ptrdiff_t at, Bytes cost) {
                const Bytes sum = hn::SaturatedAdd(cost, hn::Load(kBytes, sums + at));
                hn::Store(sum, kBytes, kept + k * kLanes);
                least = hn::Min(least, sum);
            });
        for (std::ptrdiff_t k = 0; k < count; ++k) {
            const Bytes above_least = hn::Sub(hn::Load(kBytes, kept + k * kLanes), least);
            std::uint8_t* const least_excess = out.least_excess + k * kLanes + lane;
            hn::Store(hn::Min(above_least, hn::Load(kBytes, least_excess)), kBytes, least_excess);
            hn::Store(shift_right(above_least, out.shift),
                      kBytes,
                      out.costs + cost_at(static_cast<int>(k)) + lane);
        }
    }
}

}  // namespace
}  // namespace surefoot::stereo::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::stereo::kernels {

HWY_EXPORT(census_row);
HWY_EXPORT(transpose_block);
HWY_EXPORT(spread_prior_here);
HWY_EXPORT(pass_right_here);
HWY_EXPORT(follow_right_here);
HWY_EXPORT(follow_left_here);
HWY_EXPORT(pass_row_here);
HWY_EXPORT(follow_row_here);
HWY_EXPORT(finish_row_here);
HWY_EXPORT(finish_prior_row_here);

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
void spread_prior(const PriorBlock& block, int line, int begin, int end, std::uint8_t* out) {
    HWY_DYNAMIC_DISPATCH(spread_prior_here)(block, line, begin, end, out);
}
void begin_path(int disparities, std::uint8_t* state, std::uint8_t* least) {
    std::memset(state, 0, static_cast<std::size_t>(disparities) * kLanes);
    std::memset(least, 0, kLanes);
}
void enter_range(std::uint8_t* state, int old_begin, int old_end, int begin, int end) {
    const auto close = [&](int from, int to) {
        if (from < to)
            std::memset(state + from * kLanes, 255, static_cast<std::size_t>(to - from) * kLanes);
    };
    close(begin, std::min(end, old_begin));
    close(std::max(begin, old_end), end);
    close(end, end + 1);
}
void pass_right(const RowBlock& block) {
    HWY_DYNAMIC_DISPATCH(pass_right_here)(block);
}
void follow_right(const RowBlock& block) {
    HWY_DYNAMIC_DISPATCH(follow_right_here)(block);
}
void follow_left(const RowBlock& block) {
    HWY_DYNAMIC_DISPATCH(follow_left_here)(block);
}
void pass_row(const ColumnStep& step) {
    HWY_DYNAMIC_DISPATCH(pass_row_here)(step);
}
void follow_row(const ColumnStep& step) {
    HWY_DYNAMIC_DISPATCH(follow_row_here)(step);
}
void finish_row(const ColumnStep& step, const WinnerRows& out) {
    HWY_DYNAMIC_DISPATCH(finish_row_here)(step, out);
}
void finish_prior_row(const ColumnStep& step, const PriorRow& out) {
    HWY_DYNAMIC_DISPATCH(finish_prior_row_here)(step, out);
}

}  // namespace surefoot::stereo::kernels
#endif  // HWY_ONCE
