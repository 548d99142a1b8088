// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/motion/motion_rows.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/elevation/motion/motion_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace surefoot::elevation::HWY_NAMESPACE {
namespace {

void blur(const MotionPolynomials& p,
          int cells,
          const float* HWY_RESTRICT height_m,
          float* HWY_RESTRICT height_var_m2,
          float* HWY_RESTRICT drift_m) {
    for (int i = 0; i < cells; ++i) {
        const float x = p.first_x_m + p.step_m * static_cast<float>(i);
        const float z = height_m[i] - p.body_z_m;
        const float height = p.h[0] + x * (p.h[1] + x * p.h[2]);
        const float xx = p.xx[0] + z * (p.xx[1] + z * p.xx[2]);
        const float yy =
            p.yy[0] + x * (p.yy[1] + x * p.yy[3]) + z * (p.yy[2] + x * p.yy[4] + z * p.yy[5]);
        const float xy = p.xy[0] + x * p.xy[1] + z * (p.xy[2] + x * p.xy[3] + z * p.xy[4]);
        const float half = 0.5F * (xx - yy);
        const float larger = 0.5F * (xx + yy) + std::sqrt(half * half + xy * xy);
        const float more_m2 = larger > 0.0F ? larger : 0.0F * z;  // NaN stays NaN
        height_var_m2[i] += height > 0.0F ? height : 0.0F;
        drift_m[i] = std::sqrt(drift_m[i] * drift_m[i] + more_m2);
    }
}

}  // namespace
}  // namespace surefoot::elevation::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::elevation {

HWY_EXPORT(blur);

void blur_cells(const MotionPolynomials& p,
                int cells,
                const float* height_m,
                float* height_var_m2,
                float* horizontal_drift_m) {
    HWY_DYNAMIC_DISPATCH(blur)(p, cells, height_m, height_var_m2, horizontal_drift_m);
}

}  // namespace surefoot::elevation
#endif  // HWY_ONCE
