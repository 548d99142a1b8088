// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "service/console/options.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// Durations of repeated calls.
struct Timing {
    double median_ms = 0.0;  ///< median duration, wall clock
    double p99_ms = 0.0;     ///< 99th percentile of the durations, wall clock
    /// Smallest processor time that the process used in one call. Other load on the machine changes
    /// this figure less than the others, so compare runs by it.
    std::optional<double> least_cpu_ms = {};
    /// Median processor time. Use this figure if the calls do different work, as with frames.
    std::optional<double> median_cpu_ms = {};
};

/// One line of `surefoot bench`.
struct BenchResult {
    std::string name;
    Timing ours;
    /// The same work by OpenCV, or for terrain by a plain implementation, in the same run.
    std::optional<Timing> peer = {};
};

/// Returns the processor time that all threads of this process have used [ns].
[[nodiscard]] std::int64_t cpu_now_ns();

/// Calls `work` once to warm up, then times `repeats` calls. `before` runs before each timed call
/// and is not timed.
[[nodiscard]] Timing timed(int repeats,
                           const std::function<void()>& work,
                           const std::function<void()>& before = {});
/// Times one call, without a warm-up.
[[nodiscard]] Timing timed_once(const std::function<void()>& work);

/// Times the gate's verdicts on level ground for all movements: the first verdict of the process,
/// then verdicts with warm caches and with cold caches. Also times verdicts on a map with the
/// largest allowed drift, and the push of one verdict into the audit log.
[[nodiscard]] Result<std::vector<BenchResult>> bench_gate(const CommonOptions& common,
                                                          Executor& executor);

/// Times the odometry on frames of a moving camera of 752x480 pixels.
[[nodiscard]] Result<std::vector<BenchResult>> bench_odometry(const CommonOptions& common,
                                                              Executor& executor);

/// Times the recognition of one view, which includes its description. The place database holds the
/// largest allowed number of keyframes. The views come from corridors in the database and from
/// similar corridors that are not in it.
[[nodiscard]] Result<std::vector<BenchResult>> bench_places(const CommonOptions& common,
                                                            Executor& executor);

/// Times stereo matching by our matcher and by OpenCV. Unless --threads is 1, also times two
/// matchers at once: half of their time is a lower bound for one match on two threads.
[[nodiscard]] Result<std::vector<BenchResult>> bench_stereo(const CommonOptions& common,
                                                            Executor& executor);

/// Times the workloads of the terrain engine (terrain_workloads.hpp), and some of them also by a
/// plain implementation.
[[nodiscard]] Result<std::vector<BenchResult>> bench_terrain(const CommonOptions& common,
                                                             Executor& executor);

/// Times the cloud tools on a synthetic staircase of a million points.
[[nodiscard]] Result<std::vector<BenchResult>> bench_clouds(const CommonOptions& common,
                                                            Executor& executor);

/// Times how long the simulator needs for one frame of two scenes: sharp, blurred, and without
/// images (sim.sensor = analytic). Only frames during which the camera moves count. For comparison,
/// also times rectification, odometry and stereo matching on images of the same scenes.
[[nodiscard]] Result<std::vector<BenchResult>> bench_sim(const CommonOptions& common,
                                                         Executor& executor);

}  // namespace surefoot::app
