// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/light.hpp"

#include <initializer_list>

namespace surefoot::pipeline {
namespace {

Light light_of(const GreyImage& image) noexcept {
    constexpr int kStride_px = 4;
    int looked_at = 0;
    int saturated = 0;
    int black = 0;
    for (int v = 0; v < image.height(); v += kStride_px) {
        for (int u = 0; u < image.width(); u += kStride_px, ++looked_at) {
            const int grey_dn = image.row(v)[u];
            saturated += grey_dn >= kSaturated_dn ? 1 : 0;
            black += grey_dn <= kBlack_dn ? 1 : 0;
        }
    }
    if (saturated > kMaxSaturatedShare * looked_at) return Light::overexposed;
    if (black > kMaxBlackShare * looked_at) return Light::dark;
    return Light::lit;
}

}  // namespace

Light light_of(const StereoFrame& frame) noexcept {
    for (const GreyImage* image : {&frame.left, &frame.right}) {
        if (image->empty()) continue;
        if (const Light light = light_of(*image); light != Light::lit) return light;
    }
    return Light::lit;
}

}  // namespace surefoot::pipeline
