// SPDX-License-Identifier: Apache-2.0
// Products are summed in the order that Eigen uses for three doubles. A dot product, and each of
// the first two rows of matrix times vector, is (x + y) + z. The third row is x + (y + z). No
// multiply-add is fused, and divisions are correctly rounded, so all instruction sets give the same
// results.
#include "surefoot/sim/rendering/ray_batch.hpp"

#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/sim/rendering/ray_batch.cpp"
#include <hwy/foreach_target.h>
// This include must come after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace surefoot::sim::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

/// Calls `work(d, i)` for whole vectors of rays, then for the remaining single rays.
template <class Work>
HWY_INLINE void for_each_ray(BatchRange range, const Work& work) {
    const hn::ScalableTag<double> wide;
    const std::size_t lanes = hn::Lanes(wide);
    std::size_t i = range.first;
    for (; i + lanes <= range.end; i += lanes) work(wide, i);
    for (; i < range.end; ++i) work(hn::CappedTag<double, 1>(), i);
}

/// Three coordinates for each SIMD lane: the same values in all lanes, or those of one ray per
/// lane.
template <class D>
struct Three {
    hn::Vec<D> x;
    hn::Vec<D> y;
    hn::Vec<D> z;

    HWY_INLINE Three(D d, double x_all, double y_all, double z_all)
        : x(hn::Set(d, x_all)), y(hn::Set(d, y_all)), z(hn::Set(d, z_all)) {}
    HWY_INLINE Three(D d, const double* x_of, const double* y_of, const double* z_of)
        : x(hn::LoadU(d, x_of)), y(hn::LoadU(d, y_of)), z(hn::LoadU(d, z_of)) {}
};

template <class D>
HWY_INLINE Three<D> all_of(D d, const Eigen::Vector3d& v) {
    return {d, v.x(), v.y(), v.z()};
}

template <class D>
HWY_INLINE hn::Vec<D> dot(D /*d*/, const Three<D>& a, const Three<D>& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

template <class D>
HWY_INLINE Three<D> rays_at(D d, const RayBatch& rays, std::size_t i) {
    return {d, &rays.x[i], &rays.y[i], &rays.z[i]};
}

template <class D>
HWY_INLINE void store_faces(D /*d*/, hn::Vec<D> faces, int* out) {
    const hn::Rebind<std::int32_t, D> whole;
    hn::StoreU(hn::DemoteTo(whole, faces), whole, out);
}

void turn_here(const Eigen::Matrix3d& R,
               const double* x,
               const double* y,
               const double* z,
               BatchRange range,
               RayBatch& out) {
    for_each_ray(range, [&](auto d, std::size_t i) HWY_ATTR {
        const Three<decltype(d)> ray(d, x + i, y + i, z + i);
        hn::StoreU(dot(d, all_of(d, R.row(0)), ray), d, &out.x[i]);
        hn::StoreU(dot(d, all_of(d, R.row(1)), ray), d, &out.y[i]);
        const Three<decltype(d)> last = all_of(d, R.row(2));
        const auto tail = hn::Add(hn::Mul(last.y, ray.y), hn::Mul(last.z, ray.z));
        hn::StoreU(hn::Add(hn::Mul(last.x, ray.x), tail), d, &out.z[i]);
    });
}

void plane_here(const Eigen::Vector3d& normal,
                double above_m,
                int face,
                const RayBatch& rays,
                BatchRange range,
                HitBatch& hits) {
    for_each_ray(range, [&](auto d, std::size_t i) HWY_ATTR {
        const auto speed = dot(d, all_of(d, normal), rays_at(d, rays, i));
        const auto met = hn::Lt(speed, hn::Zero(d));
        const auto distance = hn::Div(hn::Set(d, -above_m), speed);
        const auto never = hn::Set(d, std::numeric_limits<double>::infinity());
        hn::StoreU(hn::IfThenElse(met, distance, never), d, &hits.distance_m[i]);
        store_faces(d,
                    hn::IfThenElse(met, hn::Set(d, static_cast<double>(face)), hn::Set(d, -1.0)),
                    &hits.face[i]);
    });
}

void convex_here(const FacingSide* sides,
                 std::size_t towards,
                 std::size_t count,
                 const RayBatch& rays,
                 BatchRange range,
                 HitBatch& hits) {
    for_each_ray(range, [&](auto d, std::size_t i) HWY_ATTR {
        const auto ray = rays_at(d, rays, i);
        const auto zero = hn::Zero(d);
        const auto before = hn::LoadU(d, &hits.distance_m[i]);
        auto enter = zero;
        auto face = hn::Set(d, -1.0);
        auto met = hn::Eq(zero, zero);
        for (std::size_t k = 0; k < towards; ++k) {
            const auto speed = dot(d, all_of(d, sides[k].normal), ray);
            const auto t = hn::Div(hn::Set(d, -sides[k].outside_m), speed);
            met = hn::And(met, hn::And(hn::Lt(speed, zero), hn::Lt(t, before)));
            if (hn::AllFalse(d, met)) return;
            const auto later = hn::Gt(t, enter);
            enter = hn::IfThenElse(later, t, enter);
            face = hn::IfThenElse(later, hn::Set(d, static_cast<double>(sides[k].face)), face);
        }
        for (std::size_t k = towards; k < count; ++k) {
            const auto speed = dot(d, all_of(d, sides[k].normal), ray);
            const auto left = hn::Ge(hn::Mul(enter, speed), hn::Set(d, -sides[k].outside_m));
            met = hn::AndNot(hn::And(hn::Gt(speed, zero), left), met);
            if (hn::AllFalse(d, met)) return;
        }
        hn::StoreU(hn::IfThenElse(met, enter, before), d, &hits.distance_m[i]);
        const hn::Rebind<std::int32_t, decltype(d)> whole;
        const auto old = hn::PromoteTo(d, hn::LoadU(whole, &hits.face[i]));
        store_faces(d, hn::IfThenElse(met, face, old), &hits.face[i]);
    });
}

void points_here(const Eigen::Vector3d& origin_m,
                 const RayBatch& rays,
                 const HitBatch& hits,
                 BatchRange range,
                 PointBatch& out) {
    for_each_ray(range, [&](auto d, std::size_t i) HWY_ATTR {
        const auto ray = rays_at(d, rays, i);
        const auto from = all_of(d, origin_m);
        const auto way = hn::LoadU(d, &hits.distance_m[i]);
        hn::StoreU(hn::Add(from.x, hn::Mul(way, ray.x)), d, &out.x[i]);
        hn::StoreU(hn::Add(from.y, hn::Mul(way, ray.y)), d, &out.y[i]);
        hn::StoreU(hn::Add(from.z, hn::Mul(way, ray.z)), d, &out.z[i]);
    });
}

}  // namespace
}  // namespace surefoot::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::sim {

HWY_EXPORT(turn_here);
HWY_EXPORT(plane_here);
HWY_EXPORT(convex_here);
HWY_EXPORT(points_here);

void turn_rays(const Eigen::Matrix3d& R_world_camera,
               const double* x,
               const double* y,
               const double* z,
               BatchRange range,
               RayBatch& out) {
    HWY_DYNAMIC_DISPATCH(turn_here)(R_world_camera, x, y, z, range, out);
}

void meet_plane(const Eigen::Vector3d& normal,
                double above_m,
                int face,
                const RayBatch& rays,
                BatchRange range,
                HitBatch& hits) {
    HWY_DYNAMIC_DISPATCH(plane_here)(normal, above_m, face, rays, range, hits);
}

void meet_convex(const FacingSide* sides,
                 std::size_t towards,
                 std::size_t count,
                 const RayBatch& rays,
                 BatchRange range,
                 HitBatch& hits) {
    if (towards > 0) HWY_DYNAMIC_DISPATCH(convex_here)(sides, towards, count, rays, range, hits);
}

void end_points(const Eigen::Vector3d& origin_m,
                const RayBatch& rays,
                const HitBatch& hits,
                BatchRange range,
                PointBatch& out) {
    HWY_DYNAMIC_DISPATCH(points_here)(origin_m, rays, hits, range, out);
}

}  // namespace surefoot::sim
#endif  // HWY_ONCE
