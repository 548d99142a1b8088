// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/optics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::sim {
namespace {

/// Largest sigma that a configuration may set.
constexpr double kMaxSigma_px = 30.0;

std::vector<double> sampled_gaussian(double width_px, int radius) {
    std::vector<double> weights;
    double sum = 0.0;
    for (int i = -radius; i <= radius; ++i) {
        const double z = i / width_px;
        weights.push_back(std::exp(-0.5 * z * z));
        sum += weights.back();
    }
    for (double& weight : weights) weight /= sum;
    return weights;
}

double second_moment(const std::vector<double>& weights) {
    const int radius = static_cast<int>(weights.size() / 2);
    double moment = 0.0;
    for (int i = -radius; i <= radius; ++i) {
        moment += weights[static_cast<std::size_t>(i + radius)] * i * i;
    }
    return moment;
}

/// Number of outputs that are summed side by side. It is fixed so that compilers use wide
/// registers.
constexpr int kLanes = 8;

/// out[u] = sum over k of kernel[k] * rows[k][u], for a whole number of lanes.
void weigh(const std::vector<float>& kernel,
           const std::vector<const float*>& rows,
           int width,
           float* out) {
    for (int u = 0; u < width; u += kLanes) {
        std::array<float, kLanes> sum{};
        for (std::size_t k = 0; k < kernel.size(); ++k) {
            const float weight = kernel[k];
            const float* in = rows[k] + u;
            for (std::size_t lane = 0; lane < kLanes; ++lane) sum[lane] += weight * in[lane];
        }
        std::copy(sum.begin(), sum.end(), out + u);
    }
}

int whole_lanes(int width) {
    return (width + kLanes - 1) / kLanes * kLanes;
}

/// Returns 1 inside two thirds of the radius, 0 beyond the radius, and a smooth transition between.
float smudge_share(double distance, double radius) {
    const double t = std::clamp(3.0 * (1.0 - distance / radius), 0.0, 1.0);
    return static_cast<float>(t * t * (3.0 - 2.0 * t));
}

}  // namespace

void OpticsConfig::describe(ConfigVisitor& visitor) {
    visitor.number("smear_sigma_px",
                   smear_sigma_px,
                   0.0,
                   kMaxSigma_px,
                   "one sigma of the lens blur; 0 = ideal lens");
    visitor.number("smudge_sigma_px",
                   smudge_sigma_px,
                   0.0,
                   kMaxSigma_px,
                   "one sigma of the blur under a finger mark; 0 = clean lens");
    visitor.number("smudge_x",
                   smudge_x,
                   0.0,
                   1.0,
                   "x of the centre of the finger mark, as a share of the image width");
    visitor.number("smudge_y",
                   smudge_y,
                   0.0,
                   1.0,
                   "y of the centre of the finger mark, as a share of the image height");
    visitor.number("smudge_radius",
                   smudge_radius,
                   0.01,
                   2.0,
                   "radius of the finger mark, as a share of the image height");
    visitor.enumeration(
        "smudge_camera", smudge_camera, kCameraSideNames, "camera whose lens has the finger mark");
}

std::vector<float> smear_kernel(double sigma_px) {
    if (!(sigma_px > 0.0)) return {1.0F};
    const int radius = saturated_integer<int>(std::ceil(4.0 * sigma_px) + 1.0);
    // Sampling narrows a small spot. So bisect for the width whose samples have the requested
    // second moment.
    double low_px = 0.05;
    double high_px = 2.0 * sigma_px + 1.0;
    for (int i = 0; i < 60; ++i) {
        const double middle_px = 0.5 * (low_px + high_px);
        const bool narrow =
            second_moment(sampled_gaussian(middle_px, radius)) < sigma_px * sigma_px;
        (narrow ? low_px : high_px) = middle_px;
    }
    const std::vector<double> weights = sampled_gaussian(low_px, radius);
    return {weights.begin(), weights.end()};
}

void smear(const std::vector<float>& kernel, Executor& executor, Image<float>& image) {
    const int radius = static_cast<int>(kernel.size() / 2);
    const int height = image.height();
    const int last = image.width() - 1;
    const int width = whole_lanes(image.width());
    Image<float> across(width, height);
    executor.parallel_for(height, [&](int v) {
        std::vector<float> padded(static_cast<std::size_t>(width + 2 * radius));
        for (int u = -radius; u < width + radius; ++u) {
            padded[static_cast<std::size_t>(u + radius)] = image.row(v)[std::clamp(u, 0, last)];
        }
        std::vector<const float*> shifted;
        for (std::size_t k = 0; k < kernel.size(); ++k) shifted.push_back(padded.data() + k);
        weigh(kernel, shifted, width, across.row(v));
    });
    executor.parallel_for(height, [&](int v) {
        std::vector<float> sums(static_cast<std::size_t>(width));
        std::vector<const float*> rows;
        for (int k = -radius; k <= radius; ++k) {
            rows.push_back(across.row(std::clamp(v + k, 0, height - 1)));
        }
        weigh(kernel, rows, width, sums.data());
        std::copy_n(sums.begin(), image.width(), image.row(v));
    });
}

void apply_optics(const OpticsConfig& config,
                  bool is_left,
                  Executor& executor,
                  Image<float>& image) {
    if (config.smear_sigma_px > 0.0) smear(smear_kernel(config.smear_sigma_px), executor, image);
    const bool has_mark = config.smudge_camera == EyePoint::both ||
                          (config.smudge_camera == EyePoint::left) == is_left;
    if (!(config.smudge_sigma_px > 0.0) || !has_mark) return;
    Image<float> greasy = image;
    smear(smear_kernel(config.smudge_sigma_px), executor, greasy);
    const double radius_px = config.smudge_radius * image.height();
    executor.parallel_for(image.height(), [&](int v) {
        const double dy = v + 0.5 - config.smudge_y * image.height();
        for (int u = 0; u < image.width(); ++u) {
            const double dx = u + 0.5 - config.smudge_x * image.width();
            const float share = smudge_share(std::hypot(dx, dy), radius_px);
            image.row(v)[u] += share * (greasy.row(v)[u] - image.row(v)[u]);
        }
    });
}

}  // namespace surefoot::sim
