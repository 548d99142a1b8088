// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// A job of the terrain engine to time. `surefoot bench terrain` and the Google Benchmark target
/// share these jobs. `prepare` sets up the data of a job; the data live as long as the job.
struct Workload {
    using Job = std::function<void()>;
    using Prepare = std::function<Result<Job>()>;

    std::string name;
    int repeats = 1;  ///< repetitions that give a stable time within two seconds
    Prepare prepare;
    /// The same job by the plain implementation (Way::plain). Empty = there is none.
    Prepare prepare_plain = {};
    int queries = 1;  ///< queries per call, because one query is shorter than the clock step
};

/// Returns the jobs of the elevation map: fusing depth images, moves, ray endpoints, bounds. The
/// larger jobs also run with other map sizes.
[[nodiscard]] std::vector<Workload> elevation_workloads(Executor& executor);
/// Returns the jobs of the traversability rating: maps of several sizes and settings, and queries
/// on the rating. With `one_thread`, one set is also timed with AVX2.
[[nodiscard]] std::vector<Workload> traversability_workloads(bool one_thread, Executor& executor);

}  // namespace surefoot::app
