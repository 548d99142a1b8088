// SPDX-License-Identifier: Apache-2.0

// Runs the workloads of `surefoot bench terrain` under Google Benchmark, on one thread, to use its
// filters, repetitions and comparison of files. Some workloads also run by the plain reference
// implementation.
#include <benchmark/benchmark.h>

#include <iterator>
#include <utility>
#include <vector>

#include "studies/benchmarks/terrain_workloads.hpp"
#include "surefoot/core/executor.hpp"

namespace {

using surefoot::app::Workload;

void enrol(const Workload& workload, const char* way, const Workload::Prepare& prepare) {
    const auto run = [prepare, queries = workload.queries](benchmark::State& state) {
        const auto job = prepare();
        if (!job) {
            state.SkipWithError(job.error().message.c_str());
            return;
        }
        (*job)();  // warm-up: allocations, caches
        for (auto _ : state) (*job)();
        state.SetItemsProcessed(state.iterations() * queries);
    };
    benchmark::RegisterBenchmark((workload.name + way).c_str(), run)->Unit(benchmark::kMicrosecond);
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    surefoot::Serial executor;
    std::vector<Workload> workloads = surefoot::app::elevation_workloads(executor);
    auto more = surefoot::app::traversability_workloads(true, executor);
    std::move(more.begin(), more.end(), std::back_inserter(workloads));
    for (const Workload& workload : workloads) {
        enrol(workload, "", workload.prepare);
        if (workload.prepare_plain) enrol(workload, "/plain", workload.prepare_plain);
    }
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
