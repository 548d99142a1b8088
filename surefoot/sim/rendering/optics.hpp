// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::sim {

enum class EyePoint : std::uint8_t { left, right, both };
inline constexpr const char* kCameraSideNames[] = {"left", "right", "both"};

/// Effects of the lens: a Gaussian point spread, and a greasy finger mark with a larger point
/// spread. ImagingConfig sets the vignetting.
struct OpticsConfig {
    double smear_sigma_px = 0.0;   ///< sigma of the spot, in each direction; 0 = ideal lens
    double smudge_sigma_px = 0.0;  ///< sigma of the spot under the finger mark; 0 = clean lens
    double smudge_x = 0.5;         ///< x of the centre of the mark, as a share of the image width
    double smudge_y = 0.6;         ///< y of the centre of the mark, as a share of the image height
    double smudge_radius = 0.25;   ///< radius as a share of the image height; the outer third fades
    EyePoint smudge_camera = EyePoint::left;

    void describe(ConfigVisitor& visitor);
};

/// Weights of a sampled Gaussian spot: an odd number of weights, sum 1, second moment sigma^2.
[[nodiscard]] std::vector<float> smear_kernel(double sigma_px);

/// Convolves an image with the spot in both directions; border pixels are replicated outward.
void smear(const std::vector<float>& kernel, Executor& executor, Image<float>& image);

/// Smears the whole image, then the part under the mark, for one camera of the rig.
void apply_optics(const OpticsConfig& config,
                  bool is_left,
                  Executor& executor,
                  Image<float>& image);

}  // namespace surefoot::sim
