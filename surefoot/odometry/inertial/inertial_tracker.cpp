// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/inertial/inertial_tracker.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace surefoot::odometry {
namespace {

/// 99.9 % quantile of a chi-square variable with six degrees of freedom.
constexpr double kChi2Limit = 22.46;
/// This many frames in a row beyond the limit are a contradiction, not chance.
constexpr int kContradictions = 8;
/// A difference of fifteen sigma is not chance: a bias has jumped, or vision tracks something else.
/// The disagreement is reported at once, even if the state later adapts to it.
constexpr double kChi2Jump = 225.0;
constexpr int kAgreements = 20;  ///< this many frames in a row within the limit end a contradiction
/// An initialisation with larger residuals is rejected: the rig's IMU has another mount or another
/// type than the calibration states.
constexpr double kStartResidual_m = 0.02;
constexpr double kStartResidual_rad = 0.02;
/// Upper limits of the discord. Jitter alone never separates vision and IMU farther.
constexpr double kMostDiscord_m = 0.01;
constexpr double kMostDiscord_rad = 0.01;
constexpr double kDiscordShare = 0.05;    ///< weight of one frame in the estimated discord
constexpr double kStartSpeed_m_s = 0.05;  ///< one sigma of the first velocity
/// One sigma of gravity's direction, without the error from the accelerometer bias.
constexpr double kStartTilt_rad = 0.005;
/// Largest number of stored samples: two seconds of a fast IMU. A longer interval has a gap.
constexpr int kMostSamples = 4000;
/// Sigma [m, rad] of a pose that is exact by definition.
constexpr double kExact = 1e-6;
/// Sigmas of a standing camera. Its pose may still drift as far as the still detector accepts.
constexpr double kHeld_m = 2e-4;
constexpr double kHeld_rad = 1e-4;
constexpr double kStandingSpeed_m_s = 5e-3;

double squared_distance(const Vector6& off, const Matrix6& covariance) {
    return off.dot(covariance.ldlt().solve(off));
}

}  // namespace

InertialTracker::InertialTracker(const InertialConfig& config, const Pose& T_imu_camera)
    : config_(config),
      model_{T_imu_camera, config.noise, config.gravity_m_s2},
      watch_(config.limits.max_gap_s) {}

void InertialTracker::keep(std::span<const ImuSample> samples) {
    watch_.listen(samples);
    samples_.insert(samples_.end(), samples.begin(), samples.end());
    // Limits the memory when the camera delivers no frames for a long time.
    if (std::ssize(samples_) > kMostSamples)
        samples_.erase(samples_.begin(), samples_.end() - kMostSamples);
}

void InertialTracker::advance(std::span<const ImuSample> samples, std::int64_t time_ns) {
    keep(samples);
    step_ = {};
    if (has_time_) {
        const ImuBias bias = belief_ ? belief_->state.bias : ImuBias{};
        step_ = preintegrate(config_.limits, config_.noise, samples_, time_ns_, time_ns, bias);
        // No sample can lie between stamps that do not increase.
        if (time_ns > time_ns_) watch_.finish(time_ns, step_.problem);
    }
    time_ns_ = time_ns;
    has_time_ = true;
    // Of the past samples, only the last sample at or before the frame is needed again.
    auto needed =
        std::ranges::find_if(samples_, [&](const ImuSample& s) { return s.time_ns > time_ns; });
    if (needed != samples_.begin()) --needed;
    samples_.erase(samples_.begin(), needed);
    if (step_.problem == ImuProblem::stamps) samples_.clear();

    present_.reset();
    if (!belief_) return;
    if (step_.problem != ImuProblem::none) {
        give_up();
        return;
    }
    present_ = predict(model_, *belief_, step_.motion);
    if (!present_->covariance.allFinite()) give_up();
}

void InertialTracker::give_up() {
    belief_.reset();
    present_.reset();
    unseen_.reset();
    frames_.clear();
    contradictions_ = agreements_ = 0;
}

std::optional<Pose> InertialTracker::predicted() const {
    if (!present_) return std::nullopt;
    return present_->state.T_odom_imu * model_.T_imu_camera;
}

std::optional<Vector6> InertialTracker::camera_velocity() const {
    if (!present_ || samples_.empty()) return std::nullopt;
    const InertialState& imu = present_->state;
    // The first remaining sample is the last sample at or before the frame.
    const Eigen::Vector3d turn_imu = samples_.front().angular_velocity_rad_s - imu.bias.gyro_rad_s;
    const Eigen::Vector3d speed_imu = imu.T_odom_imu.rotation.conjugate() * imu.velocity_m_s;
    const Pose& T_imu_camera = model_.T_imu_camera;
    const Eigen::Quaterniond R_camera_imu = T_imu_camera.rotation.conjugate();
    Vector6 velocity;
    velocity.head<3>() = R_camera_imu * (speed_imu + turn_imu.cross(T_imu_camera.translation_m));
    velocity.tail<3>() = R_camera_imu * turn_imu;
    return velocity;
}

/// Covariance of the predicted camera pose.
Matrix6 InertialTracker::predicted_covariance() const {
    return carried_covariance(present_->covariance.topLeftCorner<6, 6>(), model_.T_imu_camera);
}

Matrix6 InertialTracker::discord_covariance() const {
    Vector6 variance;
    variance.head<3>().setConstant(discord_m_ * discord_m_);
    variance.tail<3>().setConstant(discord_rad_ * discord_rad_);
    return variance.asDiagonal();
}

/// Learns the discord from the difference `off` between vision and prediction. `expected` is the
/// covariance of `off` without discord.
void InertialTracker::listen(const Vector6& off, const Matrix6& expected) {
    const Vector6 excess = off.cwiseAbs2() - expected.diagonal();
    const auto learn = [](double& sigma, double excess_mean, double most) {
        const double variance =
            (1.0 - kDiscordShare) * sigma * sigma + kDiscordShare * std::max(excess_mean, 0.0);
        sigma = std::min(std::sqrt(variance), most);
    };
    learn(discord_m_, excess.head<3>().mean(), kMostDiscord_m);
    learn(discord_rad_, excess.tail<3>().mean(), kMostDiscord_rad);
}

bool InertialTracker::still_agrees(double chi2) {
    const bool agrees = chi2 <= kChi2Limit;  // false for NaN
    contradictions_ = agrees ? 0 : contradictions_ + 1;
    agreements_ = agrees ? agreements_ + 1 : 0;
    if (agreements_ >= kAgreements) disagrees_ = false;
    if (!(chi2 <= kChi2Jump)) disagrees_ = true;
    if (contradictions_ < kContradictions) return true;
    give_up();
    disagrees_ = true;
    return false;
}

/// Sets the belief about the present frame, which has visual evidence.
void InertialTracker::believe(const InertialBelief& belief) {
    belief_ = belief;
    unseen_ = belief;
    unseen_->covariance.topRows<6>().setZero();
    unseen_->covariance.leftCols<6>().setZero();
    unseen_->covariance.topLeftCorner<6, 6>().diagonal().setConstant(kExact * kExact);
    blind_s_ = 0.0;
}

std::optional<CameraFix> InertialTracker::see(const VisualEvidence& seen,
                                              const PoseSolution& visual,
                                              const Matrix6& unmodelled) {
    const Pose T_camera_imu = model_.T_imu_camera.inverse();
    const Matrix6 covariance_imu = carried_covariance(visual.covariance, T_camera_imu);
    if (!present_) {
        collect(visual.T_world_camera * T_camera_imu, covariance_imu);
        return std::nullopt;
    }
    const Vector6 off = difference(*predicted(), visual.T_world_camera);
    const Matrix6 expected = predicted_covariance() + visual.covariance + unmodelled;
    const Matrix6 discord = discord_covariance();
    const double chi2 = squared_distance(off, expected + discord);
    listen(off, expected);
    if (!still_agrees(chi2)) return std::nullopt;
    // After one large difference, belief and readings count as less certain than they state.
    const double inflation = std::max(chi2 / kChi2Limit, 1.0);
    InertialBelief before = *belief_;
    before.covariance *= inflation;
    ImuMotion motion = step_.motion;
    motion.covariance *= inflation;

    const InertialSolution path =
        fuse(model_,
             before,
             motion,
             PoseEvidence{visual.T_world_camera * T_camera_imu, covariance_imu + discord, {}});
    // For the pose of the camera, the discord counts as noise of the motion, because the camera may
    // deviate from the smooth path by this much. `discord` has the translation first, the
    // covariance of `motion` has the rotation first.
    motion.covariance.topLeftCorner<3, 3>() += discord.bottomRightCorner<3, 3>();
    motion.covariance.bottomRightCorner<3, 3>() += discord.topLeftCorner<3, 3>();
    const InertialSolution camera = fuse(model_, before, motion, seen, visual.T_world_camera);
    if (!path.found || !camera.found || camera.inliers < kMinimalPoseMatches) {
        give_up();
        return std::nullopt;
    }
    believe(with_vision_counted_once(path.belief, covariance_imu));
    T_odom_camera_ = camera.belief.state.T_odom_imu * model_.T_imu_camera;
    return CameraFix{
        T_odom_camera_,
        carried_covariance(camera.belief.covariance.topLeftCorner<6, 6>(), model_.T_imu_camera)};
}

void InertialTracker::stand(const CameraFix& held) {
    const Pose T_odom_imu = held.T_odom_camera * model_.T_imu_camera.inverse();
    if (!present_) {
        collect(T_odom_imu, carried_covariance(held.covariance, model_.T_imu_camera.inverse()));
        return;
    }
    T_odom_camera_ = held.T_odom_camera;
    const Vector6 off = difference(*predicted(), held.T_odom_camera);
    const Matrix6 expected = predicted_covariance() + held.covariance + discord_covariance();
    if (!still_agrees(squared_distance(off, expected))) return;
    Vector6 sigma;
    sigma.head<3>().setConstant(kHeld_m);
    sigma.tail<3>().setConstant(kHeld_rad);
    const InertialSolution solution =
        fuse(model_,
             *belief_,
             step_.motion,
             PoseEvidence{T_odom_imu, sigma.cwiseAbs2().asDiagonal(), kStandingSpeed_m_s});
    if (solution.found) {
        believe(solution.belief);
    } else {
        give_up();
    }
}

std::optional<CameraFix> InertialTracker::reckon() {
    frames_.clear();
    if (!present_) return std::nullopt;
    blind_s_ += step_.motion.dt_s;
    unseen_ = predict(model_, *unseen_, step_.motion);
    if (blind_s_ > config_.dead_reckoning_s || !unseen_->covariance.allFinite()) {
        give_up();
        return std::nullopt;
    }
    belief_ = present_;
    T_odom_camera_ = *predicted();
    return CameraFix{
        T_odom_camera_,
        carried_covariance(unseen_->covariance.topLeftCorner<6, 6>(), model_.T_imu_camera)};
}

void InertialTracker::place(const Pose& T_odom_camera) {
    if (!belief_) return;
    // The map moved relative to the camera, so the path moves with it.
    const Pose T_new_old = T_odom_camera * T_odom_camera_.inverse();
    belief_->state.T_odom_imu = T_new_old * belief_->state.T_odom_imu;
    unseen_->state.T_odom_imu = belief_->state.T_odom_imu;
    T_odom_camera_ = T_odom_camera;
}

void InertialTracker::collect(const Pose& T_odom_imu, const Matrix6& covariance) {
    if (step_.problem != ImuProblem::none) {
        frames_.clear();
        frames_.push_back({T_odom_imu, {}});
        return;
    }
    frames_.push_back({T_odom_imu, frames_.empty() ? ImuMotion{} : step_.motion});
    double time_s = 0.0;
    for (const SeenMotion& frame : frames_) time_s += frame.motion.dt_s;
    if (time_s < config_.start_s) return;
    const auto start = start_inertial(frames_);
    frames_.clear();
    if (!start || start->residual_m > kStartResidual_m ||
        start->residual_rad > kStartResidual_rad ||
        std::abs(start->gravity_m_s2 - config_.gravity_m_s2) >
            4.0 * config_.accel_bias_sigma_m_s2) {
        disagrees_ = true;
        return;
    }
    const double tilt_rad =
        std::hypot(config_.accel_bias_sigma_m_s2 / config_.gravity_m_s2, kStartTilt_rad);
    Vector17 sigma = Vector17::Zero();
    sigma.segment<3>(kVelocityAt).setConstant(kStartSpeed_m_s);
    sigma.segment<3>(kGyroBiasAt).setConstant(config_.gyro_bias_sigma_rad_s);
    sigma.segment<3>(kAccelBiasAt).setConstant(config_.accel_bias_sigma_m_s2);
    sigma.segment<2>(kTiltAt).setConstant(tilt_rad);
    InertialBelief belief{start->state, sigma.cwiseAbs2().asDiagonal()};
    belief.covariance.topLeftCorner<6, 6>() = covariance;
    discord_m_ = start->residual_m;
    discord_rad_ = start->residual_rad;
    believe(belief);
    T_odom_camera_ = T_odom_imu * model_.T_imu_camera;
}

}  // namespace surefoot::odometry
