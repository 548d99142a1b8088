// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/exposure_state.hpp"

#include <initializer_list>

namespace surefoot::pipeline {
namespace {

ExposureState exposure_state_of(const GreyImage& image) noexcept {
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
    if (saturated > kMaxSaturatedShare * looked_at) return ExposureState::overexposed;
    if (black > kMaxBlackShare * looked_at) return ExposureState::dark;
    return ExposureState::well_exposed;
}

}  // namespace

ExposureState exposure_state_of(const StereoFrame& frame) noexcept {
    for (const GreyImage* image : {&frame.left, &frame.right}) {
        if (image->empty()) continue;
        if (const ExposureState light = exposure_state_of(*image);
            light != ExposureState::well_exposed)
            return light;
    }
    return ExposureState::well_exposed;
}

}  // namespace surefoot::pipeline
