// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/core/config.hpp"

namespace surefoot::sim {

/// What happens between light and grey value. Grey values ("dn") are linear in light, 0..255.
struct ImagingConfig {
    double exposure = 1.4;       ///< grey value of a white surface facing the lamp, in units of 255
    double vignetting = 0.25;    ///< light lost in the image corner, share
    double read_noise_dn = 1.0;  ///< one sigma that does not depend on the light
    double shot_noise_dn = 0.02;  ///< variance per grey value (inverse gain): sigma 1.6 at 128

    void describe(ConfigVisitor& visitor);
};

/// Gaussian numbers addressed by (seed, stream, pixel): the same for any order of evaluation.
/// `stream` numbers the image. Quantile table of the normal distribution with 2^14 entries, so
/// beyond 4.0 sigma nothing occurs; unit variance.
class PixelNoise {
  public:
    PixelNoise();
    [[nodiscard]] float normal(std::uint64_t seed, std::uint64_t stream, std::uint32_t pixel) const;

  private:
    std::vector<float> quantiles_;
};

/// Grey value of a noiseless signal: noise with variance read^2 + shot * signal, rounded, clamped.
[[nodiscard]] std::uint8_t exposed_pixel(const ImagingConfig& config,
                                         float signal_dn,
                                         float normal);

}  // namespace surefoot::sim
