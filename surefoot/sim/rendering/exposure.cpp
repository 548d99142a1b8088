// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/exposure.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

constexpr double kWarmUpMin_s = 10.0;
constexpr double kWarmUpMax_s = 30.0;

}  // namespace

void ExposureConfig::describe(ConfigVisitor& visitor) {
    visitor.number(
        "exposure_s",
        exposure_s,
        1e-5,
        0.1,
        "exposure time of every frame; with automatic = true only the reference time for "
        "imaging.exposure");
    visitor.boolean("automatic",
                    automatic,
                    "true: the exposure control keeps the mean grey value at target_dn");
    visitor.number("target_dn",
                   target_dn,
                   10.0,
                   240.0,
                   "mean grey value of the left image that the exposure control keeps");
    visitor.number("min_exposure_s",
                   min_exposure_s,
                   1e-6,
                   0.1,
                   "shortest exposure time of the exposure control");
    visitor.number(
        "max_exposure_s",
        max_exposure_s,
        1e-5,
        0.1,
        "longest exposure time of the exposure control; if it is not enough, the gain rises");
    visitor.number("max_gain", max_gain, 1.0, 64.0, "largest gain of the exposure control");
    visitor.number("lag_s",
                   lag_s,
                   0.0,
                   10.0,
                   "time constant of the exposure control; 0 = the control reacts at once");
    visitor.boolean("sun_warm_up",
                    sun_warm_up,
                    "true: the images are over-exposed in the first 10-30 s, as in the sun");
    visitor.number("warm_up_factor",
                   warm_up_factor,
                   1.0,
                   100.0,
                   "factor by which the first frame is too bright; used if sun_warm_up is true");
    visitor.number(
        "right_gain", right_gain, 0.5, 2.0, "gain of the right camera relative to the left camera");
}

double metered_mean_dn(const Image<float>& signal_dn, double factor) {
    constexpr int kStride = 4;
    double sum_dn = 0.0;
    int count = 0;
    for (int v = kStride / 2; v < signal_dn.height(); v += kStride) {
        for (int u = kStride / 2; u < signal_dn.width(); u += kStride, ++count) {
            sum_dn += std::min(factor * static_cast<double>(signal_dn.row(v)[u]), 255.0);
        }
    }
    return count > 0 ? sum_dn / count : 0.0;
}

ExposureControl::ExposureControl(const ExposureConfig& config, std::uint64_t seed)
    : config_(config) {
    if (config.sun_warm_up) warm_up_s_ = Rng(seed).uniform(kWarmUpMin_s, kWarmUpMax_s);
}

double ExposureControl::least() const {
    return config_.min_exposure_s / config_.exposure_s;
}

double ExposureControl::most() const {
    return config_.max_exposure_s / config_.exposure_s * config_.max_gain;
}

Shot ExposureControl::shot(double since_start_s) const {
    Shot shot;
    shot.exposure_s = config_.exposure_s;
    if (config_.automatic) {
        const double wanted_s = product_ * config_.exposure_s;
        shot.exposure_s = std::min(wanted_s, config_.max_exposure_s);
        shot.gain = std::max(wanted_s / config_.max_exposure_s, 1.0);
    }
    shot.light = shot.gain * shot.exposure_s / config_.exposure_s;
    if (since_start_s < warm_up_s_) {
        shot.light *= std::pow(config_.warm_up_factor, 1.0 - since_start_s / warm_up_s_);
    }
    return shot;
}

void ExposureControl::settle(const Image<float>& signal_dn) {
    if (!config_.automatic) return;
    // The mean grows with the product of exposure time and gain, so bisect the logarithm of the
    // product.
    double low = least();
    double high = most();
    for (int i = 0; i < 40; ++i) {
        const double middle = std::sqrt(low * high);
        (metered_mean_dn(signal_dn, middle) < config_.target_dn ? low : high) = middle;
    }
    product_ = std::sqrt(low * high);
}

void ExposureControl::update(const Image<float>& signal_dn, double step_s) {
    if (!config_.automatic) return;
    // A mean below 0.1 counts as 0.1, because a black image has no usable mean. The control then
    // opens towards its limit.
    const double mean_dn = std::max(metered_mean_dn(signal_dn, product_), 0.1);
    const double share = config_.lag_s > 0.0 ? 1.0 - std::exp(-step_s / config_.lag_s) : 1.0;
    product_ *= std::pow(config_.target_dn / mean_dn, share);
    product_ = std::clamp(product_, least(), std::max(least(), most()));
}

}  // namespace surefoot::sim
