// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace surefoot::app {

/// One line of `surefoot bench`.
struct BenchResult {
    std::string name;
    double median_ms = 0.0;
    double p99_ms = 0.0;
    std::optional<double> peer_ms;  ///< the same job by somebody else, measured in the same run
};

}  // namespace surefoot::app
