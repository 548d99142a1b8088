// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/pipeline.hpp"

#include <algorithm>

#include "surefoot/camera/rig_scaling.hpp"
#include "surefoot/core/assert.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/grid/snapshot_builder.hpp"
#include "surefoot/ground/ground_search.hpp"
#include "surefoot/ground/sample_points.hpp"
#include "surefoot/odometry/health.hpp"
#include "surefoot/pipeline/exposure_state.hpp"
#include "surefoot/pipeline/rgbd_depth.hpp"
#include "surefoot/traversability/reachability.hpp"

namespace surefoot::pipeline {
namespace {

/// The second round removes errors that interpolated rows hide from the first round.
constexpr int kSelfCalibrationRounds = 2;
constexpr int kSelfCalibrationRows_px = 6;  ///< search range of rows [px]
constexpr std::uint64_t kGroundSeed = 1;    ///< equal points give equal planes

/// Measures the stages of one frame; without a clock all times are zero.
class StageTimer {
  public:
    StageTimer(Clock clock, FrameReport& report) : clock_(clock), report_(report) {
        start_ns_ = now();
    }
    void finished(Stage stage) {
        const std::int64_t end_ns = now();
        report_.stage_ms[static_cast<std::size_t>(stage)] =
            static_cast<double>(end_ns - start_ns_) * 1e-6;
        start_ns_ = end_ns;
    }

  private:
    [[nodiscard]] std::int64_t now() const { return clock_ ? clock_() : 0; }
    Clock clock_;
    FrameReport& report_;
    std::int64_t start_ns_ = 0;
};

/// Smallest measured area of the map that counts as an observation. A camera that works but shows
/// nothing useful still delivers frames (hazards H3 and H20). ASSUMPTION: a tenth of a sole. A wall
/// 0.5 m ahead that fills the view measures several times this area.
constexpr double kLeastMeasured_m2 = 0.01;

bool shows_ground(const FusionCounts& counts, double resolution_m) {
    return static_cast<double>(counts.cells_measured) * resolution_m * resolution_m >=
           kLeastMeasured_m2;
}

std::int64_t count_valid(const Image<float>& disparity_px) {
    return std::count_if(disparity_px.data(),
                         disparity_px.data() + disparity_px.size(),
                         [](float d) { return d > 0.0F; });
}

/// Returns the plane n . p + h = 0 of a later base_link in the axes of the first base_link.
ground::GroundSighting in_first_body(ground::GroundSighting ground, const Pose& T_first_body) {
    GroundObservation& plane = ground.observation;
    plane.normal = T_first_body.rotation * plane.normal;
    plane.height_m -= plane.normal.dot(T_first_body.translation_m);
    const Eigen::Matrix3d R = T_first_body.R();
    ground.uncertainty.normal_covariance = R * ground.uncertainty.normal_covariance * R.transpose();
    return ground;
}

Alignment known_alignment(const Pose& T_odom_body) {
    Alignment alignment;
    alignment.T_odom_body = T_odom_body;
    alignment.gravity_source = grid::GravitySource::plane;
    alignment.tilt_sigma_rad = 0.0;
    alignment.has_ground = true;
    alignment.ground_height_m = T_odom_body.translation_m.z();
    alignment.reason = "known from the source (not measured)";
    return alignment;
}

grid::SnapshotHealth snapshot_health(Health health) {
    switch (health) {
        case Health::ok: return grid::SnapshotHealth::ok;
        case Health::degraded: return grid::SnapshotHealth::degraded;
        case Health::lost: return grid::SnapshotHealth::lost;
    }
    return grid::SnapshotHealth::lost;
}

/// Only a stereo pair can be matched at two sizes.
int scale_of(const FineConfig& config, const camera::StereoRig& rig) {
    return rig.right ? fine_scale(config, rig.left.width, rig.left.height) : 1;
}

bool carries_depth(const StereoFrame& frame) {
    return frame.known_depth || frame.right.empty();
}

}  // namespace

Result<Pipeline> Pipeline::make(const PipelineConfig& config,
                                const camera::StereoRig& rig,
                                Executor& executor,
                                Clock clock) {
    if (const auto problem = config.problem()) return usage_error(*problem);
    auto rectifier = camera::Rectifier::make(rig, config.camera);
    if (!rectifier) return rectifier.error();
    if (rectifier->rig().width != rig.left.width || rectifier->rig().height != rig.left.height) {
        return usage_error(
            "camera.rectified_width_px, camera.rectified_height_px: odometry needs rectified "
            "images "
            "of the size of the raw images, so remove both settings. Only `depth` and "
            "`depth-accuracy` accept another size");
    }
    return Pipeline(config,
                    rig,
                    std::make_unique<camera::Rectifier>(std::move(rectifier).value()),
                    executor,
                    clock);
}

Pipeline::Pipeline(const PipelineConfig& config,
                   const camera::StereoRig& rig,
                   std::unique_ptr<camera::Rectifier> rectifier,
                   Executor& executor,
                   Clock clock)
    : config_(config),
      executor_(&executor),
      clock_(clock),
      nominal_rig_(rig),
      corrected_rig_(rig),
      scale_(scale_of(config.fine, rig)),
      rectifier_(std::move(rectifier)),
      odometry_(config.odometry, *rectifier_, rig.imu),
      matcher_(stereo::make_matcher(at_scale(config.stereo, scale_))),
      fine_schedule_(config.fine, config.elevation.viewpoint),
      map_(config.elevation),
      mirror_watch_(config.specular),
      rater_(config.traversability.widened_to(config.elevation.resolution_m)),
      feature_finder_(config.stairs),
      feature_tracker_(config.stairs),
      imu_mount_(rig.imu),
      mount_monitor_(config.mount),
      tilt_drift_correction_(config.level) {}

const Alignment& Pipeline::align(std::span<const StereoFrame> first_frames,
                                 const std::optional<Pose>& T_odom_first_body) {
    first_frames = first_frames.first(std::min(first_frames.size(), kAlignmentFrames));
    const bool with_depth = std::any_of(first_frames.begin(), first_frames.end(), carries_depth);
    scale_ = with_depth ? 1 : scale_of(config_.fine, nominal_rig_);
    fine_schedule_ = FineSchedule(config_.fine, config_.elevation.viewpoint);
    // Undoes the result of an earlier alignment.
    if (self_calibration_ || fine_) see_with(nominal_rig_);
    self_calibration_.reset();
    correct_right_camera(first_frames);
    alignment_ =
        T_odom_first_body ? known_alignment(*T_odom_first_body) : measure_alignment(first_frames);
    // Errors of the placement stay in the whole map, so it is measured at full size.
    if (scale_ > 1) see_coarsely();
    odometry_.start_at(alignment_.T_odom_body);
    tilt_drift_correction_.start_at(alignment_.T_odom_body, alignment_.ground_lean_rad);
    feature_tracker_.forget();  // odom is a new coordinate frame
    mirror_watch_.forget();
    last_motion_.T_odom_body = alignment_.T_odom_body;
    if (!first_frames.empty()) last_motion_.time_ns = first_frames.front().time_ns;
    return alignment_;
}

Alignment Pipeline::measure_alignment(std::span<const StereoFrame> first_frames) {
    const Pose T_body_imu = imu_mount_ ? imu_mount_->T_body_imu : Pose{};
    const auto up_imu = up_from_imu(config_.mount.gravity,
                                    config_.mount.still_gyro_rad_s,
                                    config_.mount.still_force_m_s2,
                                    T_body_imu,
                                    first_frames);
    const Eigen::Vector3d up_hint_body = up_imu ? up_imu->unit_body : assumed_up(config_.mount);
    GroundView look{!up_imu && is_mount_unknown(), config_.ground.search_down_deg, 0.0, {}};

    // A separate odometry brings all observations into the first body frame, because the machine
    // may already move.
    odometry::Odometry scout(config_.odometry, *rectifier_);
    scout.start_at(Pose{});
    ground::GroundConfig wanted = config_.ground;
    // If there are fewer than `min_agreeing` frames, all of them must agree.
    wanted.min_agreeing = std::clamp(static_cast<int>(first_frames.size()), 1, wanted.min_agreeing);
    ground::GroundCalibration calibration(wanted);
    for (const StereoFrame& frame : first_frames) {
        if (!frame.frame_status.is_new_and_whole() ||
            exposure_state_of(frame) != ExposureState::well_exposed)
            continue;
        const MotionEstimate motion = track(frame, scout, Pose{});
        const DepthImage& depth = measure_depth(frame, rectify(frame));
        const ground::GroundSighting sighting =
            look.searched ? search_ground(depth)
                          : observe_ground(depth, motion.T_odom_body, up_hint_body);
        calibration.add(in_first_body(sighting, motion.T_odom_body));
        if (sighting.image_share < look.image_share) continue;
        look.image_share = sighting.image_share;
        look.reason = sighting.reason;
    }
    return place_odom(
        config_.mount, calibration.alignment(), up_imu, config_.ground.expected_height_m, look);
}

bool Pipeline::is_mount_unknown() const {
    return !nominal_rig_.T_body_left && config_.mount.pitch_deg == 0.0 &&
           config_.ground.expected_height_m == 0.0;
}

std::vector<stereo::CornerShift> Pipeline::corners_of(std::span<const StereoFrame> frames) {
    std::vector<stereo::CornerShift> corners;
    // Uses a few frames far apart, because neighbouring frames show the same scene.
    const std::size_t step = std::max<std::size_t>(1, (frames.size() - 1) / 2);
    for (std::size_t i = 0; i < frames.size(); i += step) {
        const StereoFrame& frame = frames[std::min(i, frames.size() - 1)];
        if (carries_depth(frame) || !frame.frame_status.is_new_and_whole()) continue;
        rectify(frame);
        const auto found = stereo::match_corners(
            pair_.left.view(),
            pair_.right.view(),
            {at_scale(config_.stereo, scale_).disparities, kSelfCalibrationRows_px});
        corners.insert(corners.end(), found.matched.begin(), found.matched.end());
    }
    return corners;
}

bool Pipeline::see_with(const camera::StereoRig& rig) {
    auto rectifier = camera::Rectifier::make(rig, config_.camera);
    if (!rectifier) return false;
    corrected_rig_ = rig;
    rectifier_ = std::make_unique<camera::Rectifier>(std::move(rectifier).value());
    odometry_ = odometry::Odometry(config_.odometry, *rectifier_, imu_mount_);
    if (fine_) {
        fine_.reset();
        matcher_ = stereo::make_matcher(at_scale(config_.stereo, scale_));
    }
    return true;
}

void Pipeline::see_coarsely() {
    camera::RectificationConfig config = config_.camera;
    config.rectified_focal_px /= scale_;
    config.rectified_width_px = config.rectified_height_px = 0;  // the size of the smaller images
    auto coarse = camera::Rectifier::make(camera::shrunk(corrected_rig_, scale_), config);
    if (!coarse) {  // too small to be rectified
        scale_ = 1;
        return;
    }
    fine_.emplace(std::move(rectifier_), std::move(matcher_));
    pair_ = {};  // both have the full size
    depth_ = {};
    rectifier_ = std::make_unique<camera::Rectifier>(std::move(coarse).value());
    matcher_ = stereo::make_matcher(config_.stereo);
    odometry_ = odometry::Odometry(config_.odometry, *rectifier_, imu_mount_);
}

const StereoFrame& Pipeline::coarse(const StereoFrame& frame) {
    if (!fine_) return frame;
    SUREFOOT_ASSERT(!carries_depth(frame));
    coarse_frame_.time_ns = frame.time_ns;
    coarse_frame_.index = frame.index;
    coarse_frame_.imu = frame.imu;
    coarse_frame_.machine_motion = frame.machine_motion;
    coarse_frame_.known_motion = frame.known_motion;
    coarse_frame_.frame_status = frame.frame_status;
    camera::shrink(frame.left.view(), scale_, coarse_frame_.left);
    camera::shrink(frame.right.view(), scale_, coarse_frame_.right);
    return coarse_frame_;
}

void Pipeline::correct_right_camera(std::span<const StereoFrame> frames) {
    if (!config_.self_calibration.enabled || !nominal_rig_.right) return;
    for (int round = 0; round < kSelfCalibrationRounds; ++round) {
        auto found =
            stereo::estimate_self_calibration(config_.self_calibration, rig(), corners_of(frames));
        if (!found || !found->significant()) return;
        if (self_calibration_) {
            found->camera.roll_rad += self_calibration_->camera.roll_rad;
            found->camera.pitch_rad += self_calibration_->camera.pitch_rad;
            found->camera.focal_share += self_calibration_->camera.focal_share;
            found->row_error_px = self_calibration_->row_error_px;
        }
        if (!see_with(with_right_camera(nominal_rig_, found->camera))) return;
        self_calibration_ = found;
    }
}

FrameReport Pipeline::process(const StereoFrame& full_frame, Work work) {
    FrameReport report = check(full_frame, work);
    if (!report.frame_status.is_new_and_whole()) return skip(full_frame, std::move(report));
    StageTimer timer(clock_, report);
    const StereoFrame& frame = coarse(full_frame);

    const MotionEstimate motion = move(frame);
    report.motion = motion;
    timer.finished(Stage::odometry);
    if (report.work == Work::full) {
        const camera::RectifiedPair& pair = rectify(frame);
        timer.finished(Stage::rectify);
        const DepthImage& depth = measure_depth(frame, pair);
        const bool is_fine = measure_fine_depth(full_frame, motion);
        timer.finished(Stage::stereo);
        report.ground =
            observe_ground(depth, motion.T_odom_body, Eigen::Vector3d::UnitZ()).observation;
        watch_mount(motion, report.ground);
        watch_mirrors(pair, depth, motion, report.ground);
        timer.finished(Stage::ground);
        report.fusion = fuse(depth, is_fine, motion);
        timer.finished(Stage::fuse);
        rate();
        timer.finished(Stage::traversability);
        find_features(depth, motion);
        timer.finished(Stage::stairs);
        report.depth_pixels = count_valid(depth.disparity_px);
        if (is_fine) report.fine_pixels = count_valid(fine_->depth().disparity_px);
        report.image_pixels = static_cast<std::int64_t>(depth.disparity_px.size());
    } else if (rated_at_m_ != map_.geometry().origin_m) {
        rate();  // the window moved: the old ratings belong to other cells
        timer.finished(Stage::traversability);
    }
    hide_mirrored_ground();
    report.camera = camera_state();
    report.known_cells = map_.known_cells();
    return report;
}

FrameReport Pipeline::check(const StereoFrame& frame, Work wanted) {
    FrameReport report;
    report.time_ns = frame.time_ns;
    report.index = frame.index;
    report.frame_status = watch_.check(frame);
    const ExposureState exposure = exposure_state_of(frame);
    camera_monitor_.add(report.frame_status, exposure);
    report.camera = camera_state();
    // Black or saturated areas match everywhere. So a badly exposed frame gets no depth.
    const bool has_depth =
        report.frame_status.is_new_and_whole() && exposure == ExposureState::well_exposed;
    report.work = has_depth ? wanted : Work::odometry;
    return report;
}

FrameReport Pipeline::skip(const StereoFrame& frame, FrameReport report) {
    odometry_.skip(frame, report.frame_status);
    report.motion =
        odometry::unseen_motion(config_.odometry, last_motion_, frame.time_ns, report.frame_status);
    report.known_cells = map_.known_cells();
    return report;
}

MotionEstimate Pipeline::move(const StereoFrame& frame) {
    MotionEstimate motion = track(frame, odometry_, alignment_.T_odom_body);
    if (!frame.known_motion) motion = tilt_drift_correction_.level(motion);
    map_.follow(motion.T_odom_body, motion.relative_covariance);
    feature_drift_.add(motion.relative_covariance, motion.T_odom_body.R());
    if (motion.health == Health::lost) feature_tracker_.forget();
    last_motion_ = motion;
    return motion;
}

MotionEstimate Pipeline::track(const StereoFrame& frame,
                               odometry::Odometry& odometry,
                               const Pose& T_odom_first) {
    if (!frame.known_motion) return odometry.update_whole(frame, *executor_);
    MotionEstimate motion = *frame.known_motion;
    motion.T_odom_body = T_odom_first * motion.T_odom_body;
    return motion;
}

const camera::RectifiedPair& Pipeline::rectify(const StereoFrame& frame) {
    if (frame.known_depth) {
        pair_ = {};
    } else {
        rectifier_->rectify(frame, pair_);
    }
    return pair_;
}

const DepthImage& Pipeline::measure_depth(const StereoFrame& frame,
                                          const camera::RectifiedPair& pair) {
    if (frame.known_depth) {
        SUREFOOT_ASSERT(frame.known_depth->disparity_px.width() == rig().width &&
                        frame.known_depth->disparity_px.height() == rig().height);
        depth_ = *frame.known_depth;
    } else if (pair.right.empty()) {
        depth_from_rgbd(*rectifier_, config_.elevation.sensor, frame.depth_m, depth_);
    } else {
        matcher_->match(pair.left.view(), pair.right.view(), *executor_, depth_);
    }
    return depth_;
}

/// Step between the sampled pixels. The errors of the matcher are correlated over more pixels.
constexpr int kGroundStep_px = 6;

ground::GroundSighting Pipeline::observe_ground(const DepthImage& depth,
                                                const Pose& T_level_body,
                                                const Eigen::Vector3d& up_level) {
    // The plane is searched in base_link, because the height of base_link is known, not the height
    // of odom.
    ground::sample_points(rectifier_->rig(), depth, kGroundStep_px, ground_points_);
    const Eigen::Vector3d up_body = T_level_body.rotation.conjugate() * up_level;
    return ground::observe_ground(config_.ground, ground_points_, up_body, kGroundSeed);
}

ground::GroundSighting Pipeline::search_ground(const DepthImage& depth) {
    ground::sample_points(rectifier_->rig(), depth, kGroundStep_px, ground_points_);
    return ground::search_ground(config_.ground, ground_points_, kGroundSeed);
}

void Pipeline::watch_mount(const MotionEstimate& motion, const GroundObservation& ground_body) {
    tilt_drift_correction_.see(ground_body);
    if (config_.ground.expected_height_m > 0.0) mount_monitor_.add(motion, ground_body);
}

CameraState Pipeline::camera_state() const noexcept {
    if (mount_monitor_.moved()) return CameraState::moved;
    const CameraState images = camera_monitor_.state();
    return images == CameraState::ok && mount_monitor_.leans() ? CameraState::leaning : images;
}

void Pipeline::watch_mirrors(const camera::RectifiedPair& pair,
                             const DepthImage& depth,
                             const MotionEstimate& motion,
                             const GroundObservation& ground_body) {
    if (motion.health == Health::lost) return;
    mirror_watch_.add(rectifier_->rig(),
                      motion.T_odom_body,
                      pair.left.view(),
                      depth.disparity_px.view(),
                      specular::level_floor_z_m(ground_body, motion.T_odom_body));
}

void Pipeline::hide_mirrored_ground() {
    if (panes().empty()) {
        hidden_.resize(0, 0);
        return;
    }
    const grid::GridGeometry& geometry = map_.geometry();
    hidden_.resize(geometry.nx, geometry.ny);
    hidden_.fill(0);
    specular::hide_behind(panes(), config_.specular, geometry, hidden_.view());
}

bool Pipeline::measure_fine_depth(const StereoFrame& frame, const MotionEstimate& motion) {
    if (!fine_ || !alignment_.has_ground || motion.health == Health::lost ||
        !fine_schedule_.is_due(motion.time_ns, motion.T_odom_body))
        return false;
    const camera::PixelBox box = fine_region(config_.fine,
                                             fine_->whole_rig(),
                                             motion.T_odom_body,
                                             alignment_.ground_height_m,
                                             at_scale(config_.stereo, scale_).disparities);
    if (box.width == 0) return false;
    fine_->measure(frame, box, *executor_);
    fine_schedule_.observed();
    return true;
}

FusionCounts Pipeline::fuse(const DepthImage& depth, bool with_fine, const MotionEstimate& motion) {
    if (motion.health == Health::lost) return {};  // the pose is unknown
    const elevation::DepthView whole{rectifier_->rig(), depth};
    const elevation::DepthView views[] = {
        with_fine ? elevation::DepthView{fine_->rig(), fine_->depth()} : whole, whole};
    const FusionCounts counts = map_.add(std::span(views).subspan(with_fine ? 0 : 1),
                                         motion.T_odom_body,
                                         motion.time_ns,
                                         *executor_);
    if (!shows_ground(counts, map_.geometry().resolution_m)) return counts;
    last_fused_ns_ = motion.time_ns;
    ++version_;
    return counts;
}

void Pipeline::rate() {
    rated_at_m_ = map_.geometry().origin_m;
    map_.surface(surface_m_);
    rater_.rate(surface_m_.view(), map_.geometry().resolution_m, *executor_, rating_);
}

grid::Layer Pipeline::surface_m() const {
    grid::Layer surface_m;
    map_.surface(surface_m);
    return surface_m;
}

stairs::View Pipeline::view() const {
    return {.T_map_camera = last_motion_.T_odom_body * rig().T_body_camera,
            .width_px = static_cast<double>(rig().width),
            .height_px = static_cast<double>(rig().height),
            .fx_px = rig().fx_px,
            .fy_px = rig().fy_px,
            .cx_px = rig().cx_px,
            .cy_px = rig().cy_px,
            .baseline_m = rig().baseline_m,
            .unmapped_px = static_cast<double>(config_.elevation.pixels.reach_px)};
}

stairs::Terrain Pipeline::terrain(const DepthImage& depth, const MotionEstimate& motion) const {
    const elevation::ElevationLayers& layers = map_.layers();
    return {.geometry = map_.geometry(),
            .height_m = layers.height_m.view(),
            .height_var_m2 = layers.height_var_m2.view(),
            .free_above_m = layers.free_above_m.view(),
            .clearance_m = layers.clearance_m.view(),
            .density_ratio = layers.density_ratio.view(),
            .observations = layers.count.view(),
            .stance_m = motion.T_odom_body.translation_m.head<2>(),
            .view = view(),
            .disparity_px = depth.disparity_px.view()};
}

void Pipeline::find_features(const DepthImage& depth, const MotionEstimate& motion) {
    const stairs::Terrain now = terrain(depth, motion);
    feature_finder_.find(now, found_features_);
    feature_tracker_.update(found_features_, now, {motion.time_ns, feature_drift_}, features_);
    feature_drift_ = {};
}

stairs::GroundClasses Pipeline::ground_classes() const {
    return stairs::classify_ground(config_.stairs, terrain(depth_, last_motion_), features_);
}

grid::Layer Pipeline::reach_step_m() const {
    grid::Layer step_m;
    traversability::Reachability(config_.traversability.reach)
        .reach(map_.geometry(),
               map_.layers().height_m.view(),
               last_motion_.T_odom_body.translation_m.head<2>(),
               step_m);
    return step_m;
}

Image<traversability::Foothold> Pipeline::footholds() const {
    const elevation::ElevationLayers& layers = map_.layers();
    const grid::Layer reach_m = reach_step_m();
    Image<traversability::Foothold> found;
    traversability::FootholdFinder(config_.foothold)
        .find({layers.height_m.view(),
               layers.height_var_m2.view(),
               layers.clearance_m.view(),
               layers.free_above_m.view(),
               reach_m.view(),
               map_.geometry().resolution_m,
               layers.count.view()},
              *executor_,
              found);
    return found;
}

Status Pipeline::snapshot(std::uint64_t config_hash, grid::MapSnapshot& out) const {
    const elevation::ElevationLayers& layers = map_.layers();
    grid::SnapshotInput input;
    input.geometry = map_.geometry();
    input.height_m = layers.height_m.view();
    input.variance_m2 = layers.height_var_m2.view();
    input.drift_m = layers.horizontal_drift_m.view();
    input.clearance_m = layers.clearance_m.view();
    input.free_above_m = layers.free_above_m.view();
    input.hidden = hidden_.view();
    std::vector<grid::SnapshotInput::Edge> edges;
    for (const stairs::Edge& edge : features_.edges)
        edges.push_back({edge.from_m,
                         edge.to_m,
                         edge.upper_m,
                         edge.lower_m,
                         edge.height_sigma_m,
                         edge.across_sigma_m});
    input.edges = edges;
    input.T_odom_body = last_motion_.T_odom_body;
    input.frame_time_ns = last_fused_ns_;
    input.pose_time_ns = last_motion_.time_ns;
    input.gravity_source = alignment_.gravity_source;
    input.tilt_sigma_rad = alignment_.tilt_sigma_rad;
    input.health = snapshot_health(last_motion_.health);
    input.camera = camera_state();
    input.version = version_;
    input.config_hash = config_hash;
    return grid::build_snapshot(input, out);
}

}  // namespace surefoot::pipeline
