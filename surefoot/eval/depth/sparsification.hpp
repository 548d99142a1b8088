// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace surefoot::eval {

/// Measures whether sigma is large where the error is large. Values are removed one by one, the
/// most uncertain first, and the mean |error| of the rest is recorded. With n values sorted by
/// increasing sigma,
///     E(m) = mean |error| of the m most certain values, area = (1 / n) sum of E(1) .. E(n).
/// `oracle_area` is this area for the best possible order, by |error| itself. `random_area` is the
/// area of a random order, which equals the mean |error|. The score of the order is
///     auc = (area - oracle_area) / (random_area - oracle_area):
/// 0 = as good as the oracle, 1 = no better than chance, above 1 = misleading. The score does not
/// depend on unit or size of the errors, so scenes are comparable. (Ilg et al. 2018, "Uncertainty
/// estimates and multi-hypotheses networks for optical flow", divide the area between the curves,
/// AUSE, by the error alone.)
/// Values of equal sigma have no order: each gets the mean of all values with that sigma, the
/// expectation over their orders. The result therefore does not depend on the input order.
struct Sparsification {
    double auc = 0.0;  ///< NaN without values, and if all |error| are equal
    double area = 0.0;
    double oracle_area = 0.0;
    double random_area = 0.0;
    std::int64_t count = 0;
};

/// Leaves out pairs with a number that is not finite.
[[nodiscard]] Sparsification sparsification(std::span<const float> errors,
                                            std::span<const float> sigmas);

}  // namespace surefoot::eval
