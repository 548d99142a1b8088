// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace surefoot::eval {

/// Does a sigma know which values are wrong? The values are taken away one by one, the least sure
/// first, and the mean |error| of those that remain is followed. With n values sorted by growing
/// sigma,
///     E(m) = mean |error| of the m most sure values,    area = (1 / n) sum of E(1) .. E(n),
/// `oracle_area` is the same with the values sorted by |error| itself, the best order there is, and
/// `random_area` that of a random order: the mean |error|. The order is judged by
///     auc = (area - oracle_area) / (random_area - oracle_area):
/// 0 = as good as the oracle, 1 = no better than chance, above 1 = misleading. It does not depend
/// on the unit or the size of the errors, so maps of different scenes compare (cf. Ilg et al. 2018,
/// "Uncertainty estimates and multi-hypotheses networks for optical flow": there the area between
/// the curves, AUSE, is divided by the error alone).
/// Values of equal sigma have no order: each stands for the mean of all with that sigma, which is
/// the expectation over their orders. So no result depends on the order of the input.
struct Sparsification {
    double auc = 0.0;  ///< NaN without values, and where all |error| are equal: nothing to find
    double area = 0.0;
    double oracle_area = 0.0;
    double random_area = 0.0;
    std::int64_t count = 0;
};

/// Pairs in which either number is not finite are left out.
[[nodiscard]] Sparsification sparsification(std::span<const float> errors,
                                            std::span<const float> sigmas);

}  // namespace surefoot::eval
