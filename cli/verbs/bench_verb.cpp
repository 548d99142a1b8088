// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <functional>
#include <limits>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/json/program_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "studies/benchmarks/bench_result.hpp"
#include "studies/runs/run_output.hpp"
#include "studies/runs/run_session.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/camera/reproject.hpp"

namespace surefoot::app {

std::int64_t cpu_now_ns() {
    return static_cast<std::int64_t>(std::clock()) * (1'000'000'000 / CLOCKS_PER_SEC);
}

Timing timed(int repeats, const std::function<void()>& work, const std::function<void()>& before) {
    work();  // fills the caches and allocates memory before the measurement
    std::vector<double> times_ms;
    std::vector<double> cpu_ms;
    for (int i = 0; i < repeats; ++i) {
        if (before) before();
        const Timing once = timed_once(work);
        times_ms.push_back(once.median_ms);
        cpu_ms.push_back(*once.least_cpu_ms);
    }
    const Percentiles p = percentiles(std::move(times_ms));
    const double least_ms = *std::min_element(cpu_ms.begin(), cpu_ms.end());
    return {p.median, p.p99, least_ms, percentiles(std::move(cpu_ms)).median};
}

Timing timed_once(const std::function<void()>& work) {
    const std::int64_t start_ns = steady_now_ns();
    const std::clock_t start_cpu = std::clock();
    work();
    const double cpu_ms = 1000.0 * static_cast<double>(std::clock() - start_cpu) / CLOCKS_PER_SEC;
    const double ms = static_cast<double>(steady_now_ns() - start_ns) * 1e-6;
    return {ms, ms, cpu_ms, cpu_ms};
}

namespace {

struct BenchOptions {
    CommonOptions common;
    std::string group;  ///< name of the group of benchmarks (see the help); empty = all groups
};

/// Runs the whole pipeline on 40 frames of simulated stairs. `clock` measures the time of each
/// stage.
Result<RunRecord> drive_stairs(const CommonOptions& common,
                               const Settings& settings,
                               Executor& executor,
                               std::int64_t (*clock)()) {
    auto source =
        open_source({"sim:demo_stairs", "", 0.0, 40, common.seed, settings.sim}, executor);
    if (!source) return source.error();
    auto pipeline = pipeline::Pipeline::make(settings.pipeline, (*source)->rig(), executor, clock);
    if (!pipeline) return pipeline.error();
    RunSession session(*pipeline, **source, (*source)->rig(), 1, settings.maps);
    session.drive();
    if (session.record().error) return *session.record().error;
    return session.record();
}

/// Measures whole frames and each stage, first in wall-clock time, then, in a second run, in
/// processor time.
Result<std::vector<BenchResult>> bench_chain(const CommonOptions& common, Executor& executor) {
    const auto settings = load_settings(common);
    if (!settings) return settings.error();
    const auto wall = drive_stairs(common, *settings, executor, steady_now_ns);
    if (!wall) return wall.error();
    const auto cpu = drive_stairs(common, *settings, executor, cpu_now_ns);
    if (!cpu) return cpu.error();
    const auto line = [](std::string_view what, Percentiles wall_ms, Percentiles cpu_ms) {
        return BenchResult{fmt::format("chain/{}", what),
                           {wall_ms.median, wall_ms.p99, std::nullopt, cpu_ms.median}};
    };
    std::vector<BenchResult> results;
    for (int i = 0; i < kStageCount; ++i) {
        const auto stage = static_cast<Stage>(i);
        results.push_back(line(
            to_string(stage), stage_percentiles(*wall, stage), stage_percentiles(*cpu, stage)));
    }
    results.push_back(line("whole_frame", frame_percentiles(*wall), frame_percentiles(*cpu)));
    return results;
}

/// Returns a rig with real lenses, scaled to an image size. The lenses are those of the published
/// calibration of the EuRoC data set.
camera::StereoRig lenses_at(int width, int height) {
    const auto lens = [&](double f, double cx, double cy) {
        // k1 and k2 have the published values of the left camera; the other parameters scale with
        // the image size.
        return camera::Camera{camera::PinholeRadTan{.fx_px = f * width,
                                                    .fy_px = f * width,
                                                    .cx_px = cx * width,
                                                    .cy_px = cy * height,
                                                    .k1 = -0.28341,
                                                    .k2 = 0.07396},
                              width,
                              height};
    };
    camera::StereoRig rig;
    rig.name = "bench";
    rig.left = lens(0.609, 0.488, 0.517);
    rig.right = lens(0.608, 0.505, 0.532);
    rig.T_left_right = {exp_so3({0.002, -0.014, 0.001}), {0.11, 0.0, 0.0}};
    return rig;
}

/// Returns the source position of each rectified pixel for cv::remap, so that OpenCV performs the
/// same rectification as our rectifier.
cv::Mat opencv_source(const camera::Rectifier& rectifier, camera::Side side) {
    const camera::RectifiedRig& rig = rectifier.rig();
    constexpr double kFar_m = 1e6;  // parallax is negligible at this depth
    cv::Mat source(rig.height, rig.width, CV_32FC2);
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const auto raw = rectifier.raw_from_point(
                side, rig.point(u, v, rig.depth_to_disparity_px_m() / kFar_m));
            source.at<cv::Vec2f>(v, u) =
                raw ? cv::Vec2f(static_cast<float>(raw->x()), static_cast<float>(raw->y()))
                    : cv::Vec2f(-100.0F, -100.0F);
        }
    }
    return source;
}

/// Measures the rectification of a pair and the conversion of a disparity image to points, each in
/// our code and in OpenCV.
Result<std::vector<BenchResult>> bench_camera(const CommonOptions&, Executor&) {
    constexpr int kRepeats = 51;
    std::vector<BenchResult> results;
    for (const auto& [width, height] : {std::pair{672, 376}, std::pair{1280, 720}}) {
        const std::string size = fmt::format("{}x{}", width, height);
        const auto rectifier = camera::Rectifier::make(lenses_at(width, height));
        if (!rectifier) return rectifier.error();
        StereoFrame frame;
        frame.left = GreyImage(width, height);
        for (std::size_t i = 0; i < frame.left.size(); ++i)
            frame.left.data()[i] = static_cast<std::uint8_t>(i * 2654435761U >> 24U);
        frame.right = frame.left;
        camera::RectifiedPair pair;
        results.push_back({"camera/rectify_pair_" + size,
                           timed(kRepeats, [&] { rectifier->rectify(frame, pair); })});
        const cv::Mat raw(height, width, CV_8UC1, frame.left.data());
        cv::Mat position[2];
        cv::Mat fraction[2];
        cv::Mat target;
        for (int k = 0; k < 2; ++k) {
            cv::convertMaps(opencv_source(*rectifier, static_cast<camera::Side>(k)),
                            cv::noArray(),
                            position[k],
                            fraction[k],
                            CV_16SC2);
        }
        results.back().peer = timed(kRepeats, [&] {
            for (int k = 0; k < 2; ++k)
                cv::remap(raw, target, position[k], fraction[k], cv::INTER_LINEAR);
        });

        Image<float> disparity_px(width, height);
        for (std::size_t i = 0; i < disparity_px.size(); ++i)
            disparity_px.data()[i] = 1.0F + static_cast<float>(i % 97);
        const camera::Reprojector reprojector(rectifier->rig());
        Image<Eigen::Vector3f> points_m;
        results.push_back({"camera/points_" + size, timed(kRepeats, [&] {
                               reprojector.points(disparity_px.view(), points_m);
                           })});
        const camera::RectifiedRig& rig = rectifier->rig();
        const cv::Mat Q = (cv::Mat_<double>(4, 4) << 1,
                           0,
                           0,
                           -rig.cx_px,
                           0,
                           1,
                           0,
                           -rig.cy_px,
                           0,
                           0,
                           0,
                           rig.fx_px,
                           0,
                           0,
                           1.0 / rig.baseline_m,
                           0);
        const cv::Mat disparity(height, width, CV_32FC1, disparity_px.data());
        cv::Mat points;
        results.back().peer =
            timed(kRepeats, [&] { cv::reprojectImageTo3D(disparity, points, Q); });
    }
    return results;
}

/// `surefoot bench`: measures the run time of the benchmarks of a group.
int bench(const BenchOptions& options) {
    const auto executor = make_executor(options.common);
    using Group = Result<std::vector<BenchResult>> (*)(const CommonOptions&, Executor&);
    const std::pair<const char*, Group> groups[] = {{"chain", bench_chain},
                                                    {"camera", bench_camera},
                                                    {"odometry", bench_odometry},
                                                    {"stereo", bench_stereo},
                                                    {"terrain", bench_terrain},
                                                    {"gate", bench_gate},
                                                    {"places", bench_places},
                                                    {"clouds", bench_clouds},
                                                    {"sim", bench_sim}};
    std::vector<BenchResult> all;
    for (const auto& [name, group] : groups) {
        if (!options.group.empty() && options.group != name) continue;
        const auto results = group(options.common, *executor);
        if (!results) return report(results.error());
        all.insert(all.end(), results->begin(), results->end());
    }
    if (options.common.json) {
        print_answer(bench_json(all));
        return kExitOk;
    }
    fmt::print(
        "peer = another implementation of the same work in the same run (OpenCV or plain code)\n"
        "{:<46}{:>12}{:>10}{:>14}{:>14}{:>18}{:>16}\n",
        "benchmark",
        "median ms",
        "p99 ms",
        "least CPU ms",
        "peer ms",
        "peer least CPU ms",
        "median CPU ms");
    // Times below 10 us are printed with a resolution of 1 ns.
    const auto in_ms = [](const std::optional<double>& value_ms) {
        if (!value_ms) return std::string("-");
        return fmt::format("{:.{}f}", *value_ms, *value_ms < 0.01 ? 6 : 3);
    };
    for (const BenchResult& r : all) {
        const Timing peer = r.peer.value_or(Timing{});
        fmt::print("{:<46}{:>12}{:>10}{:>14}{:>14}{:>18}{:>16}\n",
                   r.name,
                   in_ms(r.ours.median_ms),
                   in_ms(r.ours.p99_ms),
                   in_ms(r.ours.least_cpu_ms),
                   in_ms(r.peer ? std::optional(peer.median_ms) : std::nullopt),
                   in_ms(peer.least_cpu_ms),
                   in_ms(r.ours.median_cpu_ms));
    }
    return kExitOk;
}

}  // namespace

void add_bench(VerbGroup verbs) {
    auto [verb, o] = verbs.add<BenchOptions>(
        "bench",
        "measure the run time of the whole chain and of its parts on this computer",
        "surefoot bench gate",
        bench);
    verb.option("group",
                o.group,
                "group of benchmarks: chain, camera, odometry, stereo, terrain, gate, places, "
                "clouds or sim (default: all)")
        .one_of({"chain",
                 "camera",
                 "odometry",
                 "stereo",
                 "terrain",
                 "gate",
                 "places",
                 "clouds",
                 "sim"});
}

}  // namespace surefoot::app
