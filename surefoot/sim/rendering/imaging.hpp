// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/core/config.hpp"

namespace surefoot::sim {

/// The sensor model from light to grey value. Grey values ("dn") are linear in light, 0..255.
struct ImagingConfig {
    double exposure = 1.4;        ///< grey value of a fully lit white surface, as a share of 255
    double vignetting = 0.25;     ///< share of light lost in the image corner
    double read_noise_dn = 1.0;   ///< one sigma of the noise that does not depend on the light
    double shot_noise_dn = 0.02;  ///< variance of the shot noise per grey value: sigma 1.6 at 128
    double noise_size_px = 0.0;   ///< one sigma of the Gaussian that smooths the noise, as
                                  ///< denoising and compression do; 0 = independent pixels

    void describe(ConfigVisitor& visitor);
};

/// Gaussian numbers, a function of (image, pixel) alone, so that the order of evaluation does not
/// matter. Unit variance. The quantile table of the normal distribution has 2^14 entries, so no
/// value exceeds 4.1 sigma.
class PixelNoise {
  public:
    PixelNoise();
    /// Selects the numbers of one image.
    [[nodiscard]] static std::uint64_t key(std::uint64_t seed, std::uint64_t stream) noexcept;
    [[nodiscard]] float normal(std::uint64_t key, std::uint32_t pixel) const noexcept;
    /// Writes the numbers of consecutive pixels.
    void fill(std::uint64_t key, std::uint32_t first_pixel, std::span<float> out) const noexcept;

  private:
    std::vector<float> quantiles_;
};

/// Returns the grey value of a noiseless signal: adds noise of variance (gain read)^2 + gain shot
/// signal, then rounds and clamps.
[[nodiscard]] std::uint8_t exposed_pixel(const ImagingConfig& config,
                                         double gain,
                                         float signal_dn,
                                         float normal);
/// Computes exposed_pixel for a row of signals; each signal is multiplied by `light` first.
void expose_row(const ImagingConfig& config,
                double gain,
                double light,
                std::span<const float> signal_dn,
                std::span<const float> normals,
                std::span<std::uint8_t> out);

/// Darkens a row by vignetting: the lost share of light grows with the square of the distance from
/// the image centre.
void vignette_row(const ImagingConfig& config, int row, int height, std::span<float> signal_dn);

}  // namespace surefoot::sim
