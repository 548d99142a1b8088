// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/core/config.hpp"
#include "surefoot/stairs/tracking/robust_mean.hpp"

namespace surefoot::stairs {

/// How features are followed from look to look (FeatureTracker). Looks: calls, one a mapped frame.
struct TrackingConfig {
    /// A mean is one of at most so many looks. The map has averaged already: more make places no
    /// steadier, and lag behind what comes nearer.
    double mean_observations = 4.0;
    /// A flight's going is one of more: it hangs on where each look sees the faces, whose errors
    /// change from look to look, and neither drifts nor lags.
    int going_observations = RobustMean::kMostObservations;
    int level_observations =
        5;  ///< in a row that see level ground where a drop was, until it is gone
    int missed_observations = 10;  ///< in a row that do not find what they see, drops excepted
    int first_observations = 3;    ///< the same for what was found once only
    double steps_observations =
        10.0;  ///< the number of steps is the one found most often in so many

    void describe(ConfigVisitor& visitor);
};

}  // namespace surefoot::stairs
