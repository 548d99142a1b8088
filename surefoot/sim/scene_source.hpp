// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "surefoot/camera/frame_source.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/sim/motion/commanded_motion.hpp"
#include "surefoot/sim/rendering/image_faults.hpp"
#include "surefoot/sim/rendering/renderer.hpp"
#include "surefoot/sim/scenes/truth.hpp"
#include "surefoot/sim/sensors/analytic_stereo.hpp"
#include "surefoot/sim/sensors/calibration_error.hpp"
#include "surefoot/sim/sensors/camera_profile.hpp"
#include "surefoot/sim/sensors/depth_camera.hpp"
#include "surefoot/sim/sensors/imu.hpp"
#include "surefoot/sim/sensors/knock.hpp"
#include "surefoot/sim/sensors/modelled_odometry.hpp"

namespace surefoot::sim {

/// What looks at the scene.
enum class Sensor : std::uint8_t {
    stereo,        ///< two images
    depth_camera,  ///< one image and its depth (RGB-D); both through one lens
    analytic,      ///< no image: depth as a matcher would say it, motion as odometry would
};
inline constexpr const char* kSensorNames[] = {"stereo", "depth_camera", "analytic"};

/// What carries the camera along the scene's way: what the scene says, or another carrier.
enum class CarriedBy : std::uint8_t { scene, trolley, rex, hand };
inline constexpr const char* kCarriedByNames[] = {"scene", "trolley", "rex", "hand"};
/// Nothing for `CarriedBy::scene`.
[[nodiscard]] std::optional<MotionModel> motion_model_of(CarriedBy carried_by);

struct SceneOptions {
    std::string scene = "demo_stairs";
    std::string rig_preset = "zed_vga";         ///< ignored if `rig` is set
    std::optional<camera::StereoRig> rig;       ///< any stereo rig; T_body_left as it says
    std::uint64_t seed = 1;                     ///< textures, noise, centimetres of the path
    CarriedBy motion_model = CarriedBy::scene;  ///< an error where it cannot go the scene's way
    /// A REX that stands where the scene's way begins, and goes where `SceneSource::commanded` is
    /// told to, instead of that way. It has no end but `frames`.
    bool commanded = false;
    int frames = 0;  ///< 0 = to the end of the path
    double rate_hz = 10.0;
    Sensor sensor = Sensor::stereo;
    ImuKind imu = ImuKind::consumer;               ///< samples, where the rig has an IMU
    CameraProfile profile = CameraProfile::ideal;  ///< added to the camera below
    double noise = 1.0;                  ///< factor on every noise amplitude of images and depths
    CameraConfig camera;                 ///< groups imaging, optics, shutter, exposure
    double contrast = 1.0;               ///< factor on the contrast of every material
    CalibrationError calibration_error;  ///< of the images; `rig()` stays what it was
    ImageFaultConfig faults;
    KnockConfig knock;  ///< the truth's poses are those of the machine, before and after
    ImuNoiseConfig imu_noise = imu_noise_of(imu);
    /// Also the lens, unless `rig` is one of RGB-D; where it sits is the place of the left eye.
    DepthCameraKind depth_camera = DepthCameraKind::kinect_v1;
    DepthCameraConfig depth_errors = depth_camera_preset(depth_camera).config;
    AnalyticStereoConfig analytic;
    /// The source tells where it starts, and frames bring their motion along: the true one with
    /// `drift`. It keeps odometry and ground alignment out of what is measured. The analytic sensor
    /// always brings motion.
    bool known_motion = false;
    DriftConfig drift;
    /// Frames bring what the machine says of its own motion: the true one with this error. The
    /// default is a guess at joints that are read to a few tenths of a degree.
    bool machine_motion = false;
    DriftConfig machine_drift = {.position_m_sqrt_m = 0.01, .turn_deg_sqrt_m = 0.5};

    /// The numbers that a configuration file may set. Choosing another IMU or depth camera replaces
    /// its figures; what is set later, or with it, stays on top.
    void describe(ConfigVisitor& visitor);
};

/// A simulated recording: frames of the sensor with IMU samples, and the truth about them. Stamps
/// start at 1 s; IMU samples begin 0.1 s before the first frame, while the trolley still stands.
/// Inertial samples of a dropped frame come with the next one that arrives.
class SceneSource final : public camera::FrameSource {
  public:
    SceneSource(const SceneSource&) = delete;  // the sensors point into the truth
    SceneSource& operator=(const SceneSource&) = delete;

    [[nodiscard]] const camera::StereoRig& rig() const override { return truth_.rig; }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override;

    /// Fills in the images of a frame whose stamp is set, or says false.
    using KnownImages = std::function<bool(StereoFrame& frame)>;
    /// Frames whose images `known` has from an earlier call with the same options are not rendered
    /// again. False, and they are, where an image depends on those before it: automatic exposure,
    /// faults that show older images. After such a frame `last_shot` and `last_depth_m` are those
    /// of the last one that was rendered.
    bool use_known_images(KnownImages known);
    /// How many were not rendered for that reason.
    [[nodiscard]] int known_frames() const noexcept { return known_frames_; }

    /// Who steers it, if it is to be steered. A step may begin at `now_s` or later.
    [[nodiscard]] const std::shared_ptr<CommandedMotion>& commanded() const noexcept {
        return commanded_;
    }
    /// Time of the motion from which on nothing was exposed yet.
    [[nodiscard]] double now_s() const noexcept;
    /// Of a REX at the time of a frame; nothing where something else carries the camera. A
    /// commanded motion has forgotten what it was told to forget.
    [[nodiscard]] std::optional<RexJoints> rex_joints(std::int64_t time_ns) const;
    /// Poses of all frames, also of those that are still to come, and the scene. Of a commanded
    /// source, which may run for hours, the pose of the last frame alone.
    [[nodiscard]] const SceneTruth& truth() const noexcept { return truth_; }
    /// What was injected into the whole recording. `InjectedFault::frame` counts the poses of
    /// `truth().trajectory`; a dropped one has no StereoFrame, so indices of frames stay behind.
    [[nodiscard]] const std::vector<InjectedFault>& faults() const noexcept { return faults_; }
    /// How the last frame was exposed (sensors with images).
    [[nodiscard]] const Shot& last_shot() const noexcept { return shot_; }
    /// Depth of the raw left camera at the last frame, exact, NaN where no surface is. Also when
    /// the images are older: what they should have shown.
    [[nodiscard]] const Image<float>& last_depth_m() const noexcept {
        return analytic_ ? exact_depth_m_ : pair_.depth_m;
    }

  private:
    friend Result<std::unique_ptr<SceneSource>> open_scene(const SceneOptions&, Executor*);
    SceneSource() = default;

    [[nodiscard]] Status let_command(const SceneOptions& options, const MotionScript& script);
    [[nodiscard]] bool has_next();
    [[nodiscard]] Status make_sensor(const SceneOptions& options, const camera::StereoRig& rig);
    [[nodiscard]] Status make_renderer(const SceneOptions& options);
    [[nodiscard]] Status make_depth_camera(const SceneOptions& options);
    [[nodiscard]] Status make_analytic(const SceneOptions& options, const camera::StereoRig& rig);
    /// base_link as the camera carries it: that of the machine until the camera is knocked.
    [[nodiscard]] Pose carried_body(const StampedPose& now) const;
    void take_pictures(const StampedPose& now);
    void damage(const InjectedFault* fault);
    [[nodiscard]] DepthImage model_depth(const StampedPose& now);

    camera::SourceInfo info_;
    SceneTruth truth_;
    std::shared_ptr<const Motion> motion_;  ///< of the camera
    std::shared_ptr<const Motion> walker_;  ///< of the machine: no blow on the camera moves it
    std::shared_ptr<CommandedMotion> commanded_;
    double rate_hz_ = 0.0;
    std::size_t frame_limit_ = 0;
    std::optional<Renderer> renderer_;         ///< both sensors with images
    std::optional<DepthCamera> depth_camera_;  ///< that sensor only
    std::optional<AnalyticStereo> analytic_;   ///< that sensor only
    std::optional<ModelledOdometry> odometry_;
    std::optional<ModelledOdometry> machine_;
    std::optional<ExposureControl> control_;
    std::optional<ImuModel> imu_;
    std::vector<InjectedFault> faults_;
    Serial serial_;
    Executor* executor_ = nullptr;
    CleanPair clean_;
    Shot shot_;
    RenderedPair pair_;     ///< of the last exposure, unharmed
    GreyImage older_left_;  ///< of the exposure before it
    GreyImage older_right_;
    GreyImage shown_left_;  ///< as delivered
    GreyImage shown_right_;
    DepthFrame measured_;  ///< of the last exposure
    Image<float> older_depth_m_;
    Image<float> shown_depth_m_;
    AnalyticStereo::View view_;
    Image<float> exact_depth_m_;
    std::size_t next_pose_ = 0;
    std::size_t next_fault_ = 0;
    int next_index_ = 0;
    KnownImages known_images_;
    int known_frames_ = 0;
    bool frames_stand_alone_ = false;
    std::int64_t imu_until_ns_ = 0;
};

/// Usage errors: unknown scene or rig preset (the names are listed), a rig that cannot be used, a
/// number out of range, image faults where no images are. `executor` renders rows in parallel and
/// must outlive the source; without one the calling thread does.
[[nodiscard]] Result<std::unique_ptr<SceneSource>> open_scene(const SceneOptions& options,
                                                              Executor* executor = nullptr);

}  // namespace surefoot::sim
