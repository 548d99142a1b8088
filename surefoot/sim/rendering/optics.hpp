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

/// What the lens does to the picture: less light in the corners, a point that becomes a Gaussian
/// spot, and a greasy finger mark that makes it a larger one.
struct OpticsConfig {
    double smear_sigma_px = 0.0;   ///< of the spot, each direction; 0 = ideal lens
    double smudge_sigma_px = 0.0;  ///< under the finger mark; 0 = clean
    double smudge_x = 0.5;         ///< middle of the mark, share of the image's width
    double smudge_y = 0.6;         ///< share of its height
    double smudge_radius = 0.25;   ///< share of its height; fades out over the outer third
    EyePoint smudge_camera = EyePoint::left;

    void describe(ConfigVisitor& visitor);
};

/// Weights of a spot, odd number, sum 1, second moment sigma^2 exactly although sampled at pixels.
[[nodiscard]] std::vector<float> smear_kernel(double sigma_px);

/// Convolves an image with the spot in both directions; the border continues outward.
void smear(const std::vector<float>& kernel, Executor& executor, Image<float>& image);

/// Smears the whole image, then the part under the mark, as one eye of the rig sees it.
void apply_optics(const OpticsConfig& config,
                  bool is_left,
                  Executor& executor,
                  Image<float>& image);

}  // namespace surefoot::sim
