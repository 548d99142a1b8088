// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// A job of the terrain engine that can be timed: `surefoot bench terrain` and the Google Benchmark
/// target call the same ones. What a job works on is set up by `prepare` and lives as long as the
/// job.
struct Workload {
    using Job = std::function<void()>;
    using Prepare = std::function<Result<Job>()>;

    std::string name;
    int repeats = 1;  ///< that tell the time well within a second or two
    Prepare prepare;
    Prepare prepare_plain = {};  ///< the same by the plain way, where that is compared
    int queries = 1;             ///< in one call: one alone is shorter than a clock resolves
};

/// Depth images into the map, moves, lines of sight, bounds; the larger ones also over windows of
/// other sizes.
[[nodiscard]] std::vector<Workload> elevation_workloads(Executor& executor);
/// Ratings of maps of several sizes and settings, and what is made of them; one set is also timed
/// on AVX2 if `one_thread`.
[[nodiscard]] std::vector<Workload> traversability_workloads(bool one_thread, Executor& executor);

}  // namespace surefoot::app
