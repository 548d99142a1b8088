// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/edges/slice_mean.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::stairs {

SliceMean mean_of(const EdgeProfiler::Slices& all, int first, int way, int count, double length_m) {
    double sum_m = 0.0;
    double weight = 0.0;
    double var_m2 = 0.0;
    for (int i = 0; i < count; ++i) {
        const EdgeProfiler::Slice& slice = all.at(first + i * way);
        const double scatter_m = std::max(slice.scatter_m, slice.sigma_m);
        sum_m += slice.known_share * slice.height_m;
        weight += slice.known_share;
        var_m2 += slice.known_share * scatter_m * scatter_m;
    }
    const double area_m2 = weight * all.cell_m * length_m;
    const double independent = std::max(1.0, area_m2 / (kCorrelation_m * kCorrelation_m));
    return {sum_m / weight, std::sqrt(var_m2 / weight / independent), std::sqrt(var_m2 / weight)};
}

}  // namespace surefoot::stairs
