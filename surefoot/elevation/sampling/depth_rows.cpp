// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/sampling/depth_rows.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/elevation/sampling/depth_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cstring>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace surefoot::elevation::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

HWY_INLINE V set(float value) {
    return hn::Set(D(), value);
}

/// Vector version of SurfaceCheck::gradient.
HWY_INLINE V gradient(V before, V after, V here, V limit, V per_reach) {
    const V half = set(0.5F);
    const V departure = hn::Abs(hn::Sub(hn::Mul(half, hn::Add(before, after)), here));
    const V middle = hn::Mul(hn::Mul(half, hn::Sub(after, before)), per_reach);
    const V both = hn::IfThenElse(hn::Gt(departure, limit), hn::NaN(D()), middle);
    const V to_before = hn::Mul(hn::Sub(here, before), per_reach);
    const V to_after = hn::Mul(hn::Sub(after, here), per_reach);
    return hn::IfThenElse(
        hn::IsNaN(before), to_after, hn::IfThenElse(hn::IsNaN(after), to_before, both));
}

struct Pixels {
    V disparity, sigma, outlier, before, after, above, below;
};

HWY_INLINE V squared(V value) {
    return hn::Mul(value, value);
}

/// Vector version of SurfaceCheck::accepts.
HWY_INLINE M accepts(const SurfaceLimits& l, const Pixels& p, V ray_x, V ray_y) {
    const V limit = hn::Add(set(l.jump_px), hn::Mul(set(l.jump_sigma), p.sigma));
    const V per_reach = set(l.per_reach);
    const V a = hn::Mul(gradient(p.before, p.after, p.disparity, limit, per_reach), set(l.fx_px));
    const V b = hn::Mul(gradient(p.above, p.below, p.disparity, limit, per_reach), set(l.fy_px));
    const V c = hn::Sub(hn::Sub(p.disparity, hn::Mul(a, ray_x)), hn::Mul(b, ray_y));
    const V normal_sq = hn::Add(hn::Add(squared(a), squared(b)), squared(c));
    const V ray_sq = hn::Add(hn::Add(squared(ray_x), squared(ray_y)), set(1.0F));
    const V norms_sq = hn::Mul(normal_sq, ray_sq);
    const V facing_sq = squared(p.disparity);
    const M facing = hn::Ge(facing_sq, hn::Mul(set(l.min_cosine_sq), norms_sq));
    const V upward =
        hn::Add(hn::Add(hn::Mul(a, set(l.up_x)), hn::Mul(b, set(l.up_y))), hn::Mul(c, set(l.up_z)));
    const M level = hn::Ge(squared(upward), hn::Mul(set(l.min_level_cosine_sq), normal_sq));
    const M faces_enough = hn::Ge(facing_sq, hn::Mul(set(l.min_cosine_when_level_sq), norms_sq));
    const M leans = hn::Ne(upward, hn::Zero(D()));
    const V rise =
        hn::Add(hn::Add(hn::Mul(ray_x, set(l.up_x)), hn::Mul(ray_y, set(l.up_y))), set(l.up_z));
    const M flat = hn::Le(squared(rise), hn::Mul(set(l.min_cosine_sq), ray_sq));
    return hn::Or(facing, hn::And(hn::And(level, faces_enough), hn::And(leans, flat)));
}

HWY_INLINE std::int64_t count(M mask) {
    return static_cast<std::int64_t>(hn::CountTrue(D(), mask));
}

HWY_INLINE V ray_along(const DepthRow& row, int axis, V x) {
    return hn::Add(set(row.start[axis]), hn::Mul(x, set(row.along[axis])));
}

/// Returns the height variance from the model `matcher` and from an error of the camera's roll and
/// pitch.
HWY_INLINE V height_variance(const DepthFrame& f, V depth, V range, V sigma, V ray_up, V ray_sq) {
    const V along = hn::Div(hn::Mul(hn::Mul(depth, range), sigma), set(f.depth_to_disparity_px_m));
    const V lateral = hn::Mul(hn::Mul(set(f.lateral_px), depth), set(f.per_focal_px));
    const V floor = set(f.min_var_m2);
    const V along_var = hn::Max(squared(along), floor);
    const V lateral_var = hn::Max(squared(lateral), floor);
    const V n_sq = hn::Div(squared(ray_up), ray_sq);
    const V beside_sq = hn::Mul(squared(depth), hn::Sub(ray_sq, squared(ray_up)));
    return hn::Add(
        hn::Add(hn::Mul(along_var, n_sq), hn::Mul(lateral_var, hn::Sub(set(1.0F), n_sq))),
        hn::Mul(set(f.tilt_var), beside_sq));
}

/// Processes one register of pixels from column `u` on.
HWY_INLINE void add_pixels(const DepthFrame& f,
                           const DepthRow& row,
                           const Pixels& p,
                           int u,
                           const CellSamples::Columns& out,
                           RowCounts& counts) {
    const V zero = hn::Zero(D());
    const M valid = hn::And(hn::Gt(p.disparity, zero), hn::Lt(p.disparity, set(kInfinity)));
    const V column = hn::Iota(D(), static_cast<float>(u));
    const V x = hn::Mul(hn::Sub(column, set(f.cx_px)), set(f.per_fx));
    const V y = set(row.ray_y);
    M trusted = hn::And(hn::Le(p.outlier, set(f.max_outlier_probability)),
                        hn::And(hn::Gt(p.sigma, zero), hn::Lt(p.sigma, set(kInfinity))));
    if (f.surface_check) trusted = hn::And(trusted, accepts(f.surface, p, x, y));
    const M kept = hn::And(valid, trusted);

    const V depth = hn::Div(set(f.depth_to_disparity_px_m), p.disparity);
    const V ray_sq = hn::Add(hn::Add(squared(x), squared(y)), set(1.0F));
    const V range = hn::Mul(depth, hn::Sqrt(ray_sq));
    const M in_range = hn::And(
        kept, hn::And(hn::Ge(range, set(f.min_range_m)), hn::Le(range, set(f.max_range_m))));
    const V ray_up = ray_along(row, 2, x);
    const V z = hn::Add(set(f.camera_m[2]), hn::Mul(depth, ray_up));
    const M in_height = hn::And(in_range, hn::Le(z, set(f.max_z_m)));
    const V fx = hn::Mul(hn::Add(set(f.camera_m[0]), hn::Mul(depth, ray_along(row, 0, x))),
                         set(f.per_cell_m));
    const V fy = hn::Mul(hn::Add(set(f.camera_m[1]), hn::Mul(depth, ray_along(row, 1, x))),
                         set(f.per_cell_m));
    const M inside = hn::And(hn::And(in_height, hn::And(hn::Ge(fx, zero), hn::Ge(fy, zero))),
                             hn::And(hn::Lt(fx, set(static_cast<float>(f.nx))),
                                     hn::Lt(fy, set(static_cast<float>(f.ny)))));

    const std::int64_t n_valid = count(valid);
    const std::int64_t n_kept = count(kept);
    const std::int64_t n_in_range = count(in_range);
    const std::int64_t n_in_height = count(in_height);
    const std::int64_t n_inside = count(inside);
    counts.points += n_valid;
    counts.gated_confidence += n_valid - n_kept;
    counts.gated_range += n_kept - n_in_range;
    counts.gated_height += n_in_range - n_in_height;
    counts.outside += n_in_height - n_inside;
    if (n_inside == 0) return;

    const hn::RebindToSigned<D> di;
    const hn::RebindToUnsigned<D> du;
    const auto ix = hn::ConvertTo(di, hn::IfThenElseZero(inside, fx));
    const auto iy = hn::ConvertTo(di, hn::IfThenElseZero(inside, fy));
    const auto cell = hn::Add(hn::Mul(iy, hn::Set(di, f.nx)), ix);
    const V var = height_variance(f, depth, range, p.sigma, ray_up, ray_sq);
    const std::size_t at = counts.samples;
    if (static_cast<std::size_t>(n_inside) == hn::Lanes(D())) {
        hn::StoreU(hn::BitCast(du, cell), du, out.cell + at);
        hn::StoreU(z, D(), out.z_m + at);
        hn::StoreU(var, D(), out.var_m2 + at);
    } else {
        hn::CompressStore(hn::BitCast(du, cell), hn::RebindMask(du, inside), du, out.cell + at);
        hn::CompressStore(z, inside, D(), out.z_m + at);
        hn::CompressStore(var, inside, D(), out.var_m2 + at);
    }
    counts.samples = at + static_cast<std::size_t>(n_inside);
}

RowCounts samples_row(const DepthFrame& frame, const DepthRow& row, CellSamples::Columns out) {
    const int lanes = static_cast<int>(hn::Lanes(D()));
    RowCounts counts;
    const auto load = [](const float* from, int u) { return hn::LoadU(D(), from + u); };
    int u = 0;
    for (; u + lanes <= row.width; u += lanes) {
        const Pixels pixels{load(row.disparity_px, u),
                            load(row.sigma_px, u),
                            load(row.outlier_probability, u),
                            load(row.before_px, u),
                            load(row.after_px, u),
                            load(row.above_px, u),
                            load(row.below_px, u)};
        add_pixels(frame, row, pixels, u, out, counts);
    }
    if (u == row.width) return counts;
    const auto load_rest = [&](const float* from) {
        HWY_ALIGN float rest[hn::MaxLanes(D())];
        for (int i = 0; i < lanes; ++i) {
            rest[i] = u + i < row.width ? from[u + i] : std::numeric_limits<float>::quiet_NaN();
        }
        return hn::Load(D(), rest);
    };
    const Pixels pixels{load_rest(row.disparity_px),
                        load_rest(row.sigma_px),
                        load_rest(row.outlier_probability),
                        load_rest(row.before_px),
                        load_rest(row.after_px),
                        load_rest(row.above_px),
                        load_rest(row.below_px)};
    add_pixels(frame, row, pixels, u, out, counts);
    return counts;
}

}  // namespace
}  // namespace surefoot::elevation::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::elevation {

HWY_EXPORT(samples_row);

RowCounts samples_of_row(const DepthFrame& frame, const DepthRow& row, CellSamples::Columns out) {
    return HWY_DYNAMIC_DISPATCH(samples_row)(frame, row, out);
}

}  // namespace surefoot::elevation
#endif  // HWY_ONCE
