// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scene_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/sim/scenes/scene_motion.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

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
constexpr std::uint64_t kDepthStream = 5;
constexpr std::uint64_t kAnalyticStream = 6;
constexpr std::uint64_t kDriftStream = 7;
constexpr std::uint64_t kMachineStream = 8;

std::optional<Error> problem(const SceneOptions& options) {
    if (!(options.rate_hz >= kMinRate_hz && options.rate_hz <= kMaxRate_hz)) {
        return usage_error(fmt::format("simulator: rate_hz is {}; it must be {} to {}",
                                       options.rate_hz,
                                       kMinRate_hz,
                                       kMaxRate_hz));
    }
    if (options.frames < 0 || options.frames > kMaxFrames) {
        return usage_error(
            fmt::format("simulator: frames is {}; it must be 0 (to the end of the path) to {}",
                        options.frames,
                        kMaxFrames));
    }
    return std::nullopt;
}

StampedPose pose_of_frame(const Motion& motion, int frame, double rate_hz) {
    const std::int64_t since_start_ns = ns_from_seconds(frame / rate_hz);
    return {kStart_ns + since_start_ns, motion.at(seconds_from_ns(since_start_ns)).T_world_body};
}

Result<std::vector<StampedPose>> sampled(const Motion& motion, int frames, double rate_hz) {
    // Slack of 1e-6 frames: a last frame that falls on the end of the path belongs to the path.
    const double last_frame = std::floor(motion.duration_s() * rate_hz + 1e-6);
    const int count = frames > 0 ? frames : saturated_integer<int>(last_frame + 1.0);
    if (count > kMaxFrames) {
        return usage_error(
            fmt::format("simulator: the path takes {:g} s, which is {:g} frames at {:g} Hz; at "
                        "most {} are allowed: raise speed_m_s of the path, or set frames",
                        motion.duration_s(),
                        last_frame + 1.0,
                        rate_hz,
                        kMaxFrames));
    }
    std::vector<StampedPose> poses;
    poses.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) poses.push_back(pose_of_frame(motion, i, rate_hz));
    return poses;
}

/// Returns the rig of the depth camera, which has the pose of the left camera of `rig`. Returns
/// `rig` itself if it has no right camera.
camera::StereoRig depth_rig(const camera::StereoRig& rig, DepthCameraKind kind) {
    if (!rig.right) return rig;
    camera::StereoRig single = rig;
    single.name = kDepthCameraNames[static_cast<int>(kind)];
    single.left = depth_camera_preset(kind).camera;
    single.right.reset();
    single.T_left_right = Pose{};
    single.readout_s = 0.0;
    single.rectified = true;
    return single;
}

/// Adds an unused right camera to a depth camera, because the renderer needs pairs.
camera::StereoRig as_pair(const camera::StereoRig& single) {
    camera::StereoRig pair = single;
    pair.right = single.left;
    pair.T_left_right.translation_m = {0.1, 0.0, 0.0};
    return pair;
}

/// Returns the stereo camera whose raw images are the rectified images of `view`.
camera::StereoRig rectified_rig(const camera::StereoRig& rig, const camera::RectifiedRig& view) {
    camera::PinholeRadTan lens;
    lens.fx_px = view.fx_px;
    lens.fy_px = view.fy_px;
    lens.cx_px = view.cx_px;
    lens.cy_px = view.cy_px;
    camera::StereoRig ideal = rig;
    ideal.left = {lens, view.width, view.height};
    ideal.right = ideal.left;
    ideal.T_left_right = Pose{};
    ideal.T_left_right.translation_m.x() = view.baseline_m;
    ideal.T_body_left = view.T_body_camera;
    ideal.readout_s = 0.0;
    ideal.rectified = true;
    return ideal;
}

/// Returns true if a fault needs images. A dropped frame needs no image.
bool needs_images(const ImageFaultConfig& faults) {
    return faults.repeat_probability > 0.0 || faults.tear_probability > 0.0 ||
           faults.freeze_probability > 0.0 ||
           std::any_of(faults.planned.begin(), faults.planned.end(), [](const auto& fault) {
               return fault.kind != ImageFault::dropped;
           });
}

}  // namespace

std::optional<MotionModel> motion_model_of(MotionModelChoice carried_by) {
    switch (carried_by) {
        case MotionModelChoice::scene: return std::nullopt;
        case MotionModelChoice::trolley: return MotionModel::trolley;
        case MotionModelChoice::rex: return MotionModel::rex;
        case MotionModelChoice::hand: return MotionModel::hand;
    }
    return std::nullopt;
}

void SceneOptions::describe(ConfigVisitor& visitor) {
    visitor.enumeration("sensor",
                        sensor,
                        kSensorNames,
                        "sensor that records the scene; 'analytic' computes depth without images");
    visitor.enumeration(
        "motion_model",
        motion_model,
        kMotionModelChoiceNames,
        "motion model that moves the camera; 'scene' = the motion model of the scene file");
    visitor.boolean(
        "known_motion",
        known_motion,
        "true: start pose and motion are known, except for the errors of analytic.drift");
    visitor.integer(
        "frames", frames, 0, kMaxFrames, "number of frames; 0 = to the end of the path");
    visitor.boolean(
        "machine_motion",
        machine_motion,
        "true: frames carry the machine's motion estimate, with the errors of machine_drift");
    visitor.number("rate_hz", rate_hz, kMinRate_hz, kMaxRate_hz, "number of frames per second");
    const ImuKind imu_before = imu;
    visitor.enumeration(
        "imu",
        imu,
        kImuNames,
        "model of the IMU; used if the rig has an IMU; imu_noise sets the errors of the IMU");
    if (imu != imu_before) imu_noise = imu_noise_of(imu);
    visitor.enumeration("profile",
                        profile,
                        kCameraProfileNames,
                        "errors of a real camera that are added to the simulated camera");
    visitor.number("noise", noise, 0.0, 20.0, "factor on the noise of images and depths");
    visitor.number("contrast", contrast, 0.0, 2.0, "factor on the contrast of every material");
    const DepthCameraKind depth_camera_before = depth_camera;
    visitor.enumeration(
        "depth_camera",
        depth_camera,
        kDepthCameraNames,
        "model of the depth camera; sets the defaults of depth_errors, and the lens if the rig has "
        "a right camera");
    if (depth_camera != depth_camera_before)
        depth_errors = depth_camera_preset(depth_camera).config;
    visitor.group("imaging", camera.imaging);
    visitor.group("optics", camera.optics);
    visitor.group("shutter", camera.shutter);
    visitor.group("exposure", camera.exposure);
    visitor.group("calibration_error", calibration_error);
    visitor.group("faults", faults);
    visitor.group("knock", knock);
    visitor.group("imu_noise", imu_noise);
    visitor.group("depth_errors", depth_errors);
    visitor.group("machine_drift", machine_drift);
    visitor.begin_group("analytic");
    analytic.describe(visitor);
    visitor.group("drift", drift);
    visitor.end_group();
}

Result<std::unique_ptr<SceneSource>> open_scene(const SceneOptions& options, Executor* executor) {
    if (auto error = problem(options)) return *std::move(error);
    auto script = make_scene(options.scene, options.seed, motion_model_of(options.motion_model));
    if (!script) return script.error();
    auto rig =
        options.rig ? Result<camera::StereoRig>(*options.rig) : rig_preset(options.rig_preset);
    if (!rig) return rig.error();
    rig->rate_hz = options.rate_hz;
    if (options.imu == ImuKind::none) rig->imu.reset();
    if (const auto wrong = rig->problem()) return usage_error("simulator: rig: " + *wrong);

    std::unique_ptr<SceneSource> source(new SceneSource);
    source->executor_ = executor != nullptr ? executor : &source->serial_;
    source->motion_ = script->motion;
    source->truth_.scene = std::move(script->scene);
    source->rate_hz_ = options.rate_hz;
    if (options.commanded) {
        if (auto made = source->let_command(options, script->script); !made) return made.error();
        script->steps.clear();
        script->stops.clear();
    } else {
        auto trajectory = sampled(*script->motion, options.frames, options.rate_hz);
        if (!trajectory) return trajectory.error();
        source->truth_.trajectory = *std::move(trajectory);
    }
    source->walker_ = source->motion_;
    if (!options.knock.none()) {
        source->motion_ = std::make_shared<KnockedMotion>(
            source->motion_, options.knock, rig->body_from_left().translation_m);
    }
    source->truth_.scene.scale_contrast(options.contrast * figures_of(options.profile).contrast);
    source->truth_.steps = std::move(script->steps);
    source->truth_.stops = std::move(script->stops);
    source->truth_.start_ns = kStart_ns;
    if (auto made = source->make_sensor(options, *rig); !made) return made.error();
    if (options.known_motion || source->analytic_) {
        source->odometry_.emplace(options.drift,
                                  source->truth_.rig.body_from_left(),
                                  mix_seed(options.seed, kDriftStream));
    }
    if (options.machine_motion) {
        source->machine_.emplace(options.machine_drift,
                                 source->truth_.rig.body_from_left(),
                                 mix_seed(options.seed, kMachineStream));
    }
    if (rig->imu) {
        source->imu_.emplace(source->motion_,
                             *rig->imu,
                             options.imu_noise,
                             kStart_ns,
                             mix_seed(options.seed, kImuStream));
    }
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
    source->frames_stand_alone_ = options.sensor != Sensor::analytic &&
                                  !options.camera.exposure.automatic &&
                                  !needs_images(options.faults);
    source->imu_until_ns_ = kStart_ns - kImuLead_ns;
    source->info_ = {
        "sim",
        options.scene,
        options.commanded ? std::nullopt : std::optional<int>(frames - static_cast<int>(dropped)),
        source->imu_.has_value(),
        source->analytic_.has_value(),
        source->odometry_.has_value()};
    if (options.known_motion) {
        source->info_.T_odom_first_body = source->truth_.trajectory.front().T_world_body;
    }
    return source;
}

Status SceneSource::let_command(const SceneOptions& options, const MotionScript& script) {
    constexpr std::uint64_t kCommandStream = 0x636f6d6d;
    const Waypoint& first = script.waypoints.front();
    auto motion = CommandedMotion::make({first.x_m, first.y_m, first.yaw_rad},
                                        ground_of(truth_.scene),
                                        {},
                                        mix_seed(options.seed, kCommandStream));
    if (!motion) return motion.error();
    commanded_ = *motion;
    motion_ = commanded_;
    frame_limit_ = options.frames > 0 ? static_cast<std::size_t>(options.frames) : kMaxFrames;
    truth_.trajectory = {pose_of_frame(*commanded_, 0, rate_hz_)};
    return {};
}

double SceneSource::now_s() const noexcept {
    // The time is half a frame after the last stamp. Exposures and rolling shutters end earlier.
    const double frames = next_pose_ == 0 ? 0.0 : static_cast<double>(next_pose_) - 0.5;
    return frames / rate_hz_;
}

std::optional<RexJoints> SceneSource::rex_joints(std::int64_t time_ns) const {
    return walker_->rex_joints(seconds_from_ns(time_ns - kStart_ns));
}

/// Returns true if another frame follows. For a commanded source it also sets the pose of this
/// frame.
bool SceneSource::has_next() {
    if (!commanded_) return next_pose_ < truth_.trajectory.size();
    if (next_pose_ == frame_limit_) return false;
    truth_.trajectory.back() = pose_of_frame(*commanded_, static_cast<int>(next_pose_), rate_hz_);
    return true;
}

/// Makes the sensor, and sets `truth_.rig` to the nominal rig of the frames.
Status SceneSource::make_sensor(const SceneOptions& options, const camera::StereoRig& rig) {
    switch (options.sensor) {
        case Sensor::stereo: truth_.rig = rig; return make_renderer(options);
        case Sensor::depth_camera:
            truth_.rig = depth_rig(rig, options.depth_camera);
            if (auto made = make_renderer(options); !made) return made;
            return make_depth_camera(options);
        case Sensor::analytic: return make_analytic(options, rig);
    }
    return {};
}

Status SceneSource::make_renderer(const SceneOptions& options) {
    const bool is_pair = options.sensor == Sensor::stereo;
    const CalibrationError profile_error = figures_of(options.profile).calibration;
    CameraConfig camera = options.camera;
    apply_profile(options.profile, options.noise, camera);
    auto renderer = Renderer::make(
        truth_.scene,
        is_pair ? with_error(with_error(truth_.rig, profile_error), options.calibration_error)
                : as_pair(truth_.rig),
        camera,
        mix_seed(options.seed, kNoiseStream));
    if (!renderer) return renderer.error();
    renderer_.emplace(std::move(renderer).value());
    control_.emplace(options.camera.exposure, mix_seed(options.seed, kExposureStream));
    return {};
}

Status SceneSource::make_depth_camera(const SceneOptions& options) {
    auto camera = DepthCamera::make(truth_.scene,
                                    truth_.rig.left,
                                    options.depth_errors.with_noise(options.noise),
                                    mix_seed(options.seed, kDepthStream));
    if (!camera) return camera.error();
    depth_camera_.emplace(std::move(camera).value());
    return {};
}

Status SceneSource::make_analytic(const SceneOptions& options, const camera::StereoRig& rig) {
    if (!rig.right) {
        return usage_error(
            fmt::format("simulator: rig '{}' has no right camera, but sim.sensor = analytic models "
                        "stereo matching; use a stereo rig",
                        rig.name));
    }
    if (needs_images(options.faults)) {
        return usage_error(
            "simulator: sim.sensor = analytic makes no images that could be torn, repeated or "
            "frozen; of sim.faults, set only drop_probability");
    }
    const auto rectifier = camera::Rectifier::make(rig);
    if (!rectifier) return rectifier.error();
    AnalyticStereoConfig config = options.analytic;
    config.sigma_px *= options.noise;
    auto stereo = AnalyticStereo::make(
        truth_.scene, rectifier->rig(), config, mix_seed(options.seed, kAnalyticStream));
    if (!stereo) return stereo.error();
    analytic_.emplace(std::move(stereo).value());
    truth_.rig = rectified_rig(rig, analytic_->rig());
    return {};
}

Pose SceneSource::carried_body(const StampedPose& now) const {
    return motion_->at(seconds_from_ns(now.time_ns - kStart_ns)).T_world_body;
}

/// Exposes both cameras at a stamp. The exposure control continues even if the images are lost.
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
    if (!depth_camera_) return;
    std::swap(older_depth_m_, measured_.depth_m);
    depth_camera_->render(carried_body(now) * truth_.rig.body_from_left(),
                          static_cast<int>(next_pose_),
                          *executor_,
                          measured_);
}

/// Applies a fault to the images of the last exposure.
void SceneSource::damage(const InjectedFault* fault) {
    const bool stale = fault != nullptr &&
                       (fault->kind == ImageFault::repeated || fault->kind == ImageFault::frozen);
    if (stale) return;
    shown_left_ = pair_.left;
    if (!depth_camera_) shown_right_ = pair_.right;
    shown_depth_m_ = measured_.depth_m;
    if (fault == nullptr || fault->kind != ImageFault::torn) return;
    tear(older_left_, fault->tear_row, shown_left_);
    tear(older_right_, fault->tear_row, shown_right_);
    tear(older_depth_m_, fault->tear_row, shown_depth_m_);
}

/// Returns the depth that the processing chain would compute from images. It renders no images.
DepthImage SceneSource::model_depth(const StampedPose& now) {
    DepthImage depth;
    const int frame = static_cast<int>(next_pose_);
    analytic_->measure(carried_body(now), frame, *executor_, view_, depth);
    const auto factor_px_m = static_cast<float>(analytic_->rig().depth_to_disparity_px_m());
    exact_depth_m_.resize(truth_.rig.left.width, truth_.rig.left.height);
    for (std::size_t i = 0; i < exact_depth_m_.size(); ++i)
        exact_depth_m_.data()[i] = factor_px_m / view_.disparity_px.data()[i];
    return depth;
}

bool SceneSource::use_known_images(KnownImages known) {
    if (!frames_stand_alone_) return false;
    known_images_ = std::move(known);
    return true;
}

Result<std::optional<StereoFrame>> SceneSource::next() {
    while (has_next()) {
        const StampedPose& now = truth_.trajectory[commanded_ ? 0 : next_pose_];
        const InjectedFault* fault = nullptr;
        if (next_fault_ < faults_.size() &&
            faults_[next_fault_].frame == static_cast<int>(next_pose_)) {
            fault = &faults_[next_fault_++];
        }
        const bool arrives = fault == nullptr || fault->kind != ImageFault::dropped;
        StereoFrame frame;
        frame.time_ns = now.time_ns;
        const bool known = arrives && known_images_ && known_images_(frame);
        if (known) {
            ++known_frames_;
        } else if (renderer_) {
            take_pictures(now);
            if (arrives) damage(fault);
            frame.left = shown_left_;
            frame.right = shown_right_;
            frame.depth_m = shown_depth_m_;
        } else if (arrives) {
            frame.known_depth = model_depth(now);
        }
        if (odometry_ && arrives) {
            frame.known_motion =
                odometry_->follow(now.time_ns, static_cast<int>(next_pose_), carried_body(now));
        }
        if (machine_ && arrives) {
            const MotionEstimate odometry =
                machine_->follow(now.time_ns, static_cast<int>(next_pose_), now.T_world_body);
            frame.machine_motion = {odometry.T_previous_body, odometry.relative_covariance};
        }
        ++next_pose_;
        if (!arrives) continue;
        frame.index = next_index_++;
        if (imu_) frame.imu = imu_->samples(imu_until_ns_, now.time_ns);
        imu_until_ns_ = now.time_ns;
        return std::optional<StereoFrame>{std::move(frame)};
    }
    return std::optional<StereoFrame>{};
}

}  // namespace surefoot::sim
