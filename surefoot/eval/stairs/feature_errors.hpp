// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "surefoot/stairs/features.hpp"

namespace surefoot::eval {

/// When something that was found is what the truth has: turned by at most so much, its middle off
/// by at most so much across the line (along the way that leads over it) and along it.
struct FeatureMatch {
    double across_m = 0.15;
    double along_m = 0.5;
    double turn_deg = 20.0;
};

/// Found minus true, of matched pairs whose both values are known.
struct MatchErrors {
    std::size_t count = 0;
    double mean_m = 0.0;     ///< NaN without pairs, as the others
    double std_m = 0.0;      ///< about the mean, divided by n
    double max_abs_m = 0.0;  ///< the largest
};

/// One kind of feature. Pairs are made nearest first, each feature in one pair at most.
struct KindErrors {
    std::size_t truth = 0;
    std::size_t found = 0;
    std::size_t matched = 0;
    std::vector<stairs::FeaturePose> missed;  ///< of the truth
    std::vector<stairs::FeaturePose> extra;   ///< found where the truth has none
    std::vector<std::size_t> missed_at;       ///< where in their lists they stand
    std::vector<std::size_t> extra_at;
    MatchErrors across;  ///< of its place, along the way over it
    MatchErrors height;  ///< riser of flights; sill of doors

    [[nodiscard]] double recall() const;     ///< NaN without a truth
    [[nodiscard]] double precision() const;  ///< NaN without one found
};

struct FlightErrors : KindErrors {
    std::size_t steps_right = 0;  ///< pairs of equal number of steps
    MatchErrors going;
    MatchErrors width;
};

struct DoorErrors : KindErrors {
    MatchErrors width;
};

struct FeatureErrors {
    FlightErrors flights;  ///< up and down are never one
    KindErrors drops;
    KindErrors kerbs;
    KindErrors sills;
    DoorErrors doors;  ///< also where one leads through the other way
    KindErrors edges;  ///< all of them, the lower ground on the same side
};

/// What was found against what is there, both in one frame.
[[nodiscard]] FeatureErrors feature_errors(const stairs::TerrainFeatures& found,
                                           const stairs::TerrainFeatures& truth,
                                           const FeatureMatch& match);

}  // namespace surefoot::eval
