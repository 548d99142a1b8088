// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace surefoot::eval {

/// Round numbers on an axis: multiples of 1, 2 or 5 times a power of ten.
struct Ticks {
    std::vector<double> values;  ///< ascending, within the range
    double step = 1.0;
    int decimals = 0;  ///< number of decimals that distinguish neighbouring values
    [[nodiscard]] std::string label(double value) const;
};

/// Returns the largest 1, 2 or 5 times a power of ten that is not above `value` (> 0).
[[nodiscard]] double nice_below(double value);

/// Returns at most `target` + 1 round numbers in [low, high]; low < high, both finite.
[[nodiscard]] Ticks nice_ticks(double low, double high, int target);

}  // namespace surefoot::eval
