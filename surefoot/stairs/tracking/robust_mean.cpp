// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/robust_mean.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace surefoot::stairs {
namespace {

constexpr double kSame_sigma = 3.0;

}  // namespace

void RobustMean::add(double value, double sigma, int most_looks) {
    most_looks = std::clamp(most_looks, 1, kMostLooks);
    if (const int surplus = count_ + 1 - most_looks; surplus > 0) {
        std::copy(looks_.begin() + surplus, looks_.begin() + count_, looks_.begin());
        count_ -= surplus;
    }
    looks_[static_cast<std::size_t>(count_++)] = {value, sigma};
}

double RobustMean::median() const {
    std::array<Look, kMostLooks> sorted = looks_;
    auto* const end = sorted.begin() + count_;
    std::sort(sorted.begin(), end, [](const Look& a, const Look& b) { return a.value < b.value; });
    double weight = 0.0;
    for (auto* look = sorted.begin(); look != end; ++look) weight += 1.0 / look->sigma;
    double so_far = 0.0;
    for (auto* look = sorted.begin(); look != end; ++look) {
        so_far += 1.0 / look->sigma;
        if (so_far >= 0.5 * weight) return look->value;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

RobustMean::Mean RobustMean::mean(double shared) const {
    const double middle = median();
    double w = 0.0, wx = 0.0, wxx = 0.0;
    int used = 0;
    for (int i = 0; i < count_; ++i) {
        const Look& look = looks_[static_cast<std::size_t>(i)];
        const double off = look.value - middle;
        if (std::abs(off) > kSame_sigma * std::hypot(look.sigma, shared)) continue;
        const double weight = 1.0 / (look.sigma * look.sigma);
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
