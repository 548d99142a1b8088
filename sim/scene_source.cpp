// SPDX-License-Identifier: Apache-2.0
#include "sim/scene_source.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "sim/rigs.hpp"
#include "sim/scenes.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::sim {
namespace {

constexpr std::int64_t kStart_ns = kNanosecondsPerSecond;
constexpr std::int64_t kImuLead_ns = kNanosecondsPerSecond / 10;
constexpr int kMaxFrames = 1'000'000;
constexpr double kMinRate_hz = 0.1;
constexpr double kMaxRate_hz = 1000.0;
constexpr std::uint64_t kNoiseStream = 1;
constexpr std::uint64_t kImuStream = 2;

std::optional<Error> problem(const SceneOptions& options) {
    if (!(options.rate_hz >= kMinRate_hz && options.rate_hz <= kMaxRate_hz)) {
        return usage_error(fmt::format("simulator: rate_hz is {}, allowed are {} to {}",
                                       options.rate_hz,
                                       kMinRate_hz,
                                       kMaxRate_hz));
    }
    if (options.frames < 0 || options.frames > kMaxFrames) {
        return usage_error(
            fmt::format("simulator: frames is {}, allowed are 0 (to the end of the path) to {}",
                        options.frames,
                        kMaxFrames));
    }
    return std::nullopt;
}

std::vector<StampedPose> sampled(const Motion& motion, int frames, double rate_hz) {
    // Half a nanosecond of slack: the last frame belongs to the path when it falls on its end.
    const int whole_path = static_cast<int>(std::floor(motion.duration_s() * rate_hz + 1e-6)) + 1;
    const int count = frames > 0 ? frames : whole_path;
    std::vector<StampedPose> poses;
    for (int i = 0; i < count; ++i) {
        const std::int64_t since_start_ns = ns_from_seconds(i / rate_hz);
        poses.push_back(
            {kStart_ns + since_start_ns, motion.at(seconds_from_ns(since_start_ns)).T_world_body});
    }
    return poses;
}

}  // namespace

void SceneOptions::describe(ConfigVisitor& visitor) {
    visitor.integer("frames", frames, 0, kMaxFrames, "0 = to the end of the path");
    visitor.number("rate_hz", rate_hz, kMinRate_hz, kMaxRate_hz, "frames per second");
    visitor.boolean("imu", imu, "emit IMU samples, where the rig has an IMU");
    visitor.group("imaging", imaging);
    visitor.group("imu_noise", imu_noise);
}

Result<std::unique_ptr<SceneSource>> open_scene(const SceneOptions& options, Executor* executor) {
    if (auto error = problem(options)) return *std::move(error);
    auto script = make_scene(options.scene, options.seed);
    if (!script) return script.error();
    auto rig =
        options.rig ? Result<camera::StereoRig>(*options.rig) : rig_preset(options.rig_preset);
    if (!rig) return rig.error();

    std::unique_ptr<SceneSource> source(new SceneSource);
    source->executor_ = executor != nullptr ? executor : &source->serial_;
    source->truth_.rig = *rig;
    source->truth_.rig.rate_hz = options.rate_hz;
    if (!options.imu) source->truth_.rig.imu.reset();
    source->truth_.trajectory = sampled(*script->motion, options.frames, options.rate_hz);
    if (source->truth_.rig.imu) {
        source->imu_.emplace(script->motion,
                             *source->truth_.rig.imu,
                             options.imu_noise,
                             kStart_ns,
                             mix_seed(options.seed, kImuStream));
    }
    source->truth_.scene = std::move(script->scene);
    auto renderer = Renderer::make(source->truth_.scene,
                                   source->truth_.rig,
                                   options.imaging,
                                   mix_seed(options.seed, kNoiseStream));
    if (!renderer) return renderer.error();
    source->renderer_.emplace(std::move(renderer).value());
    source->info_ = {"sim",
                     options.scene,
                     static_cast<int>(source->truth_.trajectory.size()),
                     source->imu_.has_value()};
    return source;
}

Result<std::optional<StereoFrame>> SceneSource::next() {
    if (next_frame_ >= truth_.trajectory.size()) return std::optional<StereoFrame>{};
    const StampedPose& now = truth_.trajectory[next_frame_];
    StereoFrame frame;
    frame.time_ns = now.time_ns;
    frame.index = static_cast<int>(next_frame_);
    renderer_->render(now.T_world_body, frame.index, *executor_, pair_);
    frame.left = pair_.left;
    frame.right = pair_.right;
    if (imu_) {
        const std::int64_t after_ns = next_frame_ == 0 ? now.time_ns - kImuLead_ns
                                                       : truth_.trajectory[next_frame_ - 1].time_ns;
        frame.imu = imu_->samples(after_ns, now.time_ns);
    }
    ++next_frame_;
    return std::optional<StereoFrame>{std::move(frame)};
}

}  // namespace surefoot::sim
