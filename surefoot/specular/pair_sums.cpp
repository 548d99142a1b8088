// SPDX-License-Identifier: Apache-2.0
#include "surefoot/specular/pair_sums.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/specular/pair_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>

HWY_BEFORE_NAMESPACE();
namespace surefoot::specular::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Values = hn::CappedTag<std::int16_t, 8>;
using Sums = hn::RepartitionToWide<Values>;

/// Adds the products of two lines to the sums of the blocks. Each block has 4 lanes of sums.
template <int kBlockCells>
HWY_INLINE void add_line(const std::int16_t* near, const std::int16_t* far, std::int32_t* lanes) {
    const Values values;
    const Sums sums;
    constexpr int kLanes = 8;
    for (int b = 0; b < PatchDetail::kBlocks; ++b) {
        auto sum = hn::LoadU(sums, lanes + 4 * b);
        auto other = hn::Zero(sums);
        for (int c = 0; c < kBlockCells; c += kLanes) {
            const int at = b * kBlockCells + c;
            sum = hn::ReorderWidenMulAccumulate(
                sums, hn::LoadU(values, near + at), hn::LoadU(values, far + at), sum, other);
        }
        hn::StoreU(hn::Add(sum, other), sums, lanes + 4 * b);
    }
}

void add_lines(const PatchDetail& detail, int first, int last, int twice, PairSums& out) {
    std::array<std::int32_t, std::size_t{4} * PatchDetail::kBlocks> lanes{};
    const int block_cells = detail.line_cells / PatchDetail::kBlocks;
    for (int i = first; i <= last; ++i) {
        if (block_cells == 8)
            add_line<8>(detail.line(i), detail.line(twice - i), lanes.data());
        else
            add_line<16>(detail.line(i), detail.line(twice - i), lanes.data());
    }
    for (std::size_t b = 0; b < out.sum.size(); ++b)
        out.sum[b] = lanes[4 * b] + lanes[4 * b + 1] + lanes[4 * b + 2] + lanes[4 * b + 3];
}

}  // namespace
}  // namespace surefoot::specular::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::specular {
namespace {

HWY_EXPORT(add_lines);

/// Lines on the first side of the mirror line that have a partner inside the patch.
struct Lines {
    int first = 0;
    int last = -1;
};

/// Returns the lines with a partner for mirror line `twice`, which must not be negative.
Lines paired_lines(const PatchDetail& detail, int twice, int most_apart) {
    return {std::max({0, twice - detail.lines + 1, (twice - most_apart + 1) / 2}),
            std::min((twice - kLeastApart) / 2, detail.lines - 1)};
}

}  // namespace

PairSums pair_sums(const PatchDetail& detail, int twice, int most_apart) {
    PairSums out;
    if (twice < kLeastApart) return out;
    const Lines lines = paired_lines(detail, twice, most_apart);
    HWY_DYNAMIC_DISPATCH(add_lines)(detail, lines.first, lines.last, twice, out);
    for (int i = lines.first; i <= lines.last; ++i) {
        const std::int16_t* near = detail.known_in(i);
        const std::int16_t* far = detail.known_in(twice - i);
        for (std::size_t b = 0; b < out.pairs.size(); ++b)
            out.pairs[b] += std::min(near[b], far[b]);
    }
    return out;
}

PairSums pair_sums_reference(const PatchDetail& detail, int twice, int most_apart) {
    PairSums out;
    const int block_cells = detail.line_cells / PatchDetail::kBlocks;
    for (int i = 0; i < detail.lines; ++i) {
        const int partner = twice - i;
        const int apart = partner - i;
        if (partner < 0 || partner >= detail.lines) continue;
        if (apart < kLeastApart || apart > most_apart) continue;
        for (int c = 0; c < detail.line_cells; ++c)
            out.sum[static_cast<std::size_t>(c / block_cells)] +=
                detail.line(i)[c] * detail.line(partner)[c];
        for (std::size_t b = 0; b < out.pairs.size(); ++b)
            out.pairs[b] += std::min(detail.known_in(i)[b], detail.known_in(partner)[b]);
    }
    return out;
}

}  // namespace surefoot::specular
#endif  // HWY_ONCE
