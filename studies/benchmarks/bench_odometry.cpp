// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <vector>

#include "service/console/option_settings.hpp"
#include "studies/benchmarks/bench_result.hpp"
#include "studies/runs/run_output.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/odometry/odometry.hpp"
#include "surefoot/sim/scene_source.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::app {
namespace {

constexpr int kFrames = 70;
constexpr int kSkipped =
    15;  ///< number of first frames that are not timed, because the trolley is at rest

/// Returns the ZED rig of the simulator with the wider lenses of the EuRoC data set.
Result<camera::StereoRig> wide_rig() {
    auto rig = sim::rig_preset("zed_vga");
    if (!rig) return rig.error();
    const camera::Camera lens{camera::PinholeRadTan{.fx_px = 458.0,
                                                    .fy_px = 457.0,
                                                    .cx_px = 367.0,
                                                    .cy_px = 248.0,
                                                    .k1 = -0.28341,
                                                    .k2 = 0.07396},
                              752,
                              480};
    rig->left = lens;
    rig->right = lens;
    rig->rectified = false;
    return rig;
}

}  // namespace

Result<std::vector<BenchResult>> bench_odometry(const CommonOptions& common, Executor& executor) {
    const auto settings = load_settings(common);
    if (!settings) return settings.error();
    const auto rig = wide_rig();
    if (!rig) return rig.error();
    const auto rectifier = camera::Rectifier::make(*rig);
    if (!rectifier) return rectifier.error();
    sim::SceneOptions scene = settings->sim;
    scene.scene = "room";
    scene.rig = *rig;
    scene.profile = sim::CameraProfile::zed;
    scene.frames = kFrames;
    std::vector<StereoFrame> frames;
    auto source = sim::open_scene(scene, &executor);
    if (!source) return source.error();
    while (true) {
        auto frame = (*source)->next();
        if (!frame) return frame.error();
        if (!*frame) break;
        frames.push_back(std::move(**frame));
    }
    std::vector<BenchResult> results;
    for (const bool with_imu : {true, false}) {
        odometry::Odometry odometry(
            settings->pipeline.odometry, *rectifier, with_imu ? rig->imu : std::nullopt);
        std::vector<double> wall_ms;
        std::vector<double> cpu_ms;
        for (const StereoFrame& frame : frames) {
            const std::int64_t start_ns = steady_now_ns();
            const std::int64_t start_cpu_ns = cpu_now_ns();
            const MotionEstimate motion = odometry.update(frame, executor);
            if (frame.index >= kSkipped && motion.health == Health::lost)
                return input_error(
                    "bench odometry: odometry was lost, so the timing means nothing");
            if (frame.index < kSkipped) continue;
            wall_ms.push_back(1e-6 * static_cast<double>(steady_now_ns() - start_ns));
            cpu_ms.push_back(1e-6 * static_cast<double>(cpu_now_ns() - start_cpu_ns));
        }
        const Percentiles wall = percentiles(std::move(wall_ms));
        results.push_back(
            {fmt::format("odometry/frame_752x480_{}", with_imu ? "with_imu" : "without_imu"),
             {wall.median, wall.p99, std::nullopt, percentiles(std::move(cpu_ms)).median}});
    }
    return results;
}

}  // namespace surefoot::app
