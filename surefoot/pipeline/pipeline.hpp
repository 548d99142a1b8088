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

/// Clock for stage times [ns]; the library has no own clock. Null leaves the times at zero.
using Clock = std::int64_t (*)();

/// Turns stereo frames into a rated map of the ground; one frame is one call of `process`. Frames
/// that bring depth or motion with them (`known_depth`, on a rectified rig, `known_motion`) keep
/// them. Frames with a repeated or torn image (camera::FrameIntegrityCheck) are only reported: the
/// odometry would mistake a frozen picture for a machine at rest. Then the snapshot keeps the
/// stamps of the last good frame, so that the gate notices its age. After several bad frames in a
/// row, it also names the problem of the camera.
///
/// Frames too bright or too dark get odometry only; several in a row are reported in the same way.
/// A frame whose depth updates no map cell leaves the stamp of the last frame that did.
///
/// Order of calls: `make`, then `align` with the first frames (start.hpp says which). If it finds
/// no ground, `align` may be called with later frames. Then `process` for every frame in time
/// order, the aligned frames included. One thread at a time.
class Pipeline {
  public:
    /// Fails with the first problem of the rig or the configuration.
    [[nodiscard]] static Result<Pipeline> make(const PipelineConfig& config,
                                               const camera::StereoRig& rig,
                                               Executor& executor,
                                               Clock clock = nullptr);

    /// Largest number of frames that `align` uses; callers buffer no more.
    static constexpr std::size_t kAlignmentFrames = 10;

    /// Corrects the right eye's calibration by the rows of the first frames (pair_trim.hpp), finds
    /// gravity and the ground in them and places odom (alignment.hpp). `rig()` is final afterwards.
    /// `T_odom_first_body`: where the first frame was taken, for a source that knows; odom is then
    /// placed by it alone.
    const Alignment& align(std::span<const StereoFrame> first_frames,
                           const std::optional<Pose>& T_odom_first_body = {});

    /// The whole frame: motion, and with Work::full depth, map and rating.
    FrameReport process(const StereoFrame& frame, Work work);

    [[nodiscard]] const PipelineConfig& config() const noexcept { return config_; }
    [[nodiscard]] const camera::RectifiedRig& rig() const noexcept { return rectifier_->rig(); }
    [[nodiscard]] const Alignment& alignment() const noexcept { return alignment_; }
    /// True if neither the rig nor the settings state the mounting of the camera.
    [[nodiscard]] bool is_mount_unknown() const;
    /// The applied correction; empty if no significant error of the calibration was found.
    [[nodiscard]] const std::optional<stereo::RigSelfCalibration>& self_calibration()
        const noexcept {
        return self_calibration_;
    }
    [[nodiscard]] const elevation::ElevationMap& map() const noexcept { return map_; }
    [[nodiscard]] const traversability::TraversabilityLayers& rating() const noexcept {
        return rating_;
    }
    /// What is rated and to be shown: the highest surface of each cell in odom, somebody who
    /// stepped onto mapped ground included (`ElevationMap::surface`). Allocates.
    [[nodiscard]] grid::Layer surface_m() const;
    /// Edges, drops and stairs, tracked over time, as of the last full frame.
    [[nodiscard]] const stairs::TerrainFeatures& features() const noexcept { return features_; }
    /// Upright planes that are suspected to be mirrors or glass, in odom. The map knows what is
    /// seen in them; the snapshot hides it from the gate.
    [[nodiscard]] std::span<const specular::SuspectedPane> panes() const noexcept {
        return mirror_watch_.panes();
    }
    /// View of the camera at the last frame.
    [[nodiscard]] stairs::View view() const;
    /// Rectified pair (empty without images) and depth of the last full frame.
    [[nodiscard]] const camera::RectifiedPair& pair() const noexcept { return pair_; }
    [[nodiscard]] const DepthImage& depth() const noexcept { return depth_; }

    /// base_link at the last frame.
    [[nodiscard]] const Pose& T_odom_body() const noexcept { return last_motion_.T_odom_body; }
    /// Ground that the machine can reach from its stance, see Reachability. Allocates.
    [[nodiscard]] grid::Layer reach_step_m() const;
    /// Ground class of each cell of the map, from the features. Allocates.
    [[nodiscard]] stairs::GroundClasses ground_classes() const;
    /// Present footholds. Allocates and takes milliseconds: do not call it for every frame.
    [[nodiscard]] Image<traversability::Foothold> footholds() const;

    /// Writes the gate's input, as of the last frame. After an error, `out` is not intact.
    [[nodiscard]] Status snapshot(std::uint64_t config_hash, grid::MapSnapshot& out) const;

  private:
    Pipeline(const PipelineConfig& config,
             const camera::StereoRig& rig,
             std::unique_ptr<camera::Rectifier> rectifier,
             Executor& executor,
             Clock clock);

    [[nodiscard]] Alignment measure_alignment(std::span<const StereoFrame> first_frames);
    /// Returns false without changes if the rig cannot be rectified.
    bool see_with(const camera::StereoRig& rig);
    void correct_right_camera(std::span<const StereoFrame> frames);
    [[nodiscard]] std::vector<stereo::CornerShift> corners_of(std::span<const StereoFrame> frames);
    /// The frame's own motion, or the odometry's estimate; `T_odom_first`: the first base_link.
    [[nodiscard]] MotionEstimate track(const StereoFrame& frame,
                                       odometry::Odometry& odometry,
                                       const Pose& T_odom_first);
    /// Tests the frame and decides how much work it can get.
    [[nodiscard]] FrameReport check(const StereoFrame& frame, Work wanted);
    /// Report of a repeated or torn frame: the map and the ratings stay.
    [[nodiscard]] FrameReport skip(const StereoFrame& frame, FrameReport report);
    /// Motion up to this frame. The map window and its remembered cells move with it.
    MotionEstimate move(const StereoFrame& frame);
    /// The result is kept until the next call; empty if the frame brings its own depth.
    const camera::RectifiedPair& rectify(const StereoFrame& frame);
    /// The result is kept until the next call.
    const DepthImage& measure_depth(const StereoFrame& frame, const camera::RectifiedPair& pair);
    [[nodiscard]] ground::GroundSighting observe_ground(const DepthImage& depth,
                                                        const Pose& T_level_body,
                                                        const Eigen::Vector3d& up_level);
    /// Finds the ground without a hint of how the camera is mounted.
    [[nodiscard]] ground::GroundSighting search_ground(const DepthImage& depth);
    /// Passes the plane to the tilt drift correction and, if a machine carries the camera and the
    /// height of base_link is known, to the mount monitor.
    void watch_mount(const MotionEstimate& motion, const GroundObservation& ground_body);
    [[nodiscard]] CameraState camera_state() const noexcept;
    /// Compares the floor with its own mirror images, where a level floor is in view.
    void watch_mirrors(const camera::RectifiedPair& pair,
                       const DepthImage& depth,
                       const MotionEstimate& motion,
                       const GroundObservation& ground_body);
    void hide_mirrored_ground();
    [[nodiscard]] FusionCounts fuse(const DepthImage& depth, const MotionEstimate& motion);
    void rate();
    [[nodiscard]] stairs::Terrain terrain(const DepthImage& depth,
                                          const MotionEstimate& motion) const;
    void find_features(const DepthImage& depth, const MotionEstimate& motion);

    PipelineConfig config_;
    Executor* executor_;
    Clock clock_;
    camera::StereoRig nominal_rig_;
    std::optional<stereo::RigSelfCalibration> self_calibration_;
    std::unique_ptr<camera::Rectifier> rectifier_;  // the odometry refers to it: address must stay
    camera::FrameIntegrityCheck watch_;
    odometry::Odometry odometry_;
    std::unique_ptr<stereo::Matcher> matcher_;
    elevation::ElevationMap map_;
    specular::MirrorWatch mirror_watch_;
    Image<std::uint8_t> hidden_;  ///< cells of the map at and behind a suspected pane; may be empty
    traversability::Traversability rater_;
    grid::Layer surface_m_;  ///< surface of the map at the last rating
    traversability::TraversabilityLayers rating_;
    stairs::FeatureFinder feature_finder_;
    stairs::FeatureTracker feature_tracker_;
    stairs::TerrainFeatures found_features_;  ///< features of the last observation only
    stairs::TerrainFeatures features_;
    stairs::Drift feature_drift_;                           ///< body drift since `found_features_`
    Eigen::Vector2d rated_at_m_ = Eigen::Vector2d::Zero();  ///< corner of the window rated last
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
    std::uint64_t version_ = 0;  ///< counts fused frames
};

}  // namespace surefoot::pipeline
