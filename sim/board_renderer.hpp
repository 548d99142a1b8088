// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/camera/camera_model.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::sim {

/// What is printed on a flat sheet: black shapes on white paper, all in the plane z = 0 of the
/// sheet's own frame, x to the right and y down as the camera sees it, z away from the viewer.
struct PrintedSheet {
    struct Rectangle {
        double left_m = 0.0;
        double top_m = 0.0;
        double right_m = 0.0;
        double bottom_m = 0.0;
    };
    struct Disc {
        double x_m = 0.0;
        double y_m = 0.0;
        double radius_m = 0.0;
    };
    Rectangle paper;
    std::vector<Rectangle> rectangles;
    std::vector<Disc> discs;
};

/// Light, lens and sensor of a board's picture. Grey values are linear in light, 0..255.
struct BoardLook {
    double paper_dn = 210.0;
    double ink_dn = 30.0;
    double background_dn = 100.0;
    double blur_sigma_px = 0.0;  ///< Gaussian spot of the lens; 0 = ideal
    double noise_dn = 0.0;       ///< one sigma, every pixel for itself
};

/// Image of a sheet in front of a camera. Analytic: no mesh, no texture. Every pixel is the mean
/// over its square area; edges are sampled `kEdgeSamples` times in each direction, so that an edge
/// lies right to about 1 / (2 kEdgeSamples) px in one pixel and far better over several.
/// Same seed, same bytes, for every executor.
inline constexpr int kEdgeSamples = 16;
[[nodiscard]] GreyImage render_board(const PrintedSheet& sheet,
                                     const camera::Camera& camera,
                                     const Pose& T_camera_sheet,
                                     const BoardLook& look,
                                     std::uint64_t seed,
                                     Executor& executor);

}  // namespace surefoot::sim
