// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/health.hpp"

#include <algorithm>

#include "surefoot/core/time.hpp"

namespace surefoot::odometry {
namespace {

constexpr double kBlurred = 0.3;       ///< an image with a smaller sharpness ratio is blurred
constexpr double kMinAgreeing = 0.35;  ///< smallest share of the tracks that agree on one motion
/// Largest ratio of the translation sigma to the depth of the scene in an OK frame.
constexpr double kDegradedDepthShare = 0.01;
constexpr double kDegradedRotation_rad = 0.01;
constexpr double kGapPeriods = 3.5;  ///< a gap is longer than this many usual periods
/// Smallest number of points on a second motion, and its smallest ratio to the number of points on
/// the first motion. Wrong matches are fewer and do not agree with each other.
constexpr int kOtherMotion = 15;
constexpr double kOtherMotionShare = 0.2;
constexpr double kLostFactor = 10.0;  ///< a sigma above this factor times its DEGRADED limit: LOST

}  // namespace

HealthVerdict judge(const OdometryConfig& config, const HealthEvidence& e) {
    const bool gap = e.gap_s > config.max_gap_s || !e.stamp_grows ||
                     (e.usual_gap_s > 0.0 && e.gap_s > kGapPeriods * e.usual_gap_s);
    const bool two_motions =
        e.other_motion >= kOtherMotion && e.other_motion >= kOtherMotionShare * e.inliers;
    const bool blurred = e.sharpness_ratio < kBlurred;
    const auto because = [&](HealthReason otherwise) {
        return gap ? HealthReason::time_gap : blurred ? HealthReason::blur : otherwise;
    };
    const double weakness =
        std::max(e.translation_sigma_m / (kDegradedDepthShare * e.scene_depth_m),
                 e.rotation_sigma_rad / kDegradedRotation_rad);
    if (e.cameras_swapped) return {Health::lost, HealthReason::cameras_swapped};
    if (!e.pose_found || e.inliers < config.min_inliers)
        return {Health::lost, because(HealthReason::few_tracks)};
    if (e.beyond_machine) return {Health::lost, HealthReason::beyond_machine};
    if (!(weakness < kLostFactor)) return {Health::lost, because(HealthReason::poor_geometry)};
    if (e.right_shows_something && e.inliers >= config.ok_inliers && e.depth_inliers == 0)
        return {Health::lost, because(HealthReason::poor_geometry)};
    if (two_motions) return {Health::degraded, HealthReason::moving_scene};
    if (e.inliers < config.ok_inliers || e.inliers < kMinAgreeing * e.tracks)
        return {Health::degraded, because(HealthReason::few_tracks)};
    if (weakness > 1.0 || e.depth_inliers < config.min_inliers)
        return {Health::degraded, because(HealthReason::poor_geometry)};
    if (blurred) return {Health::degraded, because(HealthReason::blur)};
    if (e.residual_px > config.ok_residual_px)
        return {Health::degraded, because(HealthReason::large_residual)};
    if (gap) return {Health::degraded, HealthReason::time_gap};
    if (e.torn_lately) return {Health::degraded, HealthReason::torn_image};
    if (e.was_unsure) return {Health::degraded, HealthReason::recovered};
    if (e.imu_disagrees) return {Health::degraded, HealthReason::imu_disagreement};
    if (e.machine_disagrees) return {Health::degraded, HealthReason::machine_disagreement};
    return {Health::ok, e.imu_gap ? HealthReason::imu_gap : HealthReason::none};
}

Matrix6 lost_covariance(const OdometryConfig& config, double before_s, double after_s) {
    const double squares = after_s * after_s - before_s * before_s;
    Vector6 variance;
    variance.head<3>().setConstant(config.lost_speed_m_s * config.lost_speed_m_s * squares);
    variance.tail<3>().setConstant(config.lost_turn_rad_s * config.lost_turn_rad_s * squares);
    return variance.asDiagonal();
}

MotionEstimate unseen_motion(const OdometryConfig& config,
                             const MotionEstimate& last,
                             std::int64_t time_ns,
                             const FrameStatus& frame_status) {
    MotionEstimate motion = last;
    motion.time_ns = time_ns;
    motion.T_previous_body = Pose{};
    motion.relative_covariance =
        lost_covariance(config, 0.0, seconds_from_ns(time_ns - last.time_ns));
    motion.health = Health::lost;
    motion.reason = frame_status.torn ? HealthReason::torn_image : HealthReason::repeated_image;
    motion.tracks = motion.inliers = 0;
    motion.residual_px = 0.0;
    return motion;
}

}  // namespace surefoot::odometry
