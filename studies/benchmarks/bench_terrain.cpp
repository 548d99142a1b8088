// SPDX-License-Identifier: Apache-2.0
#include <iterator>
#include <utility>
#include <vector>

#include "studies/benchmarks/bench_result.hpp"
#include "studies/benchmarks/terrain_workloads.hpp"

namespace surefoot::app {
namespace {

Result<Timing> timed(const Workload& workload, const Workload::Prepare& prepare) {
    const auto job = prepare();
    if (!job) return job.error();
    Timing timing = app::timed(workload.repeats, *job);
    timing.median_ms /= workload.queries;
    timing.p99_ms /= workload.queries;
    if (timing.least_cpu_ms) *timing.least_cpu_ms /= workload.queries;
    if (timing.median_cpu_ms) *timing.median_cpu_ms /= workload.queries;
    return timing;
}

}  // namespace

Result<std::vector<BenchResult>> bench_terrain(const CommonOptions& common, Executor& executor) {
    std::vector<Workload> workloads = elevation_workloads(executor);
    auto more = traversability_workloads(common.threads == 1, executor);
    std::move(more.begin(), more.end(), std::back_inserter(workloads));
    std::vector<BenchResult> results;
    results.reserve(workloads.size());
    for (const Workload& workload : workloads) {
        const auto ours = timed(workload, workload.prepare);
        if (!ours) return ours.error();
        results.push_back({workload.name, *ours});
        if (!workload.prepare_plain) continue;
        const auto plain = timed(workload, workload.prepare_plain);
        if (!plain) return plain.error();
        results.back().peer = *plain;
    }
    return results;
}

}  // namespace surefoot::app
