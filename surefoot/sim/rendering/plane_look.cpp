// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/plane_look.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/sim/rendering/plane_look.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

/// Plain loops over arrays, as in texture_batch.cpp. Dot products are summed in the order of Eigen.
HWY_BEFORE_NAMESPACE();
namespace surefoot::sim::HWY_NAMESPACE {
namespace {

struct Axis {
    double x;
    double y;
    double z;
};

HWY_INLINE double dot(const Axis& a, double x, double y, double z) {
    return a.x * x + a.y * y + a.z * z;
}

void look_here(const PlaneTexels& plane, const SightBatch& in, TextureBatch& out) {
    const Axis u{plane.texel_u.x(), plane.texel_u.y(), plane.texel_u.z()};
    const Axis v{plane.texel_v.x(), plane.texel_v.y(), plane.texel_v.z()};
    const Axis normal{plane.normal.x(), plane.normal.y(), plane.normal.z()};
    const double u_texel = plane.u_texel;
    const double v_texel = plane.v_texel;
    const double texels_per_m = plane.texels_per_m;
    const std::size_t count = in.count;
    for (std::size_t i = 0; i < count; ++i) {
        const double x = in.points_m.x[i];
        const double y = in.points_m.y[i];
        const double z = in.points_m.z[i];
        const double at_u = dot(u, x, y, z) + u_texel;
        const double at_v = dot(v, x, y, z) + v_texel;
        out.u[i] = TextureTable::place(at_u);
        out.v[i] = TextureTable::place(at_v);
        out.blotch_u[i] = TextureTable::place(at_u * kBlotchScale);
        out.blotch_v[i] = TextureTable::place(at_v * kBlotchScale);
    }
    for (std::size_t i = 0; i < count; ++i) {
        const double x = in.directions.x[i];
        const double y = in.directions.y[i];
        const double z = in.directions.z[i];
        out.along_u[i] = static_cast<float>(dot(u, x, y, z));
        out.along_v[i] = static_cast<float>(dot(v, x, y, z));
        const double cosine = -dot(normal, x, y, z);
        out.cosine[i] = static_cast<float>(cosine < kLeastCosine ? kLeastCosine : cosine);
        out.minor_texel[i] = static_cast<float>(in.way_m[i] * in.pixel_angle_rad[i] * texels_per_m);
    }
    out.count = count;
}

}  // namespace
}  // namespace surefoot::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::sim {

HWY_EXPORT(look_here);

TexelLook look_at(const PlaneTexels& plane, const Sight& sight) {
    TexelLook look;
    look.at_texel = {plane.texel_u.dot(sight.point_m) + plane.u_texel,
                     plane.texel_v.dot(sight.point_m) + plane.v_texel};
    look.along_texel = {static_cast<float>(plane.texel_u.dot(sight.direction)),
                        static_cast<float>(plane.texel_v.dot(sight.direction))};
    look.minor_texel = static_cast<float>(sight.way_m * sight.pixel_angle_rad * plane.texels_per_m);
    look.cosine = static_cast<float>(std::max(-plane.normal.dot(sight.direction), kLeastCosine));
    return look;
}

void look_at(const PlaneTexels& plane, const SightBatch& sights, TextureBatch& out) {
    HWY_DYNAMIC_DISPATCH(look_here)(plane, sights, out);
}

}  // namespace surefoot::sim
#endif  // HWY_ONCE
