// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/group_samples.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/elevation/fusion/group_samples.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace surefoot::elevation::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Vector type for runs. Most runs are shorter than this vector, and a store beyond a run takes no
/// extra time.
using D = hn::CappedTag<float, 8>;
using DU = hn::ScalableTag<std::uint32_t>;

/// Number of samples per search for runs, so small that they stay in the L1 cache.
constexpr std::size_t kChunk = 512;

/// Finds the begins of runs of equal cells among samples [first, last), except for `first` itself.
/// Returns the number of runs that were found.
HWY_INLINE std::size_t find_runs(const std::uint32_t* cell,
                                 std::size_t first,
                                 std::size_t last,
                                 std::uint32_t* begins) {
    const DU d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t runs = 0;
    std::size_t i = first + 1;
    for (; i + lanes <= last; i += lanes) {
        const auto differs = hn::Ne(hn::LoadU(d, cell + i), hn::LoadU(d, cell + i - 1));
        const auto index = hn::Iota(d, static_cast<std::uint32_t>(i));
        runs += hn::CompressStore(index, differs, d, begins + runs);
    }
    for (; i < last; ++i) {
        begins[runs] = static_cast<std::uint32_t>(i);
        runs += cell[i] != cell[i - 1] ? 1 : 0;
    }
    return runs;
}

/// Calls f(first sample, length) for every run of equal cells; a long run may come in parts. Calls
/// ahead(first sample) some runs before f.
template <class F, class Ahead>
HWY_INLINE void for_each_run(const std::uint32_t* cell,
                             std::size_t samples,
                             const F& f,
                             const Ahead& ahead) {
    constexpr std::size_t kAhead = 8;
    std::uint32_t begins[kChunk + hn::MaxLanes(DU()) + kAhead];
    for (std::size_t first = 0; first < samples; first += kChunk) {
        const std::size_t last = std::min(first + kChunk, samples);
        const std::size_t runs = find_runs(cell, first, last, begins);
        for (std::size_t k = 0; k <= kAhead; ++k)
            begins[runs + k] = static_cast<std::uint32_t>(last);
        auto begin = static_cast<std::uint32_t>(first);
        for (std::size_t k = 0; k <= runs; ++k) {
            if (begins[k + kAhead] < last) ahead(begins[k + kAhead]);
            f(begin, begins[k] - begin);
            begin = begins[k];
        }
    }
}

void count_runs(const std::uint32_t* cell, std::size_t samples, std::uint32_t* count) {
    for_each_run(
        cell,
        samples,
        [=](std::uint32_t first, std::uint32_t n) { count[cell[first]] += n; },
        [](std::uint32_t) {});
}

void place_runs(const std::uint32_t* cell,
                const float* z_m,
                const float* var_m2,
                std::size_t samples,
                const SamplePlaces& to) {
    const D d;
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
    const SamplePlaces places = to;  // a local copy that no vector store can alias
    const auto place = [=](std::uint32_t first, std::uint32_t n) {
        const std::uint32_t next = places.next[cell[first]];
        places.next[cell[first]] = next + n;
        for (std::uint32_t k = 0; k < n; k += lanes) {
            const auto exists = hn::FirstN(d, n - k);
            hn::BlendedStore(hn::LoadU(d, z_m + first + k), exists, d, places.z_m + next + k);
            hn::BlendedStore(hn::LoadU(d, var_m2 + first + k), exists, d, places.var_m2 + next + k);
        }
    };
    // Along a row of pixels the cells are far apart in memory, so their memory is prefetched.
    const auto fetch = [=](std::uint32_t first) {
        const std::uint32_t next = places.next[cell[first]];
        hwy::Prefetch(places.z_m + next);
        hwy::Prefetch(places.var_m2 + next);
    };
    for_each_run(cell, samples, place, fetch);
}

}  // namespace
}  // namespace surefoot::elevation::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::elevation {

HWY_EXPORT(count_runs);
HWY_EXPORT(place_runs);

void count_samples(const std::uint32_t* cell, std::size_t samples, std::uint32_t* count) {
    HWY_DYNAMIC_DISPATCH(count_runs)(cell, samples, count);
}

void place_samples(const std::uint32_t* cell,
                   const float* z_m,
                   const float* var_m2,
                   std::size_t samples,
                   const SamplePlaces& to) {
    HWY_DYNAMIC_DISPATCH(place_runs)(cell, z_m, var_m2, samples, to);
}

}  // namespace surefoot::elevation
#endif  // HWY_ONCE
