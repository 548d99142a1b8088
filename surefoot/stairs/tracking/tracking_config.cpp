// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/tracking_config.hpp"

namespace surefoot::stairs {

void TrackingConfig::describe(ConfigVisitor& visitor) {
    visitor.number("mean_observations",
                   mean_observations,
                   1.0,
                   100.0,
                   "a position is the mean of at most so many observations");
    visitor.integer("going_observations",
                    going_observations,
                    1,
                    RobustMean::kMostObservations,
                    "a going is the mean of at most so many observations");
    visitor.integer("level_observations",
                    level_observations,
                    1,
                    1000,
                    "consecutive observations of level ground that end a drop");
    visitor.integer("missed_observations",
                    missed_observations,
                    1,
                    1000,
                    "consecutive observations that see the place of a feature but not the feature, "
                    "until it ends (drops excepted)");
    visitor.integer("first_observations",
                    first_observations,
                    1,
                    1000,
                    "the same for a feature that was found only once");
    visitor.number("steps_observations",
                   steps_observations,
                   1.0,
                   1000.0,
                   "the number of steps is the one found most often in about so many observations");
}

}  // namespace surefoot::stairs
