// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/observation_weight.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::stairs {
namespace {

constexpr double kLeastVar = 1e-10;  ///< (0.01 mm)^2: more exact observations get equal weights
/// An observation this many sigma off does not confirm the mean. One of the two is wrong, and the
/// newer observation is based on all earlier data.
constexpr double kJump_sigma = 3.0;
constexpr double kJumpShare = 0.5;

}  // namespace

double ObservationWeight::take(double var, double difference, double most_observations) {
    var = std::max(var, kLeastVar);
    if (empty_) {
        empty_ = false;
        mean_var_ = best_var_ = var;
        return 1.0;
    }
    double share = mean_var_ / (mean_var_ + var);
    const double square = difference * difference;
    if (square > kJump_sigma * kJump_sigma * (sigma() * sigma() + var))
        share = std::max(share, kJumpShare);
    best_var_ = std::min(best_var_, var);
    scatter_var_ += (square - scatter_var_) / most_observations;
    mean_var_ *= 1.0 - share;
    // With this limit, observations as good as the best observation weigh 1 / most_observations.
    if (most_observations > 1.0)
        mean_var_ = std::max(mean_var_, best_var_ / (most_observations - 1.0));
    return most_observations > 1.0 ? share : 1.0;
}

void ObservationWeight::drift(double var) {
    mean_var_ += var;
    best_var_ += var;
}

double ObservationWeight::sigma() const {
    return std::sqrt(std::max(best_var_, scatter_var_));
}

void ObservationWeight::join(const ObservationWeight& other) {
    if (!other.empty_ && (empty_ || other.sigma() < sigma())) *this = other;
}

}  // namespace surefoot::stairs
