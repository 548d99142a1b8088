// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/config.hpp"
#include "surefoot/stairs/tracking/robust_mean.hpp"

namespace surefoot::stairs {

/// Settings of FeatureTracker. Each call with one mapped frame is one observation.
struct TrackingConfig {
    /// A mean covers at most this many observations. More would not steady the mean (the map
    /// already averages), and the mean would lag behind an approaching feature.
    double mean_observations = 4.0;
    /// The going of a flight averages more: it depends on the visible riser faces. Their errors
    /// change between observations, and a going neither drifts nor lags.
    int going_observations = RobustMean::kMostObservations;
    int level_observations =
        5;  ///< consecutive observations of level ground after which a drop ends
    int missed_observations = 10;  ///< consecutive misses in view that end a feature (not a drop)
    int first_observations = 3;    ///< consecutive misses that end a feature found only once
    double steps_observations =
        10.0;  ///< number of observations that vote on the steps of a flight

    void describe(ConfigVisitor& visitor);
};

}  // namespace surefoot::stairs
