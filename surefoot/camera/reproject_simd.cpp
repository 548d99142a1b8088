// SPDX-License-Identifier: Apache-2.0
// Each pixel needs one division and two products, but no sum. So all targets round equally.
#include "surefoot/camera/reproject_simd.hpp"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/camera/reproject_simd.cpp"
#include <hwy/foreach_target.h>
// This include must come after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace surefoot::camera::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float),
              "points are written as three plain floats without padding");

/// Computes as many whole vectors of D as fit, from `first`; returns the first remaining pixel.
template <class D>
HWY_INLINE int reproject_vectors(D d, const DisparityRow& row, int first, float* HWY_RESTRICT out) {
    const int lanes = static_cast<int>(hn::Lanes(d));
    const auto depth_to_disparity = hn::Set(d, row.depth_to_disparity_px_m);
    const auto ray_y = hn::Set(d, row.ray_y);
    const auto unknown = hn::Set(d, std::numeric_limits<float>::quiet_NaN());
    const auto infinite = hn::Set(d, std::numeric_limits<float>::infinity());
    int u = first;
    for (; u + lanes <= row.width; u += lanes) {
        const auto quotient = hn::Div(depth_to_disparity, hn::LoadU(d, row.disparity_px + u));
        // A disparity of 0 gives infinity; a disparity of infinity gives 0.
        const auto known = hn::And(hn::Gt(quotient, hn::Zero(d)), hn::Lt(quotient, infinite));
        const auto z = hn::IfThenElse(known, quotient, unknown);
        const auto x = hn::Mul(hn::LoadU(d, row.ray_x + u), z);
        const auto y = hn::Mul(ray_y, z);
        hn::StoreInterleaved3(x, y, z, d, out + 3 * u);
    }
    return u;
}

void reproject_here(const DisparityRow& row, Eigen::Vector3f* out) {
    float* floats = out->data();
    const int done = reproject_vectors(hn::ScalableTag<float>(), row, 0, floats);
    reproject_vectors(hn::CappedTag<float, 1>(), row, done, floats);
}

}  // namespace surefoot::camera::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::camera {

HWY_EXPORT(reproject_here);

void reproject_row(const DisparityRow& row, Eigen::Vector3f* out) {
    if (row.width > 0) HWY_DYNAMIC_DISPATCH(reproject_here)(row, out);
}

}  // namespace surefoot::camera
#endif  // HWY_ONCE
