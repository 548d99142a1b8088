// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/eval/report/error_histogram.hpp"

namespace surefoot::eval {

/// Statistics of signed errors, in the unit of the errors. All fields but count are NaN without
/// errors. Percentiles interpolate linearly between the two nearest ranks.
struct ErrorFigures {
    double median_abs = 0.0;
    double p90_abs = 0.0;
    double p99_abs = 0.0;
    double max_abs = 0.0;
    double mean = 0.0;
    double rmse = 0.0;
    std::int64_t count = 0;
};

/// Computes the statistics; leaves out NaN errors.
[[nodiscard]] ErrorFigures error_figures(std::span<const float> errors);

/// Errors whose key is in [from, to); the last bin includes its upper end.
struct ErrorBin {
    double from = 0.0;
    double to = 0.0;
    ErrorFigures errors;
    ErrorHistogram histogram;  ///< histogram of these errors, for sums over many maps
};

/// Sorts errors into bins by a second quantity, for example distance or image column. `keys` has
/// one key per error. `edges` increases strictly and gives edges.size() - 1 bins, including empty
/// bins. An error that is NaN, or whose key is NaN or outside all bins, is left out.
[[nodiscard]] std::vector<ErrorBin> by_bins(std::span<const float> errors,
                                            std::span<const float> keys,
                                            std::span<const double> edges);

/// Shares (0 to 1) of the errors within one, two and three sigma; NaN without errors. Expected for
/// a calibrated normal sigma: 0.683, 0.954 and 0.997.
struct SigmaCoverage {
    double within_1_sigma = 0.0;
    double within_2_sigma = 0.0;
    double within_3_sigma = 0.0;
    std::int64_t count = 0;
};

/// Counts |error| <= k sigma. Leaves out NaN errors and sigmas that are not finite or negative. A
/// sigma of 0 counts, and covers only an error of 0.
[[nodiscard]] SigmaCoverage sigma_coverage(std::span<const float> errors,
                                           std::span<const float> sigmas);

}  // namespace surefoot::eval
