// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/camera/camera_model.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/printed_sheet.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::sim {

/// Lighting, lens and sensor for the image of a board. Grey values are linear in light, 0..255.
struct ImagingConditions {
    double paper_dn = 210.0;
    double ink_dn = 30.0;
    double background_dn = 100.0;
    double blur_sigma_px = 0.0;  ///< sigma of the Gaussian spot of the lens; 0 = ideal lens
    double noise_dn = 0.0;       ///< one sigma of the noise, independent in every pixel
};

/// Renders the image of a sheet in front of a camera analytically, without mesh or texture. Every
/// pixel is the mean over its square area. Edges are sampled `kEdgeSamples` times in each
/// direction. So an edge is right to about 1 / (2 kEdgeSamples) px in one pixel and far better over
/// several. Deterministic: the same seed gives the same bytes for every executor.
inline constexpr int kEdgeSamples = 16;
[[nodiscard]] GreyImage render_board(const PrintedSheet& sheet,
                                     const camera::Camera& camera,
                                     const Pose& T_camera_sheet,
                                     const ImagingConditions& look,
                                     std::uint64_t seed,
                                     Executor& executor);

}  // namespace surefoot::sim
