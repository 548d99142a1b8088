// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/stairs/edges/edge_profile.hpp"

namespace surefoot::stairs {

/// Correlation length of semi-global matching errors: 30-50 px, which is 0.1 m of floor at 1 m.
inline constexpr double kCorrelation_m = 0.1;

struct SliceMean {
    double height_m = 0.0;
    double sigma_m = 0.0;    ///< height sigma: one independent error per square of kCorrelation_m
    double scatter_m = 0.0;  ///< standard deviation of one cell
};
/// Mean over `count` known slices, from `first` on in direction `way`; a slice is `length_m` long.
[[nodiscard]] SliceMean mean_of(
    const EdgeProfiler::Slices& all, int first, int way, int count, double length_m);

}  // namespace surefoot::stairs
