// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/tracking_config.hpp"

namespace surefoot::stairs {

void TrackingConfig::describe(ConfigVisitor& visitor) {
    visitor.number("mean_observations",
                   mean_observations,
                   1.0,
                   100.0,
                   "largest number of observations in the mean position and size of a feature");
    visitor.integer("going_observations",
                    going_observations,
                    1,
                    RobustMean::kMostObservations,
                    "largest number of observations in the mean going of a flight");
    visitor.integer(
        "level_observations",
        level_observations,
        1,
        1000,
        "number of consecutive observations of level ground at a drop after which the drop ends");
    visitor.integer("missed_observations",
                    missed_observations,
                    1,
                    1000,
                    "number of consecutive observations without a feature, with its location in "
                    "view, after which the feature ends; drops do not end this way");
    visitor.integer("first_observations",
                    first_observations,
                    1,
                    1000,
                    "number of consecutive observations without a feature, with its location in "
                    "view, after which it ends if it was found only once");
    visitor.number(
        "steps_observations",
        steps_observations,
        1.0,
        1000.0,
        "approximate number of recent observations that vote on the number of steps of a flight");
}

}  // namespace surefoot::stairs
