// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/core/config.hpp"

namespace surefoot::sim {

/// What happens between light and grey value. Grey values ("dn") are linear in light, 0..255.
struct ImagingConfig {
    double exposure = 1.4;       ///< grey value of a white surface facing the lamp, in units of 255
    double vignetting = 0.25;    ///< light lost in the image corner, share
    double read_noise_dn = 1.0;  ///< one sigma that does not depend on the light
    double shot_noise_dn = 0.02;  ///< variance per grey value (inverse gain): sigma 1.6 at 128
    double noise_size_px = 0.0;   ///< neighbours share the noise: one sigma of the Gaussian that it
                                  ///< is smoothed with, as denoising and compression leave it

    void describe(ConfigVisitor& visitor);
};

/// Gaussian numbers addressed by (image, pixel): the same for any order of evaluation. Quantile
/// table of the normal distribution with 2^14 entries, so beyond 4.0 sigma nothing occurs; unit
/// variance.
class PixelNoise {
  public:
    PixelNoise();
    /// Chooses the numbers of one image.
    [[nodiscard]] static std::uint64_t key(std::uint64_t seed, std::uint64_t stream) noexcept;
    [[nodiscard]] float normal(std::uint64_t key, std::uint32_t pixel) const noexcept;
    /// Numbers of consecutive pixels.
    void fill(std::uint64_t key, std::uint32_t first_pixel, std::span<float> out) const noexcept;

  private:
    std::vector<float> quantiles_;
};

/// Grey value of a noiseless signal: noise with variance (gain read)^2 + gain shot signal, rounded,
/// clamped.
[[nodiscard]] std::uint8_t exposed_pixel(const ImagingConfig& config,
                                         double gain,
                                         float signal_dn,
                                         float normal);
/// The same for a row of signals, each multiplied by `light` first.
void expose_row(const ImagingConfig& config,
                double gain,
                double light,
                std::span<const float> signal_dn,
                std::span<const float> normals,
                std::span<std::uint8_t> out);

/// Darkens a row by the vignetting: a share of the light that grows with the square of the distance
/// from the middle of the image.
void vignette_row(const ImagingConfig& config, int row, int height, std::span<float> signal_dn);

}  // namespace surefoot::sim
