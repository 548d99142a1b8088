// SPDX-License-Identifier: Apache-2.0
#include "sim/imaging.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

constexpr std::size_t kQuantiles = 1U << 14U;

/// Solves Phi(x) = p for p < 1/2. log Phi is concave and grows, so Newton's method on it goes left
/// of the root at most once and then approaches it from there.
double normal_quantile(double p) {
    double x = -0.0;
    for (int i = 0; i < 60; ++i) {
        const double cdf = 0.5 * std::erfc(-x / std::numbers::sqrt2);
        const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
        const double step = (std::log(cdf) - std::log(p)) * cdf / density;
        x -= step;
        if (std::abs(step) < 1e-12) break;
    }
    return x;
}

}  // namespace

void ImagingConfig::describe(ConfigVisitor& visitor) {
    visitor.number(
        "exposure", exposure, 0.01, 10.0, "grey value of a white lit surface, units of 255");
    visitor.number("vignetting", vignetting, 0.0, 0.9, "share of light lost in the image corner");
    visitor.number("read_noise_dn", read_noise_dn, 0.0, 50.0, "noise in the dark, one sigma");
    visitor.number("shot_noise_dn", shot_noise_dn, 0.0, 5.0, "noise variance per grey value");
}

PixelNoise::PixelNoise() : quantiles_(kQuantiles) {
    double sum_squares = 0.0;
    for (std::size_t i = 0; i < kQuantiles / 2; ++i) {
        const double p = (static_cast<double>(i) + 0.5) / static_cast<double>(kQuantiles);
        const double x = normal_quantile(p);
        quantiles_[i] = static_cast<float>(x);
        sum_squares += 2.0 * x * x;
    }
    const double scale = std::sqrt(static_cast<double>(kQuantiles) / sum_squares);
    for (std::size_t i = 0; i < kQuantiles / 2; ++i) {
        quantiles_[i] *= static_cast<float>(scale);
        quantiles_[kQuantiles - 1 - i] = -quantiles_[i];
    }
}

float PixelNoise::normal(std::uint64_t seed, std::uint64_t stream, std::uint32_t pixel) const {
    const std::uint64_t hash = mix_seed(mix_seed(seed, stream), pixel);
    return quantiles_[static_cast<std::size_t>(hash >> 50U)];
}

std::uint8_t exposed_pixel(const ImagingConfig& config, float signal_dn, float normal) {
    const auto read = static_cast<float>(config.read_noise_dn);
    const float variance = read * read + static_cast<float>(config.shot_noise_dn) * signal_dn;
    const float value = signal_dn + std::sqrt(variance) * normal;
    return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
}

}  // namespace surefoot::sim
