// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/camera/frame_integrity_check.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/depth_image.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/elevation/elevation_map.hpp"
#include "surefoot/grid/map_snapshot.hpp"
#include "surefoot/ground/ground_observation.hpp"
#include "surefoot/ground/sample_points.hpp"
#include "surefoot/odometry/odometry.hpp"
#include "surefoot/pipeline/alignment.hpp"
#include "surefoot/pipeline/camera_monitor.hpp"
#include "surefoot/pipeline/fine_depth.hpp"
#include "surefoot/pipeline/mount_monitor.hpp"
#include "surefoot/pipeline/pipeline_config.hpp"
#include "surefoot/pipeline/tilt_drift_correction.hpp"
#include "surefoot/specular/mirror_watch.hpp"
#include "surefoot/stairs/classes/ground_classes.hpp"
#include "surefoot/stairs/feature_finder.hpp"
#include "surefoot/stairs/tracking/feature_tracker.hpp"
#include "surefoot/stereo/matcher.hpp"
#include "surefoot/stereo/rig_self_calibration.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::pipeline {

/// Clock for stage times [ns]; the pipeline has no clock of its own. Null leaves the times at 0.
using Clock = std::int64_t (*)();

/// Turns stereo frames into a rated map of the ground; one frame is one call of `process`. If a
/// frame has `known_depth` (for the rectified rig) or `known_motion`, it is not measured. Frames
/// with a repeated or torn image (camera::FrameIntegrityCheck) are only reported: the odometry
/// would read a frozen picture as a machine at rest. Then the snapshot keeps the stamps of the last
/// good frame, so that the gate notices the age. After several bad frames in a row, the snapshot
/// also names the problem of the camera.
///
/// `align` uses the full images. Then large images are made smaller (FineConfig::scale): odometry,
/// depth and all results refer to the smaller images (`rig()`). The map also takes depth of the
/// full images, in the fine region. Images that come with depth are not made smaller. Either all
/// frames carry depth (RGB-D, `known_depth`), or none.
///
/// Frames too bright or too dark get odometry only; several in a row are reported in the same way.
/// If a frame measures less than 0.01 m^2 of the map, the snapshot keeps the older stamp.
///
/// Order of calls: first `make`, then `align` with the first frames (start.hpp says which). If
/// `align` finds no ground, it may be called with later frames. Then call `process` for every frame
/// in time order, including the aligned frames. Use one thread at a time.
class Pipeline {
  public:
    /// Returns the first problem of the rig or the configuration as an error.
    [[nodiscard]] static Result<Pipeline> make(const PipelineConfig& config,
                                               const camera::StereoRig& rig,
                                               Executor& executor,
                                               Clock clock = nullptr);

    /// Largest number of frames that `align` uses; callers need not buffer more.
    static constexpr std::size_t kAlignmentFrames = 10;

    /// Corrects the right camera's calibration by the rows of the first frames, finds gravity and
    /// the ground in them and places odom (alignment.hpp). `rig()` is final after the last `align`.
    /// `T_odom_first_body`: pose of the first frame, if the source knows it; only this pose then
    /// places odom.
    const Alignment& align(std::span<const StereoFrame> first_frames,
                           const std::optional<Pose>& T_odom_first_body = {});

    /// Processes a whole frame: motion, and with Work::full also depth, map, rating and features.
    FrameReport process(const StereoFrame& frame, Work work);

    [[nodiscard]] const PipelineConfig& config() const noexcept { return config_; }
    [[nodiscard]] const camera::RectifiedRig& rig() const noexcept { return rectifier_->rig(); }
    /// Size of the images divided by the size of `rig()` after `align`, see FineConfig::scale.
    [[nodiscard]] int scale() const noexcept { return scale_; }
    [[nodiscard]] const Alignment& alignment() const noexcept { return alignment_; }
    /// True if neither the rig nor the settings state the mounting of the camera.
    [[nodiscard]] bool is_mount_unknown() const;
    /// Returns the correction; empty if no significant error of the calibration was found.
    [[nodiscard]] const std::optional<stereo::RigSelfCalibration>& self_calibration()
        const noexcept {
        return self_calibration_;
    }
    [[nodiscard]] const elevation::ElevationMap& map() const noexcept { return map_; }
    [[nodiscard]] const traversability::TraversabilityLayers& rating() const noexcept {
        return rating_;
    }
    /// Returns the surface of each cell in odom, to rate and to show: its height, or the top of a
    /// person who stepped onto mapped ground (`ElevationMap::surface`). Allocates.
    [[nodiscard]] grid::Layer surface_m() const;
    /// Returns edges, drops and stairs, tracked over time, as of the last full frame.
    [[nodiscard]] const stairs::TerrainFeatures& features() const noexcept { return features_; }
    /// Returns upright planes that are suspected to be mirrors or glass, in odom. The map keeps the
    /// surfaces that are seen in them; the snapshot hides these surfaces from the gate.
    [[nodiscard]] std::span<const specular::SuspectedPane> panes() const noexcept {
        return mirror_watch_.panes();
    }
    /// Returns the view of the camera at the last frame.
    [[nodiscard]] stairs::View view() const;
    /// Return the rectified pair (empty without images) and depth of the last full frame.
    [[nodiscard]] const camera::RectifiedPair& pair() const noexcept { return pair_; }
    [[nodiscard]] const DepthImage& depth() const noexcept { return depth_; }

    /// Returns the pose of base_link at the last frame.
    [[nodiscard]] const Pose& T_odom_body() const noexcept { return last_motion_.T_odom_body; }
    /// Returns reach_step_m of each cell: largest step on the way to it (Reachability). Allocates.
    [[nodiscard]] grid::Layer reach_step_m() const;
    /// Returns the ground class of each cell of the map, from the features. Allocates.
    [[nodiscard]] stairs::GroundClasses ground_classes() const;
    /// Returns the present footholds. Allocates and takes milliseconds: not for every frame.
    [[nodiscard]] Image<traversability::Foothold> footholds() const;

    /// Writes the gate's input, as of the last frame. After an error, do not use `out`.
    [[nodiscard]] Status snapshot(std::uint64_t config_hash, grid::MapSnapshot& out) const;

  private:
    Pipeline(const PipelineConfig& config,
             const camera::StereoRig& rig,
             std::unique_ptr<camera::Rectifier> rectifier,
             Executor& executor,
             Clock clock);

    [[nodiscard]] Alignment measure_alignment(std::span<const StereoFrame> first_frames);
    /// Changes to another rig and to the full size. Returns false without changes if the rig cannot
    /// be rectified.
    bool see_with(const camera::StereoRig& rig);
    /// Changes from the full to the coarse size.
    void see_coarsely();
    /// Returns the frame that odometry and coarse depth use. It is kept until the next call.
    const StereoFrame& coarse(const StereoFrame& frame);
    void correct_right_camera(std::span<const StereoFrame> frames);
    [[nodiscard]] std::vector<stereo::CornerShift> corners_of(std::span<const StereoFrame> frames);
    /// Returns the frame's `known_motion`, moved to the start `T_odom_first`, or the odometry's.
    [[nodiscard]] MotionEstimate track(const StereoFrame& frame,
                                       odometry::Odometry& odometry,
                                       const Pose& T_odom_first);
    /// Tests the frame and selects the work that is done for it (FrameReport::work).
    [[nodiscard]] FrameReport check(const StereoFrame& frame, Work wanted);
    /// Returns the report of a repeated or torn frame. The map and the ratings stay.
    [[nodiscard]] FrameReport skip(const StereoFrame& frame, FrameReport report);
    /// Returns the motion up to this frame. Moves the map window and its remembered cells.
    MotionEstimate move(const StereoFrame& frame);
    /// Rectifies the images. The result is kept until the next call; empty if depth is given.
    const camera::RectifiedPair& rectify(const StereoFrame& frame);
    /// Measures the depth image. The result is kept until the next call.
    const DepthImage& measure_depth(const StereoFrame& frame, const camera::RectifiedPair& pair);
    [[nodiscard]] ground::GroundSighting observe_ground(const DepthImage& depth,
                                                        const Pose& T_level_body,
                                                        const Eigen::Vector3d& up_level);
    /// Finds the ground if the mounting of the camera is unknown.
    [[nodiscard]] ground::GroundSighting search_ground(const DepthImage& depth);
    /// Passes the plane to the tilt drift correction. Also passes it to the mount monitor if the
    /// settings give the height of base_link over its ground.
    void watch_mount(const MotionEstimate& motion, const GroundObservation& ground_body);
    [[nodiscard]] CameraState camera_state() const noexcept;
    /// Compares the floor with its own mirror images, if a level floor is in view.
    void watch_mirrors(const camera::RectifiedPair& pair,
                       const DepthImage& depth,
                       const MotionEstimate& motion,
                       const GroundObservation& ground_body);
    void hide_mirrored_ground();
    /// Matches the fine region of the frame at full size, if it is time. Returns true if it did.
    bool measure_fine_depth(const StereoFrame& frame, const MotionEstimate& motion);
    /// Adds the depth image, and the fine depth if `with_fine`, to the map.
    [[nodiscard]] FusionCounts fuse(const DepthImage& depth,
                                    bool with_fine,
                                    const MotionEstimate& motion);
    void rate();
    [[nodiscard]] stairs::Terrain terrain(const DepthImage& depth,
                                          const MotionEstimate& motion) const;
    void find_features(const DepthImage& depth, const MotionEstimate& motion);

    PipelineConfig config_;
    Executor* executor_;
    Clock clock_;
    camera::StereoRig nominal_rig_;
    camera::StereoRig corrected_rig_;  ///< by the online rig self-calibration
    int scale_;                        ///< full size / coarse size
    std::optional<stereo::RigSelfCalibration> self_calibration_;
    std::unique_ptr<camera::Rectifier> rectifier_;  // address stays: the odometry refers to it
    camera::FrameIntegrityCheck watch_;
    odometry::Odometry odometry_;
    std::unique_ptr<stereo::Matcher> matcher_;
    StereoFrame coarse_frame_;
    std::optional<FineDepth> fine_;  ///< empty at full size: if `scale_` is 1, and in `align`
    FineSchedule fine_schedule_;
    elevation::ElevationMap map_;
    specular::MirrorWatch mirror_watch_;
    Image<std::uint8_t> hidden_;  ///< map cells at or behind a suspected pane; may be empty
    traversability::Traversability rater_;
    grid::Layer surface_m_;  ///< surface of the map at the last rating
    traversability::TraversabilityLayers rating_;
    stairs::FeatureFinder feature_finder_;
    stairs::FeatureTracker feature_tracker_;
    stairs::TerrainFeatures found_features_;  ///< features of the last observation
    stairs::TerrainFeatures features_;
    stairs::Drift feature_drift_;  ///< drift of the body since `found_features_`
    Eigen::Vector2d rated_at_m_ = Eigen::Vector2d::Zero();  ///< corner of the last rated window
    Alignment alignment_;

    std::optional<camera::ImuMount> imu_mount_;
    camera::RectifiedPair pair_;
    DepthImage depth_;
    ground::FramePoints ground_points_;
    MotionEstimate last_motion_;
    CameraMonitor camera_monitor_;
    MountMonitor mount_monitor_;
    TiltDriftCorrection tilt_drift_correction_;
    std::int64_t last_fused_ns_ = 0;
    std::uint64_t version_ = 0;  ///< number of fused frames that measured enough ground
};

}  // namespace surefoot::pipeline
