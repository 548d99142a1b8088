// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/texture.hpp"
#include "surefoot/sim/rendering/texture_lookup.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/sim/rendering/texture_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

/// Plain loops over arrays that the compiler turns into vector code (this file is compiled with
/// -O3). There is one version for every instruction set; the program selects one at run time.
HWY_BEFORE_NAMESPACE();
namespace surefoot::sim::HWY_NAMESPACE {
namespace {

using Place = TextureTable::Place;
template <typename T>
using Array = TextureBatch::Array<T>;

/// The look-ups that each point of a batch needs.
struct Plan {
    Array<int> taps;
    Array<Place> u;  ///< position of the next tap
    Array<Place> v;
    Array<Place> du;
    Array<Place> dv;
    Array<float> level;
    Array<float> blotch_level;
    Array<std::uint32_t> fine_sum;
    Array<std::uint32_t> coarse_sum;
};

HWY_INLINE int make_plan(const TextureBatch& in, Plan& plan) {
    int most_taps = 1;
    for (std::size_t i = 0; i < in.count; ++i) {
        const lookup::Cover cover =
            lookup::cover_of(in.along_u[i], in.along_v[i], in.minor_texel[i], in.cosine[i]);
        plan.taps[i] = cover.taps;
        plan.level[i] = cover.level;
        plan.blotch_level[i] = cover.blotch_level;
        plan.du[i] = cover.du;
        plan.dv[i] = cover.dv;
        plan.u[i] = lookup::first_tap(in.u[i], cover.du, cover.taps);
        plan.v[i] = lookup::first_tap(in.v[i], cover.dv, cover.taps);
        plan.fine_sum[i] = 0;
        plan.coarse_sum[i] = 0;
        most_taps = std::max(most_taps, cover.taps);
    }
    return most_taps;
}

HWY_INLINE void add_tap(const std::uint32_t* cells, int tap, std::size_t count, Plan& plan) {
    for (std::size_t i = 0; i < count; ++i) {
        const lookup::Levels levels = lookup::levels_of(plan.level[i]);
        // Points that need no further tap also do the look-up, but discard the result.
        const std::uint32_t wanted = tap < plan.taps[i] ? ~0U : 0U;
        plan.fine_sum[i] += wanted & lookup::bilinear(cells, levels.fine, plan.u[i], plan.v[i]);
        plan.coarse_sum[i] += wanted & lookup::bilinear(cells, levels.coarse, plan.u[i], plan.v[i]);
        plan.u[i] += plan.du[i];
        plan.v[i] += plan.dv[i];
    }
}

void look_up(const std::uint32_t* cells,
             const Placement& placement,
             const TextureBatch& in,
             float* out) {
    Plan plan;  // make_plan fills it. NOLINT(cppcoreguidelines-pro-type-member-init)
    const int most_taps = make_plan(in, plan);
    for (int tap = 0; tap < most_taps; ++tap) add_tap(cells, tap, in.count, plan);
    for (std::size_t i = 0; i < in.count; ++i) {
        const lookup::Levels levels = lookup::levels_of(plan.level[i]);
        const float detail =
            lookup::pattern_value(plan.fine_sum[i], plan.coarse_sum[i], levels.share, plan.taps[i]);
        const lookup::Levels wide = lookup::levels_of(plan.blotch_level[i]);
        const float blotch = lookup::pattern_value(
            lookup::bilinear(cells, wide.fine, in.blotch_u[i], in.blotch_v[i]),
            lookup::bilinear(cells, wide.coarse, in.blotch_u[i], in.blotch_v[i]),
            wide.share,
            1);
        out[i] = lookup::reflectance(placement.albedo, placement.contrast, detail, blotch);
    }
}

}  // namespace
}  // namespace surefoot::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::sim {

HWY_EXPORT(look_up);

void Textures::reflectances(const Placement& placement,
                            const TextureBatch& batch,
                            float* out) const noexcept {
    HWY_DYNAMIC_DISPATCH(look_up)(tables_[placement.table].cells(), placement, batch, out);
}

}  // namespace surefoot::sim
#endif  // HWY_ONCE
