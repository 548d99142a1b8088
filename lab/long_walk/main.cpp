// SPDX-License-Identifier: Apache-2.0
// How do errors of odometry and map, and the memory of the process, develop in an hour?
// Usage: long_walk OUT.csv SCENE SEED MINUTES [KEY=VALUE...]
//   long_walk out/hour.csv room 21 60 pipeline.level.enabled=false
//   MINUTES: simulated time. KEY=VALUE: a setting of surefoot.
//
// The path of a scene (at most 250 frames) is rendered once with the fitted ZED profile. The
// machine walks it back and forth as fast as the computer allows. Every frame gets new noise, so
// that no pass equals another. There is no IMU, because its readings cannot be played backwards.
// Depth and map run on every fifth frame.
//
// Writes OUT.csv, one line per minute of simulated time, about the frames since the last line:
//   minute, tilt_deg, yaw_deg  errors of the vertical and of the heading of odom
//   horizontal_mm, height_mm   error of the position of base_link
//   jump_mm                    largest error of the motion from one frame to the next
//   lost                       number of LOST frames
//   known_cells, resident_mb   known cells of the map; resident memory of the process
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "service/console/log.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {
namespace {

constexpr int kMostFrames = 250;  ///< largest number of path frames in memory
constexpr int kDepthEvery = 5;
constexpr double kNewNoise_grey = 1.5;
constexpr std::int64_t kMinute_ns = 60'000'000'000;

struct Way {
    camera::StereoRig rig;
    std::vector<StereoFrame> frames;
    Trajectory bodies;
    std::int64_t period_ns = 0;
};

Result<Way> render(sim::SceneOptions sim, Executor& executor) {
    sim.profile = sim::CameraProfile::zed;
    sim.frames = kMostFrames;
    auto source = sim::open_scene(sim, &executor);
    if (!source) return source.error();
    Way way{
        (*source)->rig(), {}, (*source)->truth().trajectory, ns_from_seconds(1.0 / sim.rate_hz)};
    way.rig.imu.reset();
    while (true) {
        auto frame = (*source)->next();
        if (!frame) return frame.error();
        if (!*frame) break;
        way.frames.push_back(std::move(**frame));
        way.frames.back().imu.clear();
    }
    return way;
}

void add_noise(Rng& rng, GreyImage& image) {
    // Normal random numbers are slow. This table is filled once and read from a new random
    // position in every row.
    static const std::vector<float> table = [] {
        Rng fill(1);
        std::vector<float> values(1 << 16);
        for (float& value : values) value = static_cast<float>(kNewNoise_grey * fill.normal());
        return values;
    }();
    for (int v = 0; v < image.height(); ++v) {
        std::size_t at = rng.next_u64() % (table.size() - static_cast<std::size_t>(image.width()));
        for (int u = 0; u < image.width(); ++u) {
            const float grey = static_cast<float>(image.at(u, v)) + table[at++];
            image.at(u, v) = static_cast<std::uint8_t>(std::clamp(grey + 0.5F, 0.0F, 255.0F));
        }
    }
}

/// Returns the index on the path that goes back and forth: 0, 1, ..., n - 1, n - 2, ..., 1, 0, 1,
/// ...
std::size_t place_on_way(std::int64_t index, std::size_t frames) {
    const auto period = 2 * (static_cast<std::int64_t>(frames) - 1);
    const std::int64_t phase = index % period;
    return static_cast<std::size_t>(std::min(phase, period - phase));
}

double resident_mb() {
    std::ifstream file("/proc/self/statm");
    double pages = 0.0;
    double resident_pages = 0.0;
    file >> pages >> resident_pages;
    return resident_pages * 4096.0 / 1e6;
}

void report_minute(std::int64_t minute,
                   const Pose& T_world_body,
                   const Pose& T_odom_body,
                   double jump_m,
                   int lost,
                   std::int64_t known_cells,
                   fmt::ostream& out) {
    const Eigen::Quaterniond R_world_odom =
        T_world_body.rotation * T_odom_body.rotation.conjugate();
    const Eigen::Vector3d up = R_world_odom * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d ahead = R_world_odom * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d off_m = T_odom_body.translation_m - T_world_body.translation_m;
    out.print("{},{:.3f},{:.3f},{:.1f},{:.1f},{:.1f},{},{},{:.1f}\n",
              minute,
              kDegPerRad * std::atan2(up.head<2>().norm(), up.z()),
              kDegPerRad * std::atan2(ahead.y(), ahead.x()),
              1e3 * off_m.head<2>().norm(),
              1e3 * off_m.z(),
              1e3 * jump_m,
              lost,
              known_cells,
              resident_mb());
    out.flush();
}

Status walk(const Way& way,
            int minutes,
            const pipeline::PipelineConfig& config,
            Executor& executor,
            fmt::ostream& out) {
    auto pipeline = pipeline::Pipeline::make(config, way.rig, executor);
    if (!pipeline) return pipeline.error();
    pipeline->align(std::span(way.frames).first(pipeline::Pipeline::kAlignmentFrames),
                    way.bodies.front().T_world_body);
    const std::int64_t start_ns = way.frames.front().time_ns;
    std::int64_t next_report_ns = start_ns + kMinute_ns;
    Pose T_world_last = way.bodies.front().T_world_body;
    double jump_m = 0.0;
    int lost = 0;
    for (std::int64_t i = 0; next_report_ns <= start_ns + minutes * kMinute_ns; ++i) {
        const std::size_t place = place_on_way(i, way.frames.size());
        StereoFrame frame = way.frames[place];
        frame.time_ns = start_ns + i * way.period_ns;
        frame.index = static_cast<int>(i);
        Rng rng(mix_seed(1, static_cast<std::uint64_t>(i)));
        add_noise(rng, frame.left);
        add_noise(rng, frame.right);
        const FrameReport report =
            pipeline->process(frame, i % kDepthEvery == 0 ? Work::full : Work::odometry);
        const Pose& T_world_body = way.bodies[place].T_world_body;
        const Vector6 step =
            difference(T_world_last.inverse() * T_world_body, report.motion.T_previous_body);
        if (i > 0) jump_m = std::max(jump_m, step.head<3>().norm());
        lost += report.motion.health == Health::lost ? 1 : 0;
        T_world_last = T_world_body;
        if (frame.time_ns < next_report_ns) continue;
        report_minute((next_report_ns - start_ns) / kMinute_ns,
                      T_world_body,
                      report.motion.T_odom_body,
                      jump_m,
                      lost,
                      report.known_cells,
                      out);
        next_report_ns += kMinute_ns;
        jump_m = 0.0;
        lost = 0;
    }
    return {};
}

int measure(const std::vector<std::string>& words) {
    if (words.size() < 4)
        return report(usage_error("long_walk OUT.csv SCENE SEED MINUTES [KEY=VALUE...]"));
    SettingsRequest common;
    common.overrides.assign(words.begin() + 4, words.end());
    auto settings = surefoot::load_settings(common);
    if (!settings) return report(settings.error());
    settings->sim.scene = words[1];
    settings->sim.seed = std::strtoull(words[2].c_str(), nullptr, 10);
    const auto executor = surefoot::make_executor();
    const auto way = render(settings->sim, *executor);
    if (!way) return report(way.error());
    auto out = fmt::output_file(words[0]);
    out.print(
        "minute,tilt_deg,yaw_deg,horizontal_mm,height_mm,jump_mm,lost,known_cells,resident_mb\n");
    const Status walked =
        walk(*way, std::atoi(words[3].c_str()), settings->pipeline, *executor, out);
    return walked ? 0 : report(walked.error());
}

}  // namespace
}  // namespace surefoot::app

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::app::measure({argv + 1, argv + argc});
}
