// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/surefoot/verbs.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::app {

struct Timing {
    double median_ms = 0.0;  ///< of the clock on the wall
    double p99_ms = 0.0;
    /// Least processor time of the process in one call: what a crowded machine leaves comparable.
    std::optional<double> least_cpu_ms = {};
    std::optional<double> median_cpu_ms = {};  ///< likewise; where calls differ, as frames do
};

/// One line of `surefoot bench`.
struct BenchResult {
    std::string name;
    Timing ours;
    /// The same job in the same run by somebody else (OpenCV), or the plain way (terrain).
    std::optional<Timing> peer = {};
};

/// Processor time of the process, all its threads [ns].
[[nodiscard]] std::int64_t cpu_now_ns();

/// Times `work`, after one call that warms up. `before`: runs before each call and is not timed.
[[nodiscard]] Timing timed(int repeats,
                           const std::function<void()>& work,
                           const std::function<void()>& before = {});
/// Times one call; nothing warms it up.
[[nodiscard]] Timing timed_once(const std::function<void()>& work);

/// The gate's verdicts on level ground for all movements: the first of the process, warm, with all
/// caches lost, on ground that has drifted, and what the audit log costs.
[[nodiscard]] Result<std::vector<BenchResult>> bench_gate(const CommonOptions& common,
                                                          Executor& executor);

/// Frames of a moving camera of 752x480 pixels through the odometry.
[[nodiscard]] Result<std::vector<BenchResult>> bench_odometry(const CommonOptions& common,
                                                              Executor& executor);

/// A view among as many keyframes as a place may hold, description included: in corridors that are
/// remembered, and in others like them.
[[nodiscard]] Result<std::vector<BenchResult>> bench_places(const CommonOptions& common,
                                                            Executor& executor);

/// Matching, beside OpenCV's; with two threads also two matchers at once, the most that two threads
/// could bring.
[[nodiscard]] Result<std::vector<BenchResult>> bench_stereo(const CommonOptions& common,
                                                            Executor& executor);

/// The workloads of the terrain engine (terrain_workloads.hpp), some beside the plain way.
[[nodiscard]] Result<std::vector<BenchResult>> bench_terrain(const CommonOptions& common,
                                                             Executor& executor);

/// The cloud tools on a million points, as others were measured.
[[nodiscard]] Result<std::vector<BenchResult>> bench_clouds(const CommonOptions& common,
                                                            Executor& executor);

/// Frames of two scenes as the simulator makes them, sharp, blurred and without images, beside what
/// the chain needs to find depth and motion in images. Only frames during which the camera moves.
[[nodiscard]] Result<std::vector<BenchResult>> bench_sim(const CommonOptions& common,
                                                         Executor& executor);

}  // namespace surefoot::app
