// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/tracking/tracking_config.hpp"

namespace surefoot::stairs {

void TrackingConfig::describe(ConfigVisitor& visitor) {
    visitor.number(
        "mean_observations", mean_observations, 1.0, 100.0, "looks that places are a mean of, at most");
    visitor.integer("going_observations",
                    going_observations,
                    1,
                    RobustMean::kMostObservations,
                    "looks that the going of a flight is a mean of, at most");
    visitor.integer("level_observations",
                    level_observations,
                    1,
                    1000,
                    "looks in a row that see level ground where a drop was, until it is gone");
    visitor.integer("missed_observations",
                    missed_observations,
                    1,
                    1000,
                    "looks in a row that see the place of a thing that is no drop, and not the "
                    "thing, until it is gone");
    visitor.integer(
        "first_observations", first_observations, 1, 1000, "the same for what was found in one look only");
    visitor.number("steps_observations",
                   steps_observations,
                   1.0,
                   1000.0,
                   "a flight has the number of steps found most often in about so many looks");
}

}  // namespace surefoot::stairs
