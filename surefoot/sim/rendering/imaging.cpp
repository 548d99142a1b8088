// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/imaging.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

constexpr std::size_t kQuantiles = 1U << 14U;

/// One hash of 64 bits gives numbers to four neighbouring pixels, 14 bits to each.
constexpr std::uint32_t kPixelsPerHash = 4;

std::size_t quantile(std::uint64_t hash, std::uint32_t lane) noexcept {
    return static_cast<std::size_t>(hash >> (8U + 14U * lane)) & (kQuantiles - 1U);
}

/// Solves Phi(x) = p for p < 1/2. log Phi is concave and increasing. So Newton's method on log Phi
/// passes to the left of the root at most once and then approaches the root from the left.
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

/// Returns a value whose integer part is the nearest grey value; max() gives 0 for NaN.
float as_grey(float value_dn) {
    return std::min(std::max(0.0F, value_dn + 0.5F), 255.0F);
}

}  // namespace

void ImagingConfig::describe(ConfigVisitor& visitor) {
    visitor.number("exposure",
                   exposure,
                   0.01,
                   10.0,
                   "grey value of a fully lit white surface, as a share of 255");
    visitor.number("vignetting", vignetting, 0.0, 0.9, "share of light lost in the image corner");
    visitor.number(
        "read_noise_dn", read_noise_dn, 0.0, 50.0, "one sigma of the image noise without light");
    visitor.number(
        "shot_noise_dn", shot_noise_dn, 0.0, 5.0, "variance of the shot noise per grey value");
    visitor.number(
        "noise_size_px",
        noise_size_px,
        0.0,
        10.0,
        "one sigma of the Gaussian that smooths the noise; 0 = independent noise in each pixel");
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

std::uint64_t PixelNoise::key(std::uint64_t seed, std::uint64_t stream) noexcept {
    return mix_seed(seed, stream);
}

float PixelNoise::normal(std::uint64_t key, std::uint32_t pixel) const noexcept {
    return quantiles_[quantile(mix_seed(key, pixel / kPixelsPerHash), pixel % kPixelsPerHash)];
}

void PixelNoise::fill(std::uint64_t key,
                      std::uint32_t first_pixel,
                      std::span<float> out) const noexcept {
    std::uint32_t pixel = first_pixel;
    std::uint64_t hash = mix_seed(key, pixel / kPixelsPerHash);
    for (float& normal : out) {
        if (pixel % kPixelsPerHash == 0) hash = mix_seed(key, pixel / kPixelsPerHash);
        normal = quantiles_[quantile(hash, pixel % kPixelsPerHash)];
        ++pixel;
    }
}

std::uint8_t exposed_pixel(const ImagingConfig& config,
                           double gain,
                           float signal_dn,
                           float normal) {
    const auto read = static_cast<float>(gain * config.read_noise_dn);
    const auto shot = static_cast<float>(gain * config.shot_noise_dn);
    const float value = signal_dn + std::sqrt(read * read + shot * signal_dn) * normal;
    return static_cast<std::uint8_t>(as_grey(value));  // in range: 0 to 255, also for NaN
}

void expose_row(const ImagingConfig& config,
                double gain,
                double light,
                std::span<const float> signal_dn,
                std::span<const float> normals,
                std::span<std::uint8_t> out) {
    const auto factor = static_cast<float>(light);
    const auto read = static_cast<float>(gain * config.read_noise_dn);
    const auto shot = static_cast<float>(gain * config.shot_noise_dn);
    for (std::size_t i = 0; i < out.size(); ++i) {
        const float signal = factor * signal_dn[i];
        const float value = signal + std::sqrt(read * read + shot * signal) * normals[i];
        out[i] = static_cast<std::uint8_t>(static_cast<int>(as_grey(value)));  // in range: NaN too
    }
}

void vignette_row(const ImagingConfig& config, int row, int height, std::span<float> signal_dn) {
    const float half_width = 0.5F * static_cast<float>(signal_dn.size());
    const float half_height = 0.5F * static_cast<float>(height);
    const float loss = static_cast<float>(config.vignetting) /
                       (half_width * half_width + half_height * half_height);
    const float y = static_cast<float>(row) + 0.5F - half_height;
    for (std::size_t u = 0; u < signal_dn.size(); ++u) {
        const float x = static_cast<float>(u) + 0.5F - half_width;
        signal_dn[u] *= 1.0F - loss * (x * x + y * y);
    }
}

}  // namespace surefoot::sim
