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

/// The sensor that records the scene.
enum class Sensor : std::uint8_t {
    stereo,        ///< two images
    depth_camera,  ///< one image and its depth (RGB-D); both through one lens
    analytic,      ///< no image: depth with a matcher's errors, motion with odometry's errors
};
inline constexpr const char* kSensorNames[] = {"stereo", "depth_camera", "analytic"};

/// Motion model of the camera: the model of the scene file, or a model that replaces it.
enum class MotionModelChoice : std::uint8_t { scene, trolley, rex, hand };
inline constexpr const char* kMotionModelChoiceNames[] = {"scene", "trolley", "rex", "hand"};
/// Returns the motion model; no value for `MotionModelChoice::scene`.
[[nodiscard]] std::optional<MotionModel> motion_model_of(MotionModelChoice carried_by);

struct SceneOptions {
    std::string scene = "demo_stairs";
    std::string rig_preset = "zed_vga";    ///< ignored if `rig` is set
    std::optional<camera::StereoRig> rig;  ///< used instead of `rig_preset`
    std::uint64_t seed = 1;                ///< seed of scene, path, noise and faults
    MotionModelChoice motion_model =
        MotionModelChoice::scene;  ///< must be able to follow the path of the scene
    /// A REX under live command: it stands at the start of the scene's path and takes its steps
    /// from `SceneSource::commanded`. The run ends only after `frames` (0: 1 000 000 frames).
    bool commanded = false;
    int frames = 0;  ///< number of frames; 0 = to the end of the path
    double rate_hz = 10.0;
    Sensor sensor = Sensor::stereo;
    ImuKind imu = ImuKind::consumer;               ///< model of the IMU; used if the rig has an IMU
    CameraProfile profile = CameraProfile::ideal;  ///< errors of a real camera, added to `camera`
    double noise = 1.0;                  ///< factor on every noise amplitude of images and depths
    CameraConfig camera;                 ///< settings of imaging, optics, shutter and exposure
    double contrast = 1.0;               ///< factor on the contrast of every material
    CalibrationError calibration_error;  ///< changes only the images; `rig()` stays nominal
    ImageFaultConfig faults;
    KnockConfig knock;  ///< the true poses are those of the machine, also after the knock
    ImuNoiseConfig imu_noise = imu_noise_of(imu);
    /// Gives the depth errors and the lens. A `rig` without a right camera keeps its own lens.
    DepthCameraKind depth_camera = DepthCameraKind::kinect_v1;
    DepthCameraConfig depth_errors = depth_camera_preset(depth_camera).config;
    AnalyticStereoConfig analytic;
    /// Frames carry known motion: the true motion with the errors of `drift`, and the source
    /// reports its start pose. This keeps errors of odometry and ground alignment out of a
    /// measurement. Frames of the analytic sensor always carry known motion.
    bool known_motion = false;
    DriftConfig drift;
    /// Frames carry the machine's motion estimate: the true motion with `machine_drift`. The
    /// default is a guess for joints that are read to a few tenths of a degree.
    bool machine_motion = false;
    DriftConfig machine_drift = {.position_m_sqrt_m = 0.01, .turn_deg_sqrt_m = 0.5};

    /// Describes the values that a configuration file can set. Choosing another IMU or depth camera
    /// replaces its values; values set in the same call or later override them.
    void describe(ConfigVisitor& visitor);
};

/// A simulated recording: sensor frames with IMU samples, and their ground truth. Stamps start at 1
/// s; IMU samples start 0.1 s before the first frame, while the camera still stands. IMU samples of
/// a dropped frame come with the next frame that arrives.
class SceneSource final : public camera::FrameSource {
  public:
    SceneSource(const SceneSource&) = delete;  // the sensors hold pointers into the truth
    SceneSource& operator=(const SceneSource&) = delete;

    [[nodiscard]] const camera::StereoRig& rig() const override { return truth_.rig; }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override;

    /// Fills in the images of a frame whose stamp is set; returns false if there are none.
    using KnownImages = std::function<bool(StereoFrame& frame)>;
    /// Skips rendering of frames whose images `known` has from a run with the same options. Returns
    /// false and skips no frame if the sensor is analytic, the exposure automatic, or a fault may
    /// show older images. After a skipped frame `last_shot` and `last_depth_m` still belong to the
    /// last rendered frame.
    bool use_known_images(KnownImages known);
    /// Number of frames that were not rendered because their images were known.
    [[nodiscard]] int known_frames() const noexcept { return known_frames_; }

    /// Live commands; null unless `SceneOptions::commanded`. A step may begin at `now_s` or later.
    [[nodiscard]] const std::shared_ptr<CommandedMotion>& commanded() const noexcept {
        return commanded_;
    }
    /// Motion time that no frame has exposed yet: last frame plus half a period; 0 without a frame.
    [[nodiscard]] double now_s() const noexcept;
    /// Joint angles of a REX at the time of a frame; no value for the other motion models. For
    /// forgotten steps of a commanded motion see CommandedMotion::forget_before.
    [[nodiscard]] std::optional<RexJoints> rex_joints(std::int64_t time_ns) const;
    /// The scene and the poses of all frames, future frames included. A commanded source can run
    /// for hours and keeps only the pose of the last frame.
    [[nodiscard]] const SceneTruth& truth() const noexcept { return truth_; }
    /// All faults of the recording. `InjectedFault::frame` counts poses of `truth().trajectory`;
    /// `StereoFrame::index` does not count dropped frames.
    [[nodiscard]] const std::vector<InjectedFault>& faults() const noexcept { return faults_; }
    /// Exposure of the last frame (sensors with images only).
    [[nodiscard]] const Shot& last_shot() const noexcept { return shot_; }
    /// Exact depth of the raw left camera at the last frame; NaN without a surface. If the images
    /// are older because of a fault, this is the depth that they should have shown.
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
    /// Pose of the base_link that is fixed to the camera. A knock turns it against the machine.
    [[nodiscard]] Pose carried_body(const StampedPose& now) const;
    void take_pictures(const StampedPose& now);
    void damage(const InjectedFault* fault);
    [[nodiscard]] DepthImage model_depth(const StampedPose& now);

    camera::SourceInfo info_;
    SceneTruth truth_;
    std::shared_ptr<const Motion> motion_;  ///< motion of the camera
    std::shared_ptr<const Motion> walker_;  ///< motion of the machine, which a knock does not move
    std::shared_ptr<CommandedMotion> commanded_;
    double rate_hz_ = 0.0;
    std::size_t frame_limit_ = 0;
    std::optional<Renderer> renderer_;         ///< used for the sensors stereo and depth_camera
    std::optional<DepthCamera> depth_camera_;  ///< used for the depth camera only
    std::optional<AnalyticStereo> analytic_;   ///< used for the analytic stereo sensor only
    std::optional<ModelledOdometry> odometry_;
    std::optional<ModelledOdometry> machine_;
    std::optional<ExposureControl> control_;
    std::optional<ImuModel> imu_;
    std::vector<InjectedFault> faults_;
    Serial serial_;
    Executor* executor_ = nullptr;
    CleanPair clean_;
    Shot shot_;
    RenderedPair pair_;     ///< images of the last exposure, without faults
    GreyImage older_left_;  ///< left image of the previous exposure
    GreyImage older_right_;
    GreyImage shown_left_;  ///< left image as delivered
    GreyImage shown_right_;
    DepthFrame measured_;  ///< depth frame of the last exposure
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

/// Returns a usage error for an unknown scene or rig preset, an unusable rig, a number out of
/// range, and faults other than dropped frames with the analytic sensor. `executor` renders rows in
/// parallel and must outlive the source; without an executor the calling thread renders.
[[nodiscard]] Result<std::unique_ptr<SceneSource>> open_scene(const SceneOptions& options,
                                                              Executor* executor = nullptr);

}  // namespace surefoot::sim
