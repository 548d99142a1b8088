// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/robust_mean.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::stairs {
namespace {

constexpr double kSame_sigma = 3.0;

}  // namespace

void RobustMean::add(double value, double sigma, int most_observations) {
    most_observations = std::clamp(most_observations, 1, kMostObservations);
    if (const int surplus = count_ + 1 - most_observations; surplus > 0) {
        std::copy(
            observations_.begin() + surplus, observations_.begin() + count_, observations_.begin());
        count_ -= surplus;
    }
    observations_[static_cast<std::size_t>(count_++)] = {value, sigma};
}

double RobustMean::median() const {
    std::array<Observation, kMostObservations> sorted = observations_;
    auto* const end = sorted.begin() + count_;
    std::sort(sorted.begin(), end, [](const Observation& a, const Observation& b) {
        return a.value < b.value;
    });
    double weight = 0.0;
    for (auto* observation = sorted.begin(); observation != end; ++observation)
        weight += 1.0 / observation->sigma;
    double so_far = 0.0;
    for (auto* observation = sorted.begin(); observation != end; ++observation) {
        so_far += 1.0 / observation->sigma;
        if (so_far >= 0.5 * weight) return observation->value;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

RobustMean::Mean RobustMean::mean(double shared) const {
    const double middle = median();
    double w = 0.0, wx = 0.0, wxx = 0.0;
    int used = 0;
    for (int i = 0; i < count_; ++i) {
        const Observation& observation = observations_[static_cast<std::size_t>(i)];
        const double off = observation.value - middle;
        if (std::abs(off) > kSame_sigma * std::hypot(observation.sigma, shared)) continue;
        const double weight = 1.0 / (observation.sigma * observation.sigma);
        w += weight;
        wx += weight * off;
        wxx += weight * off * off;
        ++used;
    }
    const double mean = wx / w;
    const double chi2 = used > 1 ? (wxx - w * mean * mean) / (used - 1) : 1.0;
    return {middle + mean, std::hypot(std::sqrt(std::max(1.0, chi2) / w), shared)};
}

}  // namespace surefoot::stairs
