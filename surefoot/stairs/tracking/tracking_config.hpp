// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/config.hpp"
#include "surefoot/stairs/tracking/robust_mean.hpp"

namespace surefoot::stairs {

/// Settings of FeatureTracker. One observation = one call = one mapped frame.
struct TrackingConfig {
    /// A mean covers at most so many observations. The map already averages: more observations
    /// steady it no further, and the mean lags behind an approaching feature.
    double mean_observations = 4.0;
    /// The going of a flight averages more: it depends on the visible riser faces. Their errors
    /// change between observations, and a going neither drifts nor lags.
    int going_observations = RobustMean::kMostObservations;
    int level_observations =
        5;  ///< in a row that see level ground where a drop was, until it is gone
    int missed_observations = 10;  ///< consecutive misses in view that end a feature (not a drop)
    int first_observations = 3;    ///< consecutive misses that end a feature found only once
    double steps_observations =
        10.0;  ///< the number of steps is the one found most often in so many

    void describe(ConfigVisitor& visitor);
};

}  // namespace surefoot::stairs
