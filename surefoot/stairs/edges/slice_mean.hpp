// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/stairs/edges/edge_profile.hpp"

namespace surefoot::stairs {

/// Errors of a semi-global matcher hang together over 30-50 px: 0.1 m of floor 1 m away.
inline constexpr double kCorrelation_m = 0.1;

struct SliceMean {
    double height_m = 0.0;
    double sigma_m = 0.0;    ///< of the height: one error in each square of kCorrelation_m
    double scatter_m = 0.0;  ///< of a cell
};
/// Ground over `count` known slices, from `first` on in steps of `way`, each as long as its edge.
[[nodiscard]] SliceMean mean_of(
    const EdgeProfiler::Slices& all, int first, int way, int count, double length_m);

}  // namespace surefoot::stairs
