// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "sim/calibration_error.hpp"
#include "sim/camera_profile.hpp"
#include "sim/image_faults.hpp"
#include "sim/imu.hpp"
#include "sim/renderer.hpp"
#include "sim/truth.hpp"
#include "surefoot/camera/frame_source.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::sim {

struct SceneOptions {
    std::string scene = "demo_stairs";
    std::string rig_preset = "zed_vga";    ///< ignored if `rig` is set
    std::optional<camera::StereoRig> rig;  ///< any stereo rig; T_body_left as it says
    std::uint64_t seed = 1;                ///< textures, noise, centimetres of the path
    int frames = 0;                        ///< 0 = to the end of the path
    double rate_hz = 10.0;
    bool imu = true;                               ///< samples, where the rig has an IMU
    CameraProfile profile = CameraProfile::ideal;  ///< added to the camera below
    double noise = 1.0;                  ///< factor on every noise amplitude of the images
    CameraConfig camera;                 ///< groups imaging, optics, shutter, exposure
    double contrast = 1.0;               ///< factor on the contrast of every material
    CalibrationError calibration_error;  ///< of the images; `rig()` stays what it was
    ImageFaultConfig faults;
    ImuNoiseConfig imu_noise;

    /// The numbers that a configuration file may set.
    void describe(ConfigVisitor& visitor);
};

/// A simulated recording: stereo frames with IMU samples, and the truth about them. Stamps start at
/// 1 s; IMU samples begin 0.1 s before the first frame, while the trolley still stands. Inertial
/// samples of a dropped frame come with the next one that arrives.
class SceneSource final : public camera::FrameSource {
  public:
    SceneSource(const SceneSource&) = delete;  // the renderer points into the truth
    SceneSource& operator=(const SceneSource&) = delete;

    [[nodiscard]] const camera::StereoRig& rig() const override { return truth_.rig; }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override;

    /// Poses of all frames, also of those that are still to come, and the scene.
    [[nodiscard]] const SceneTruth& truth() const noexcept { return truth_; }
    /// What was injected into the whole recording. `InjectedFault::frame` counts the poses of
    /// `truth().trajectory`; a dropped one has no StereoFrame, so indices of frames stay behind.
    [[nodiscard]] const std::vector<InjectedFault>& faults() const noexcept { return faults_; }
    /// How the last frame was exposed.
    [[nodiscard]] const Shot& last_shot() const noexcept { return shot_; }
    /// Depth of the raw left camera at the last frame, exact, NaN where no surface is. Also when
    /// the images are older: what they should have shown.
    [[nodiscard]] const Image<float>& last_depth_m() const noexcept { return pair_.depth_m; }

  private:
    friend Result<std::unique_ptr<SceneSource>> open_scene(const SceneOptions&, Executor*);
    SceneSource() = default;

    void take_pictures(const StampedPose& now);
    void damage(const InjectedFault* fault);

    camera::SourceInfo info_;
    SceneTruth truth_;
    std::shared_ptr<const Motion> motion_;
    std::optional<Renderer> renderer_;
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
    std::size_t next_pose_ = 0;
    std::size_t next_fault_ = 0;
    int next_index_ = 0;
    std::int64_t imu_until_ns_ = 0;
};

/// Usage errors: unknown scene or rig preset (the names are listed), a rig that cannot be used, a
/// number out of range. `executor` renders rows in parallel and must outlive the source; without
/// one the calling thread does.
[[nodiscard]] Result<std::unique_ptr<SceneSource>> open_scene(const SceneOptions& options,
                                                              Executor* executor = nullptr);

}  // namespace surefoot::sim
