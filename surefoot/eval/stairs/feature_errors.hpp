// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "surefoot/stairs/features.hpp"

namespace surefoot::eval {

/// Limits for a match of a found feature with a true feature: rotation and offset of the middle.
/// The offset has a part along the line and a part across it (along the path over the feature).
struct FeatureMatch {
    double across_m = 0.15;
    double along_m = 0.5;
    double turn_deg = 20.0;
};

/// Errors (found minus true) of matched pairs whose two values are both known.
struct MatchErrors {
    std::size_t count = 0;
    double mean_m = 0.0;     ///< NaN without pairs, like the other figures
    double std_m = 0.0;      ///< standard deviation about the mean, divisor n
    double max_abs_m = 0.0;  ///< largest |error|
};

/// Errors of one kind of feature. Pairs are formed nearest first; a feature is in at most one pair.
struct KindErrors {
    std::size_t truth = 0;
    std::size_t found = 0;
    std::size_t matched = 0;
    std::vector<stairs::FeaturePose> missed;  ///< true features without a match
    std::vector<stairs::FeaturePose> extra;   ///< found features without a match
    std::vector<std::size_t> missed_at;       ///< indices of missed features in the input list
    std::vector<std::size_t> extra_at;
    MatchErrors across;  ///< position error along the path over the feature
    MatchErrors height;  ///< error of the height (flight: riser; door: sill)

    [[nodiscard]] double recall() const;     ///< NaN without a true feature
    [[nodiscard]] double precision() const;  ///< NaN without a found feature
};

struct FlightErrors : KindErrors {
    std::size_t steps_right = 0;  ///< pairs with an equal number of steps
    MatchErrors going;
    MatchErrors width;
};

struct DoorErrors : KindErrors {
    MatchErrors width;
};

struct FeatureErrors {
    FlightErrors flights;  ///< an upward flight never matches a downward flight
    KindErrors drops;
    KindErrors kerbs;
    KindErrors sills;
    DoorErrors doors;  ///< errors of doors; the opposite direction of passage also matches
    KindErrors edges;  ///< all edges, matched with the lower ground on the same side
};

/// Compares found features with the truth. Both must be in one frame.
[[nodiscard]] FeatureErrors feature_errors(const stairs::TerrainFeatures& found,
                                           const stairs::TerrainFeatures& truth,
                                           const FeatureMatch& match);

}  // namespace surefoot::eval
