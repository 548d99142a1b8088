// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/odometry.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/camera/frame_integrity_check.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/geometry/statistics.hpp"
#include "surefoot/odometry/health.hpp"
#include "surefoot/odometry/inertial/inertial_tracker.hpp"
#include "surefoot/odometry/machine_tracker.hpp"
#include "surefoot/odometry/still_detector.hpp"
#include "surefoot/odometry/visual/front_end.hpp"
#include "surefoot/odometry/visual/measured_noise.hpp"
#include "surefoot/odometry/visual/point_front_end.hpp"

namespace surefoot::odometry {
namespace {

constexpr std::uint64_t kSeed = 0x5afef007;
constexpr double kCoastTime_s = 0.15;   ///< decay time of the predicted velocity of a lost camera
constexpr double kKeyframeShare = 0.7;  ///< new keyframe if a smaller share of points remains
constexpr double kKeyframeParallax = 0.035;  ///< new keyframe if parallax / image width is larger
constexpr int kKeyframePeriod = 12;          ///< new keyframe after this many frames of motion
/// Smallest share of the errors that two poses do not have in common.
constexpr double kLeastNewErrors = 1e-3;
/// Time after a torn image in which the next images are suspect. The check of rows detects only the
/// first of several torn images in a row. The old rows of the later images belong to frames that
/// never arrived.
constexpr double kTearing_s = 1.0;
/// Time after a frame with too little depth in which poses are suspect. The cause may be swapped
/// cameras, for which enough wrong points agree by chance in some frames.
constexpr double kDepthAgain_s = 0.5;
/// If a smaller share of the kept tracks agrees with the pose, the frame is tracked again.
constexpr double kFewFollowed = 0.5;

FrontEndConfig front_end_config(const OdometryConfig& config, const camera::RectifiedRig& rig) {
    FrontEndConfig front;
    front.corners.grid_columns = config.grid_columns;
    front.corners.grid_rows = config.grid_rows;
    front.corners.most = config.max_tracks;
    front.most_tracks = config.max_tracks;
    front.stereo.max_disparity_px =
        std::min(rig.depth_to_disparity_px_m() / config.min_depth_m, rig.width / 4.0);
    return front;
}

LandmarkMapConfig map_config(const OdometryConfig& config) {
    LandmarkMapConfig map;
    map.window_keyframes = config.window_keyframes;
    map.bundle.sigma_px = config.sigma_px;
    return map;
}

bool is_shortly_after(const std::optional<std::int64_t>& event_ns, std::int64_t now_ns, double s) {
    return event_ns && std::abs(seconds_from_ns(now_ns - *event_ns)) <= s;
}

/// One sigma in the least certain direction.
double largest_sigma(const Eigen::Matrix3d& covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance, Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(eigen.eigenvalues().maxCoeff(), 0.0));
}

}  // namespace

struct Odometry::Impl {
    Impl(const OdometryConfig& c,
         const camera::Rectifier& r,
         const std::optional<camera::ImuMount>& imu)
        : config(c),
          rectifier(r),
          images(front_end_config(c, r.rig()), r),
          points(r),
          map(map_config(c), r),
          still(c.still_parallax_px),
          noise(c.sigma_px),
          machine(r.rig().T_body_camera) {
        T_odom_camera = r.rig().T_body_camera;
        if (imu && config.imu.enabled)
            inertial.emplace(config.imu, imu->T_body_imu.inverse() * r.rig().T_body_camera);
    }

    void feed_by(Tracks& source);
    /// Processes the frame that is loaded into `front`.
    MotionEstimate update(std::int64_t now_ns, std::span<const ImuSample> imu, Executor& executor);
    MotionEstimate follow(std::int64_t now_ns, Executor& executor);
    MotionEstimate begin(std::int64_t now_ns, Executor& executor);
    MotionEstimate found(std::int64_t now_ns,
                         const PoseSolution& pose,
                         const HealthEvidence& evidence,
                         Executor& executor);
    MotionEstimate lost(std::int64_t now_ns, const HealthEvidence& evidence, Executor& executor);
    [[nodiscard]] Matrix6 unseen_since_last(const CameraFix& reckoned) const;
    PoseSolution solve(std::int64_t now_ns, Executor& executor);
    PoseSolution rough_pose(const Pose& predicted, Executor& executor);
    void learn_noise(const Pose& T_odom_camera_seen);
    /// Combines the visual pose with the IMU; the tracks must be the inliers of the pose.
    CameraFix improved(const PoseSolution& visual, double scene_depth_m);
    [[nodiscard]] HealthEvidence examine(std::int64_t now_ns, const PoseSolution& pose) const;
    /// Number of points that agree on a motion other than `pose`.
    [[nodiscard]] int other_motion(const PoseSolution& pose);
    [[nodiscard]] double scene_depth_m(const PoseSolution& pose) const;
    [[nodiscard]] bool is_beyond_machine(std::int64_t now_ns, const PoseSolution& pose) const;
    [[nodiscard]] Pose predict(double dt_s) const;
    [[nodiscard]] Matrix6 systematic_covariance(const Pose& T_before,
                                                const Pose& T_after,
                                                double depth_m) const;
    [[nodiscard]] bool wants_keyframe() const;
    Pose make_keyframe(const Pose& T, Executor& executor);
    bool seed_landmarks(Executor& executor);
    MotionEstimate publish(const Pose& T_camera,
                           const Matrix6& covariance,
                           const Matrix6& extra,
                           double share = 1.0);
    [[nodiscard]] Pose body_from(const Pose& T_camera) const {
        return T_camera * rectifier.rig().T_body_camera.inverse();
    }

    OdometryConfig config;
    const camera::Rectifier& rectifier;
    camera::FrameIntegrityCheck watch;
    FrontEnd images;
    PointFrontEnd points;
    Tracks* front = nullptr;  ///< the source of this frame: `images` or `points`
    LandmarkMap map;
    StillDetector still;
    MeasuredNoise noise;
    std::optional<InertialTracker> inertial;
    MachineTracker machine;
    PoseSolverConfig solver;

    Pose T_odom_camera;  ///< pose of the last estimate
    /// Covariance of T_odom_camera if the landmarks are exact.
    Matrix6 covariance_camera = Matrix6::Zero();
    /// Covariance of the motion since the last good frame.
    Matrix6 lost_body = Matrix6::Zero();
    Vector6 velocity = Vector6::Zero();      ///< velocity [m/s, rad/s] in the camera frame
    std::int64_t time_ns = 0;                ///< stamp of the previous frame
    std::int64_t good_time_ns = 0;           ///< stamp of the last frame with a pose
    Pose T_odom_good;                        ///< camera pose at `good_time_ns`
    double sharpness = 0.0;                  ///< sharpness of the image at `good_time_ns`
    double usual_gap_s = 0.0;                ///< time between the two frames before this one
    bool was_unsure = false;                 ///< the previous frame was LOST
    bool without_depth = false;              ///< the present frame measured too little depth
    std::optional<std::int64_t> torn_ns;     ///< stamp of the last torn image
    std::optional<std::int64_t> shallow_ns;  ///< stamp of the last frame with too little depth
    MotionEstimate last;
    bool started = false;
    int frames = 0;
    int frames_since_keyframe = 0;
    int keyframe_tracks = 0;
};

Odometry::Odometry(const OdometryConfig& config,
                   const camera::Rectifier& rectifier,
                   const std::optional<camera::ImuMount>& imu)
    : impl_(std::make_unique<Impl>(config, rectifier, imu)) {}
Odometry::~Odometry() = default;
Odometry::Odometry(Odometry&&) noexcept = default;
Odometry& Odometry::operator=(Odometry&&) noexcept = default;

void Odometry::start_at(const Pose& T_odom_body) {
    impl_->T_odom_camera = T_odom_body * impl_->rectifier.rig().T_body_camera;
}

MotionEstimate Odometry::update(const StereoFrame& frame, Executor& executor) {
    const FrameStatus frame_status = impl_->watch.check(frame);
    if (frame_status.is_new_and_whole()) return update_whole(frame, executor);
    skip(frame, frame_status);
    return unseen_motion(impl_->config, impl_->last, frame.time_ns, frame_status);
}

MotionEstimate Odometry::update_whole(const StereoFrame& frame, Executor& executor) {
    impl_->feed_by(impl_->images);
    static_cast<void>(impl_->images.load(frame, executor));
    impl_->machine.advance(frame.machine_motion);
    return impl_->update(frame.time_ns, frame.imu, executor);
}

MotionEstimate Odometry::update(const PointFrame& frame) {
    impl_->feed_by(impl_->points);
    impl_->points.load(frame.points);
    impl_->machine.advance(frame.machine_motion);
    return impl_->update(frame.time_ns, frame.imu, serial());
}

void Odometry::skip(const StereoFrame& frame, const FrameStatus& frame_status) {
    if (impl_->inertial) impl_->inertial->keep(frame.imu);
    impl_->machine.advance(frame.machine_motion);
    impl_->was_unsure = impl_->started;
    if (frame_status.torn) impl_->torn_ns = frame.time_ns;
}

/// Switches to another source of tracks. The landmarks of one source are unknown to the other.
void Odometry::Impl::feed_by(Tracks& source) {
    if (front == &source) return;
    front = &source;
    front->clear();
    map.clear();
    still.clear();
    sharpness = 0.0;
}

MotionEstimate Odometry::Impl::update(std::int64_t now_ns,
                                      std::span<const ImuSample> imu,
                                      Executor& executor) {
    solver.sigma_px = noise.sigma_px();
    map.set_noise(solver.sigma_px);
    if (inertial) inertial->advance(imu, now_ns);
    without_depth = false;
    MotionEstimate estimate = follow(now_ns, executor);
    estimate.time_ns = now_ns;
    usual_gap_s = frames > 0 ? std::max(seconds_from_ns(now_ns - time_ns), 0.0) : 0.0;
    was_unsure = estimate.health == Health::lost;
    if (without_depth) shallow_ns = now_ns;
    time_ns = now_ns;
    frames += 1;
    last = estimate;
    return estimate;
}

MotionEstimate Odometry::Impl::follow(std::int64_t now_ns, Executor& executor) {
    if (front->loaded() && !started) return begin(now_ns, executor);
    PoseSolution pose;
    if (front->loaded() && !map.empty()) pose = solve(now_ns, executor);
    HealthEvidence evidence = examine(now_ns, pose);
    if (pose.found) evidence.other_motion = other_motion(pose);
    if (judge(config, evidence).health == Health::lost) return lost(now_ns, evidence, executor);
    return found(now_ns, pose, evidence, executor);
}

/// Processes the first frame: its pose is given, its landmarks are new.
MotionEstimate Odometry::Impl::begin(std::int64_t now_ns, Executor& executor) {
    started = true;
    T_odom_good = T_odom_camera;
    good_time_ns = now_ns;
    if (inertial) inertial->stand({T_odom_camera, Matrix6::Zero()});
    machine.place(T_odom_camera);
    sharpness = front->sharpness();
    const bool seeded = seed_landmarks(executor);
    MotionEstimate estimate = publish(T_odom_camera, Matrix6::Zero(), Matrix6::Zero());
    estimate.tracks = front->kept();
    estimate.health = seeded ? Health::degraded : Health::lost;
    estimate.reason = seeded                     ? HealthReason::first_frame
                      : front->cameras_swapped() ? HealthReason::cameras_swapped
                      : front == &images         ? HealthReason::blur
                                                 : HealthReason::few_tracks;
    return estimate;
}

/// Starts a new map at the present pose. Returns false if the image does not give enough landmarks.
bool Odometry::Impl::seed_landmarks(Executor& executor) {
    map.clear();
    front->clear();
    still.clear();
    static_cast<void>(make_keyframe(T_odom_camera, executor));
    const bool enough = static_cast<int>(front->tracks().size()) >= config.min_inliers;
    if (!enough) {
        map.clear();
        front->clear();
    }
    front->keep();
    return enough;
}

Pose Odometry::Impl::predict(double dt_s) const {
    if (inertial)
        if (const auto predicted = inertial->predicted()) return *predicted;
    if (const auto known = machine.reckoned()) return known->T_odom_camera;
    if (!(dt_s > 0.0 && dt_s <= config.max_gap_s)) return T_odom_camera;
    return perturbed(T_odom_camera, velocity * dt_s);
}

PoseSolution Odometry::Impl::rough_pose(const Pose& predicted, Executor& executor) {
    front->follow(map, predicted, executor);
    const auto matches = front->matches(map);
    const Rng rng(mix_seed(kSeed, static_cast<std::uint64_t>(frames)));
    PoseSolution pose = find_pose(rectifier.rig(), solver, matches, predicted, rng);
    if (pose.found) pose = refine_pose(rectifier.rig(), solver, matches, pose.T_world_camera);
    return pose;
}

PoseSolution Odometry::Impl::solve(std::int64_t now_ns, Executor& executor) {
    const std::optional<Vector6> felt = inertial ? inertial->camera_velocity() : std::nullopt;
    front->move(felt.value_or(velocity));
    PoseSolution pose = rough_pose(predict(seconds_from_ns(now_ns - time_ns)), executor);
    if (pose.found && pose.inliers < kFewFollowed * front->kept())
        pose = rough_pose(pose.T_world_camera, executor);  // a better start finds more points
    if (!pose.found) return pose;
    const double dt_s = seconds_from_ns(now_ns - good_time_ns);
    if (!felt && dt_s > 0.0) front->move(difference(T_odom_good, pose.T_world_camera) / dt_s);
    front->align(map, pose.T_world_camera, executor);
    return refine_pose(rectifier.rig(), solver, front->matches(map), pose.T_world_camera);
}

double Odometry::Impl::scene_depth_m(const PoseSolution& pose) const {
    std::vector<double> depths;
    const Eigen::Vector3d forward = pose.T_world_camera.rotation * Eigen::Vector3d::UnitZ();
    for (std::size_t i = 0; i < front->tracks().size(); ++i)
        if (pose.inlier[i] != 0)
            depths.push_back(forward.dot(map.at(front->tracks()[i].slot).p_odom_m -
                                         pose.T_world_camera.translation_m));
    if (depths.empty()) return 0.0;
    return upper_median_in_place(depths);
}

HealthEvidence Odometry::Impl::examine(std::int64_t now_ns, const PoseSolution& pose) const {
    HealthEvidence evidence;
    evidence.pose_found = pose.found;
    evidence.tracks = static_cast<int>(front->tracks().size());
    evidence.gap_s = seconds_from_ns(now_ns - time_ns);
    evidence.usual_gap_s = usual_gap_s;
    evidence.stamp_grows = now_ns > time_ns;
    evidence.was_unsure = was_unsure || is_shortly_after(shallow_ns, now_ns, kDepthAgain_s);
    evidence.torn_lately = is_shortly_after(torn_ns, now_ns, kTearing_s);
    evidence.right_shows_something = front->right_shows_something();
    evidence.cameras_swapped = front->cameras_swapped();
    evidence.sharpness_ratio = front->sharpness() / std::max(sharpness, 1e-9);
    evidence.imu_disagrees = inertial && inertial->disagrees();
    evidence.imu_gap = inertial && inertial->gap();
    evidence.machine_disagrees = machine.disagrees();
    if (!pose.found) return evidence;
    evidence.beyond_machine = is_beyond_machine(now_ns, pose);
    evidence.inliers = pose.inliers;
    for (std::size_t i = 0; i < front->tracks().size(); ++i)
        evidence.depth_inliers +=
            pose.inlier[i] != 0 && std::isfinite(front->tracks()[i].pixel_px.z()) ? 1 : 0;
    evidence.residual_px = pose.residual_px;
    evidence.translation_sigma_m = largest_sigma(pose.covariance.topLeftCorner<3, 3>());
    evidence.rotation_sigma_rad = largest_sigma(pose.covariance.bottomRightCorner<3, 3>());
    evidence.scene_depth_m = scene_depth_m(pose);
    return evidence;
}

/// True if base_link moved or turned farther since the last good frame than the machine can, by
/// more than three sigma.
bool Odometry::Impl::is_beyond_machine(std::int64_t now_ns, const PoseSolution& pose) const {
    const double dt_s = seconds_from_ns(now_ns - good_time_ns);
    const Vector6 motion = difference(body_from(T_odom_good), body_from(pose.T_world_camera));
    const Matrix6 covariance =
        camera_to_body_covariance(pose.covariance, rectifier.rig().T_body_camera);
    const auto beyond = [&](double moved, double per_s, double sigma) {
        return per_s > 0.0 && !(moved <= per_s * dt_s + 3.0 * sigma);
    };
    return beyond(motion.head<3>().norm(),
                  config.machine_speed_m_s,
                  largest_sigma(covariance.topLeftCorner<3, 3>())) ||
           beyond(motion.tail<3>().norm(),
                  config.machine_turn_deg_s * std::numbers::pi / 180.0,
                  largest_sigma(covariance.bottomRightCorner<3, 3>()));
}

int Odometry::Impl::other_motion(const PoseSolution& pose) {
    const Eigen::Matrix3d R_camera_odom = pose.T_world_camera.R().transpose();
    std::vector<PointMatch> others;
    for (const PointMatch& match : front->matches(map)) {
        const Eigen::Vector3d p =
            R_camera_odom * (match.p_world_m - pose.T_world_camera.translation_m);
        if (p.z() > 0.0 && (project_stereo(rectifier.rig(), p) - match.pixel_px).head<2>().norm() <=
                               solver.ransac_threshold_px)
            continue;
        others.push_back(match);
        others.back().vote = 1.0;
    }
    const Rng rng(mix_seed(kSeed + 1, static_cast<std::uint64_t>(frames)));
    const PoseSolution other = find_pose(rectifier.rig(), solver, others, T_odom_camera, rng);
    return other.found ? other.inliers : 0;
}

/// Covariance that a small calibration error adds to a motion. Its sigma is a share of the motion.
/// A turn also adds to the translation, because a wrong turn looks like a translation of the scene.
Matrix6 Odometry::Impl::systematic_covariance(const Pose& T_before,
                                              const Pose& T_after,
                                              double depth_m) const {
    const Vector6 motion = difference(T_before, T_after);
    const double turn_rad = motion.tail<3>().norm();
    const double shift_m = std::hypot(motion.head<3>().norm(), turn_rad * depth_m);
    Vector6 sigma;
    sigma.head<3>().setConstant(config.calibration_share * shift_m);
    sigma.tail<3>().setConstant(config.calibration_share * turn_rad);
    return sigma.cwiseAbs2().asDiagonal();
}

MotionEstimate Odometry::Impl::found(std::int64_t now_ns,
                                     const PoseSolution& pose,
                                     const HealthEvidence& evidence,
                                     Executor& executor) {
    const double dt_s = seconds_from_ns(now_ns - good_time_ns);
    learn_noise(pose.T_world_camera);
    front->select(pose.inlier);
    for (const Track& track : front->tracks()) map.at(track.slot).agreed += 1;
    Pose T = pose.T_world_camera;
    Matrix6 covariance = pose.covariance;
    const bool standing = config.still_parallax_px > 0.0 &&
                          still.update(front->tracks(), map, T, covariance, pose.residual_px);
    if (standing) {
        T = still.T_odom_camera();
        // All frames of a held pose share one error. Division by n^2 limits the sum over all frames
        // to 1.64 times the variance of this error.
        covariance /= static_cast<double>(still.held()) * still.held();
        if (inertial) inertial->stand({T, pose.covariance});
    } else {
        CameraFix fix{T, covariance};
        if (inertial) fix = improved(pose, evidence.scene_depth_m);
        fix = machine.improved(fix);
        T = fix.T_odom_camera;
        covariance = fix.covariance;
    }
    frames_since_keyframe += standing ? 0 : 1;
    if (wants_keyframe()) {
        const Pose adjusted = make_keyframe(T, executor);
        if (!standing) T = adjusted;
    }
    if (inertial) inertial->place(T);
    machine.place(T);
    sharpness = front->sharpness();
    front->keep();
    velocity = dt_s > 0.0 ? Vector6(difference(T_odom_good, T) / dt_s) : Vector6::Zero();
    if (standing) covariance_camera.setZero();
    // Poses that see the same landmarks share their errors.
    const double new_errors =
        standing ? 1.0 : std::clamp(dt_s / config.landmark_s, kLeastNewErrors, 1.0);
    const Matrix6 systematic = systematic_covariance(T_odom_good, T, evidence.scene_depth_m);
    const Pose& T_body_camera = rectifier.rig().T_body_camera;
    MotionEstimate estimate =
        publish(T,
                covariance,
                lost_body + camera_to_body_covariance(systematic, T_body_camera),
                new_errors);
    lost_body.setZero();
    T_odom_good = T;
    good_time_ns = now_ns;
    without_depth = evidence.depth_inliers < config.min_inliers;
    const HealthVerdict verdict = judge(config, evidence);
    estimate.health = verdict.health;
    estimate.reason = verdict.reason;
    estimate.tracks = evidence.tracks;
    estimate.inliers = pose.inliers;
    estimate.residual_px = pose.residual_px;
    return estimate;
}

/// Learns the noise for the next frame from all tracks, before outliers are dropped.
void Odometry::Impl::learn_noise(const Pose& T_odom_camera_seen) {
    noise.listen(rectifier.rig(), solver, front->matches(map), T_odom_camera_seen);
}

CameraFix Odometry::Impl::improved(const PoseSolution& visual, double scene_depth_m) {
    const double scale = std::max(visual.residual_scale, kMinResidualScale);
    const VisualEvidence seen{rectifier.rig(), solver, front->matches(map), scale};
    const Matrix6 unmodelled =
        systematic_covariance(T_odom_good, visual.T_world_camera, scene_depth_m);
    return inertial->see(seen, visual, unmodelled)
        .value_or(CameraFix{visual.T_world_camera, visual.covariance});
}

MotionEstimate Odometry::Impl::lost(std::int64_t now_ns,
                                    const HealthEvidence& evidence,
                                    Executor& executor) {
    const double before_s = std::max(seconds_from_ns(time_ns - good_time_ns), 0.0);
    const double after_s = std::max(seconds_from_ns(now_ns - good_time_ns), before_s);
    const double dt_s = after_s - before_s;
    std::optional<CameraFix> reckoned = inertial ? inertial->reckon() : std::nullopt;
    if (!reckoned) reckoned = machine.reckoned();
    const Matrix6 unseen =
        reckoned ? unseen_since_last(*reckoned) : lost_covariance(config, before_s, after_s);
    lost_body += unseen;
    const Pose T = reckoned ? reckoned->T_odom_camera : predict(dt_s);
    if (reckoned && dt_s > 0.0) {
        velocity = difference(T_odom_camera, T) / dt_s;
    } else {  // coast: the velocity decays until the pose stops
        velocity *= std::exp(-dt_s / kCoastTime_s);
    }
    covariance_camera.setZero();
    MotionEstimate estimate = publish(T, Matrix6::Zero(), unseen);
    estimate.health = Health::lost;
    estimate.reason = judge(config, evidence).reason;
    estimate.tracks = evidence.tracks;
    estimate.inliers = evidence.inliers;
    if ((after_s > config.bridge_s || map.empty()) && front->loaded()) {
        seed_landmarks(executor);
        if (front->cameras_swapped()) estimate.reason = HealthReason::cameras_swapped;
    }
    return estimate;
}

/// Returns the covariance of the motion since the previous frame: the covariance of `reckoned`
/// (motion since the last good frame) minus `lost_body`.
Matrix6 Odometry::Impl::unseen_since_last(const CameraFix& reckoned) const {
    return positive_part(
        camera_to_body_covariance(reckoned.covariance, rectifier.rig().T_body_camera) - lost_body);
}

bool Odometry::Impl::wants_keyframe() const {
    const int newest = map.newest().id;
    std::vector<double> parallax;
    for (const Track& track : front->tracks()) {
        const Landmark& landmark = map.at(track.slot);
        if (landmark.sightings.empty() || landmark.sightings.back().keyframe != newest) continue;
        parallax.push_back((landmark.sightings.back().pixel_px - track.pixel_px).head<2>().norm());
    }
    if (static_cast<double>(parallax.size()) < kKeyframeShare * keyframe_tracks) return true;
    if (frames_since_keyframe >= kKeyframePeriod) return true;
    const auto middle = parallax.begin() + static_cast<std::ptrdiff_t>(parallax.size() / 2);
    std::nth_element(parallax.begin(), middle, parallax.end());
    return middle != parallax.end() && *middle > kKeyframeParallax * rectifier.rig().width;
}

/// Makes the present frame a keyframe and adjusts the map. Returns the adjusted pose.
Pose Odometry::Impl::make_keyframe(const Pose& T, Executor& executor) {
    map.add_keyframe(T);
    for (const Track& track : front->tracks())
        if (map.at(track.slot).id >= 0)
            map.add_sighting(track.slot, track.pixel_px, track.noise_factor);
    front->seed(map, executor);
    map.adjust();
    front->drop_removed(map);
    front->forget_excess(map);
    frames_since_keyframe = 0;
    keyframe_tracks = static_cast<int>(front->tracks().size());
    return map.newest().T_odom_camera;
}

/// Returns the estimate of a frame at `T_camera`, which becomes the previous frame. `share` is the
/// part of the poses' errors that counts as an error of the motion between them. `extra` is added
/// to the motion's covariance, in body axes.
MotionEstimate Odometry::Impl::publish(const Pose& T_camera,
                                       const Matrix6& covariance,
                                       const Matrix6& extra,
                                       double share) {
    MotionEstimate estimate;
    estimate.T_odom_body = body_from(T_camera);
    estimate.T_previous_body = body_from(T_odom_camera).inverse() * estimate.T_odom_body;
    const Pose& T_body_camera = rectifier.rig().T_body_camera;
    estimate.relative_covariance =
        share * compose_covariance(camera_to_body_covariance(covariance_camera, T_body_camera),
                                   estimate.T_previous_body,
                                   camera_to_body_covariance(covariance, T_body_camera)) +
        extra;
    T_odom_camera = T_camera;
    covariance_camera = covariance;
    return estimate;
}

}  // namespace surefoot::odometry
