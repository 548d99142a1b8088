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

/// True if the first path stores the matching costs for the other paths. Without byte-wise
/// population counts, a matching cost takes longer than the rest of a step. The stored costs are
/// transposed with the sums.
constexpr bool kMatchKept = HWY_TARGET > HWY_AVX3_DL;

/// True for targets that count bits by table look-up, four bits at a time. The bytes a b c d of a
/// census word are stored so that six look-ups are enough instead of eight. Byte c becomes a ^ b ^
/// c (see count_bits), and the six bits of d leave bits 3 and 7 free.
constexpr bool kLookedUp = HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX2 ||
                           HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_SSSE3;

void census_row(const std::uint8_t* grey,
                std::ptrdiff_t stride,
                int width,
                std::uint8_t* const out[kCensusBytes]) {
    constexpr auto kWindow = census_window();
    for (int u = 0; u < width; u += lanes()) {
        const Bytes center = hn::LoadU(kBytes, grey + u);
        Bytes odd = hn::Zero(kBytes);
        for (int byte = 0; byte < kCensusBytes; ++byte) {
            Bytes word = hn::Zero(kBytes);
            for (std::size_t bit = 0; bit < 8; ++bit) {
                const std::size_t index = 8 * static_cast<std::size_t>(byte) + bit;
                if (index >= kWindow.size()) break;
                const Bytes neighbour =
                    hn::LoadU(kBytes, grey + u + kWindow[index].du + kWindow[index].dv * stride);
                const std::size_t place = kLookedUp && byte == 3 && bit >= 3 ? bit + 1 : bit;
                const Bytes flag = hn::Set(kBytes, static_cast<std::uint8_t>(1U << place));
                word = hn::Or(word, hn::IfThenElseZero(hn::Lt(neighbour, center), flag));
            }
            odd = hn::Xor(odd, word);
            hn::StoreU(kLookedUp && byte == 2 ? odd : word, kBytes, out[byte] + u);
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
    turn(plane, kSumsColumn, plane - kSumsGroup, kSumsColumn);
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
    Bytes byte0, byte1, byte2, byte3;
};

#if HWY_TARGET != HWY_SCALAR
/// Returns the number of bits set in a, b, c and d, given odd = a ^ b ^ c. A bit of `odd` is set if
/// one or three of a, b, c are set at this position; a bit of `pair` is set if two or three are
/// set. A look-up uses bits 0 to 3 and needs bit 7 clear. d needs no mask, because its bits 3 and 7
/// are clear.
[[maybe_unused]] HWY_INLINE Bytes count_bits(Bytes a, Bytes b, Bytes odd, Bytes d) {
    HWY_ALIGN static constexpr std::uint8_t kCounts[16] = {
        0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
    const Bytes counts = hn::LoadDup128(kBytes, kCounts);
    const Bytes low = hn::Set(kBytes, std::uint8_t{15});
    const hn::Repartition<std::uint16_t, decltype(kBytes)> wider;
    const auto upper = [&](Bytes value) {
        return hn::BitCast(kBytes, hn::ShiftRight<4>(hn::BitCast(wider, value)));
    };
    const auto count = [&](Bytes value) { return hn::TableLookupBytes(counts, value); };
    const auto count_all = [&](Bytes value) {
        return hn::Add(count(hn::And(value, low)), count(hn::And(upper(value), low)));
    };
    const Bytes pair = hn::Xor(a, hn::And(hn::Xor(a, b), hn::Xor(b, odd)));
    const Bytes pairs = count_all(pair);
    const Bytes rest = hn::Add(count_all(odd), hn::Add(count(d), count(upper(d))));
    return hn::Add(rest, hn::Add(pairs, pairs));
}
#endif

HWY_INLINE Bytes distance(const Word& a, const Word& b) {
    const Bytes byte0 = hn::Xor(a.byte0, b.byte0);
    const Bytes byte1 = hn::Xor(a.byte1, b.byte1);
    const Bytes byte2 = hn::Xor(a.byte2, b.byte2);
    const Bytes byte3 = hn::Xor(a.byte3, b.byte3);
#if HWY_TARGET != HWY_SCALAR
    if constexpr (kLookedUp) return count_bits(byte0, byte1, byte2, byte3);
#endif
    return hn::Add(hn::Add(hn::PopulationCount(byte0), hn::PopulationCount(byte1)),
                   hn::Add(hn::PopulationCount(byte2), hn::PopulationCount(byte3)));
}

HWY_INLINE Word word_at(const std::uint8_t* place) {
    return {hn::Load(kBytes, place),
            hn::Load(kBytes, place + kLanes),
            hn::Load(kBytes, place + 2 * kLanes),
            hn::Load(kBytes, place + 3 * kLanes)};
}

/// Prefetch distance for memory that is written without being read before. Without the prefetch,
/// every cache line would wait for memory.
constexpr std::ptrdiff_t kCalledAhead = std::ptrdiff_t{2} * kSumsGroup;

/// Returns the least path cost without the matching cost. The disparity stays, changes by one, or
/// jumps. Additions saturate. The entry beyond the last disparity is 255.
HWY_INLINE Bytes cheapest(Bytes below, Bytes here, Bytes above, Bytes slope, Bytes jump) {
    const Bytes neighbour = hn::SaturatedAdd(hn::Min(below, above), slope);
    return hn::Min(hn::Min(neighbour, here), jump);
}

enum class Sums : std::uint8_t { left_alone, written, added_to };

/// Stores the cost of one disparity of one column, to which `sum` and `match` point.
template <Sums kSums>
HWY_INLINE void put_down(Bytes cost, Bytes matching, std::uint8_t* sum, std::uint8_t* match) {
    if constexpr (kSums == Sums::written) {
        hwy::Prefetch(sum + kCalledAhead);
        hn::Store(cost, kBytes, sum);
        if constexpr (kMatchKept) {
            hwy::Prefetch(match + kCalledAhead);
            hn::Store(matching, kBytes, match);
        }
    }
    if constexpr (kSums == Sums::added_to)
        hn::Store(hn::Add(cost, hn::Load(kBytes, sum)), kBytes, sum);
}

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
    const std::uint8_t* right = block.right + u * kCensusRow + lane;
    std::uint8_t* state = block.state + lane;
    Bytes below = none;
    Bytes here = hn::Load(kBytes, state);
    Bytes new_least = none;
    for (int first = 0; first < block.disparities; first += kGroup) {
        const int count = std::min(kGroup, block.disparities - first);
        const std::ptrdiff_t place = first / kGroup * kSumsGroup + u * kSumsColumn + lane;
        std::uint8_t* const sums = block.sums + place;
        std::uint8_t* const matches = block.match + place;
        for (std::ptrdiff_t at = 0; at < count * kLanes; at += kLanes) {
            const Bytes above = hn::Load(kBytes, state + kLanes);
            const Bytes match = kMatchKept && kSums == Sums::added_to
                                    ? hn::Load(kBytes, matches + at)
                                    : distance(left, word_at(right));
            const Bytes cost =
                hn::Add(hn::Sub(cheapest(below, here, above, slope, jump), least), match);
            hn::Store(cost, kBytes, state);
            put_down<kSums>(cost, match, sums + at, matches + at);
            new_least = hn::Min(new_least, cost);
            below = here;
            here = above;
            state += kLanes;
            right -= kCensusRow;
        }
    }
    hn::Store(new_least, kBytes, block.least + lane);
}

template <Sums kSums>
void follow(const RowBlock& block) {
    const std::uint8_t* grey_before = block.grey_before;
    for (int i = 0; i < block.columns; ++i) {
        const std::ptrdiff_t u = kSums == Sums::added_to ? block.columns - 1 - i : i;
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
    for (int d = 0; d < block.disparities; ++d) {
        const std::ptrdiff_t plane = d / kGroup * kSumsGroup + d % kGroup * kLanes;
        turn_sums(block.sums + plane);
        if constexpr (kMatchKept) turn_sums(block.match + plane);
    }
}

HWY_INLINE Word word_of(const std::uint8_t* const bytes[kCensusBytes], std::ptrdiff_t at) {
    return {hn::LoadU(kBytes, bytes[0] + at),
            hn::LoadU(kBytes, bytes[1] + at),
            hn::LoadU(kBytes, bytes[2] + at),
            hn::LoadU(kBytes, bytes[3] + at)};
}

/// The best disparity so far, in a scan over disparities from 0 upward.
struct Winner {
    Bytes disparity, cost, cost_below, cost_above;
    Bytes second;  ///< least cost at least two away from the winner
    Bytes older;   ///< least cost of all disparities except the last
    Bytes last;
    Bytes next;                            ///< next disparity of the scan
    hn::Mask<decltype(kBytes)> older_won;  ///< the last disparity is not the winner

    HWY_INLINE explicit Winner(Bytes none)
        : disparity(hn::Zero(kBytes)),
          cost(none),
          cost_below(none),
          cost_above(none),
          second(none),
          older(none),
          last(none),
          next(hn::Zero(kBytes)),
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
    HWY_INLINE void store(const WinnerRows& out, int lane, Bytes none) const {
        hn::StoreU(disparity, kBytes, out.disparity + lane);
        hn::StoreU(cost, kBytes, out.cost + lane);
        hn::StoreU(cost_below, kBytes, out.cost_below + lane);
        hn::StoreU(hn::IfThenElse(older_won, cost_above, none), kBytes, out.cost_above + lane);
        hn::StoreU(second, kBytes, out.second_cost + lane);
    }
};

/// Does one step of the path from above and finds the winner of all three paths.
void follow_lanes(const ColumnStep& step, int lane, const WinnerRows& out) {
    const Bytes slope = hn::Set(kBytes, step.penalties.slope);
    const Bytes none = hn::Set(kBytes, std::uint8_t{255});
    std::uint8_t* state = step.state + lane;
    const Bytes least = hn::Load(kBytes, step.least + lane);
    const Bytes jump = hn::Add(least,
                               jump_penalty(step.penalties,
                                            hn::LoadU(kBytes, step.grey + lane),
                                            hn::LoadU(kBytes, step.grey_above + lane)));
    const Word left = word_of(step.left, lane);
    // Local copies, because the compiler must assume that the stores below change `step`.
    const std::uint8_t* const right[kCensusBytes] = {
        step.right[0] + lane, step.right[1] + lane, step.right[2] + lane, step.right[3] + lane};
    const int disparities = step.disparities;
    Bytes below = none;
    Bytes here = hn::Load(kBytes, state);
    Bytes new_least = none;
    Winner winner(none);
    for (int first = 0; first < disparities; first += kGroup) {
        const int last = std::min(first + kGroup, disparities);
        const std::uint8_t* sum = step.sums + first / kGroup * kSumsGroup + lane;
        const std::uint8_t* kept = step.match + first / kGroup * kSumsGroup + lane;
        for (std::ptrdiff_t d = first; d < last; ++d) {
            const Bytes above = hn::Load(kBytes, state + kLanes);
            const Bytes match =
                kMatchKept ? hn::Load(kBytes, kept) : distance(left, word_of(right, -d));
            const Bytes cost =
                hn::Add(hn::Sub(cheapest(below, here, above, slope, jump), least), match);
            hn::Store(cost, kBytes, state);
            winner.see(hn::Add(cost, hn::Load(kBytes, sum)));
            new_least = hn::Min(new_least, cost);
            below = here;
            here = above;
            state += kLanes;
            sum += kLanes;
            kept += kLanes;
        }
    }
    hn::Store(new_least, kBytes, step.least + lane);
    winner.store(out, lane, none);
}

void follow_columns_here(const ColumnStep& step, const WinnerRows& out) {
    for (int lane = 0; lane < kLanes; lane += lanes()) follow_lanes(step, lane, out);
}

}  // namespace
}  // namespace surefoot::stereo::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::stereo::kernels {

HWY_EXPORT(census_row);
HWY_EXPORT(transpose_block);
HWY_EXPORT(pass_right_here);
HWY_EXPORT(follow_right_here);
HWY_EXPORT(follow_left_here);
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
void begin_path(int disparities, std::uint8_t* state, std::uint8_t* least) {
    const auto size = static_cast<std::size_t>(disparities) * kLanes;
    std::memset(state, 0, size);
    std::memset(state + size, 255, kLanes);
    std::memset(least, 0, kLanes);
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
void follow_columns(const ColumnStep& step, const WinnerRows& out) {
    HWY_DYNAMIC_DISPATCH(follow_columns_here)(step, out);
}

}  // namespace surefoot::stereo::kernels
#endif  // HWY_ONCE
