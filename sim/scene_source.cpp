// SPDX-License-Identifier: Apache-2.0
#include "sim/scene_source.hpp"

#include <fmt/format.h>

#include <algorithm>
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
constexpr std::uint64_t kFaultStream = 3;
constexpr std::uint64_t kExposureStream = 4;

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
    visitor.enumeration("profile", profile, kCameraProfileNames, "added to the camera below");
    visitor.number("noise", noise, 0.0, 20.0, "factor on every noise amplitude of the images");
    visitor.number("contrast", contrast, 0.0, 2.0, "factor on the contrast of every material");
    visitor.group("imaging", camera.imaging);
    visitor.group("optics", camera.optics);
    visitor.group("shutter", camera.shutter);
    visitor.group("exposure", camera.exposure);
    visitor.group("calibration_error", calibration_error);
    visitor.group("faults", faults);
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
    source->motion_ = script->motion;
    if (source->truth_.rig.imu) {
        source->imu_.emplace(script->motion,
                             *source->truth_.rig.imu,
                             options.imu_noise,
                             kStart_ns,
                             mix_seed(options.seed, kImuStream));
    }
    source->truth_.scene = std::move(script->scene);
    const ProfileFigures profile = figures_of(options.profile);
    source->truth_.scene.scale_contrast(options.contrast * profile.contrast);
    CameraConfig camera = options.camera;
    apply_profile(options.profile, options.noise, camera);
    source->truth_.steps = std::move(script->steps);
    source->truth_.start_ns = kStart_ns;
    auto renderer = Renderer::make(
        source->truth_.scene,
        with_error(with_error(source->truth_.rig, profile.calibration), options.calibration_error),
        camera,
        mix_seed(options.seed, kNoiseStream));
    if (!renderer) return renderer.error();
    source->renderer_.emplace(std::move(renderer).value());
    const int frames = static_cast<int>(source->truth_.trajectory.size());
    const int height = source->truth_.rig.left.height;
    if (auto wrong = options.faults.problem(frames, height)) {
        return usage_error("simulator: " + *wrong);
    }
    source->faults_ =
        plan_faults(options.faults, frames, height, mix_seed(options.seed, kFaultStream));
    const auto dropped =
        std::count_if(source->faults_.begin(), source->faults_.end(), [](const auto& fault) {
            return fault.kind == ImageFault::dropped;
        });
    source->control_.emplace(options.camera.exposure, mix_seed(options.seed, kExposureStream));
    source->imu_until_ns_ = kStart_ns - kImuLead_ns;
    source->info_ = {
        "sim", options.scene, frames - static_cast<int>(dropped), source->imu_.has_value()};
    return source;
}

/// Exposes both eyes at a stamp; the exposure control lives on, whatever becomes of the images.
void SceneSource::take_pictures(const StampedPose& now) {
    const double since_start_s = seconds_from_ns(now.time_ns - kStart_ns);
    std::swap(older_left_, pair_.left);
    std::swap(older_right_, pair_.right);
    shot_ = control_->shot(since_start_s);
    renderer_->collect(*motion_, since_start_s, shot_.exposure_s, *executor_, clean_);
    if (next_pose_ == 0) {
        control_->settle(clean_.left.signal_dn);
        shot_ = control_->shot(since_start_s);
    }
    renderer_->expose(clean_, shot_, static_cast<int>(next_pose_), *executor_, pair_);
    control_->update(clean_.left.signal_dn, 1.0 / truth_.rig.rate_hz);
}

/// What arrives of the last exposure.
void SceneSource::damage(const InjectedFault* fault) {
    const bool stale = fault != nullptr &&
                       (fault->kind == ImageFault::repeated || fault->kind == ImageFault::frozen);
    if (stale) return;
    shown_left_ = pair_.left;
    shown_right_ = pair_.right;
    if (fault == nullptr || fault->kind != ImageFault::torn) return;
    tear(older_left_, fault->tear_row, shown_left_);
    tear(older_right_, fault->tear_row, shown_right_);
}

Result<std::optional<StereoFrame>> SceneSource::next() {
    while (next_pose_ < truth_.trajectory.size()) {
        const StampedPose& now = truth_.trajectory[next_pose_];
        const InjectedFault* fault = nullptr;
        if (next_fault_ < faults_.size() &&
            faults_[next_fault_].frame == static_cast<int>(next_pose_)) {
            fault = &faults_[next_fault_++];
        }
        take_pictures(now);
        ++next_pose_;
        if (fault != nullptr && fault->kind == ImageFault::dropped) continue;
        damage(fault);
        StereoFrame frame;
        frame.time_ns = now.time_ns;
        frame.index = next_index_++;
        frame.left = shown_left_;
        frame.right = shown_right_;
        if (imu_) frame.imu = imu_->samples(imu_until_ns_, now.time_ns);
        imu_until_ns_ = now.time_ns;
        return std::optional<StereoFrame>{std::move(frame)};
    }
    return std::optional<StereoFrame>{};
}

}  // namespace surefoot::sim
