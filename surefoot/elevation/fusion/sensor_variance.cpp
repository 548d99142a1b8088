// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/sensor_variance.hpp"

#include <array>
#include <cmath>

namespace surefoot::elevation {
namespace {

constexpr std::array<const char*, 7> kModelNames{
    "matcher", "perfect", "laser", "kinect", "stereo", "simplified_stereo", "basic"};

constexpr double square(double x) noexcept {
    return x * x;
}

RayVariance laser(const SensorConfig& config, const SensorReading& r) noexcept {
    return {square(config.laser_min_radius_m),
            square(config.laser_beam_constant_m + config.laser_beam_angle_rad * r.range_m)};
}

RayVariance kinect(const SensorConfig& config, const SensorReading& r) noexcept {
    const double power = config.kinect_d == 0.0 ? 0.0 : std::pow(r.depth_m, config.kinect_e);
    const double sigma_m = config.kinect_a_m +
                           config.kinect_b_per_m * square(r.depth_m - config.kinect_c_m) +
                           config.kinect_d * power;
    return {square(sigma_m), square(config.kinect_lateral * r.depth_m)};
}

RayVariance stereo(const SensorConfig& config, const SensorReading& r) noexcept {
    const double disparity_px = config.stereo_depth_to_disparity_px_m / r.depth_m;
    const double column = config.stereo_p3 * disparity_px + config.stereo_p4 - r.column_px;
    const double from_centre_px = std::sqrt(square(column) + square(r.principal_row_px - r.row_px));
    // Equation (6.2) of Lange 2016; D/d^2 = z^2/D.
    const double along_m2 =
        square(config.stereo_depth_to_disparity_px_m / square(disparity_px)) *
        ((config.stereo_p5 * disparity_px + config.stereo_p2) * from_centre_px + config.stereo_p1);
    return {along_m2, square(config.stereo_lateral * r.range_m)};
}

RayVariance simplified_stereo(const SensorConfig& config, const SensorReading& r) noexcept {
    // Equation (6.4): largest error of z for a disparity error dd; a quarter of it is one sigma.
    const double error_m = -square(r.depth_m) * config.simplified_disparity_px /
                           (r.depth_to_disparity_px_m + r.depth_m * config.simplified_disparity_px);
    return {square(0.25 * error_m), square(config.simplified_lateral * r.range_m)};
}

RayVariance basic(const SensorConfig& config, const SensorReading& r) noexcept {
    // Equation (6.6) gives the variance of the height itself, so it is the same in every direction.
    const double var_m2 = config.basic_constant_m2 + config.basic_per_m_m * r.range_m;
    return {var_m2, var_m2};
}

}  // namespace

void SensorConfig::describe(ConfigVisitor& visitor) {
    visitor.enumeration("model", model, kModelNames, "error model of a measured point");
    visitor.number("min_var_m2",
                   min_var_m2,
                   0.0,
                   1.0,
                   "smallest variance of a point along and across the line of sight");
    visitor.number("matcher_lateral_px",
                   matcher_lateral_px,
                   0.0,
                   50.0,
                   "matcher: standard deviation of the image position of a match");
    visitor.number("laser_min_radius_m",
                   laser_min_radius_m,
                   0.0,
                   1.0,
                   "laser: standard deviation of a point along the beam");
    visitor.number(
        "laser_beam_constant_m", laser_beam_constant_m, 0.0, 1.0, "laser: beam radius at range 0");
    visitor.number("laser_beam_angle_rad",
                   laser_beam_angle_rad,
                   0.0,
                   1.0,
                   "laser: growth of the beam radius per metre of range");
    visitor.number("kinect_a_m",
                   kinect_a_m,
                   -1.0,
                   1.0,
                   "kinect: term a of the sigma along the line of sight, which is a + b (z - c)^2 "
                   "+ d z^e at depth z");
    visitor.number("kinect_b_per_m",
                   kinect_b_per_m,
                   -1.0,
                   1.0,
                   "kinect: term b of the sigma along the line of sight, which is a + b (z - c)^2 "
                   "+ d z^e at depth z");
    visitor.number("kinect_c_m",
                   kinect_c_m,
                   -10.0,
                   10.0,
                   "kinect: term c of the sigma along the line of sight, which is a + b (z - c)^2 "
                   "+ d z^e at depth z");
    visitor.number("kinect_d",
                   kinect_d,
                   -10.0,
                   10.0,
                   "kinect: term d of the sigma along the line of sight, which is a + b (z - c)^2 "
                   "+ d z^e at depth z");
    visitor.number("kinect_e",
                   kinect_e,
                   -10.0,
                   10.0,
                   "kinect: term e of the sigma along the line of sight, which is a + b (z - c)^2 "
                   "+ d z^e at depth z");
    visitor.number("kinect_lateral",
                   kinect_lateral,
                   0.0,
                   1.0,
                   "kinect: sigma across the line of sight per metre of depth");
    visitor.number("stereo_p1",
                   stereo_p1,
                   -1e3,
                   1e3,
                   "stereo (Keller): parameter p1 of equation 6.2 in Lange 2016");
    visitor.number("stereo_p2",
                   stereo_p2,
                   -1e3,
                   1e3,
                   "stereo (Keller): parameter p2 of equation 6.2 in Lange 2016");
    visitor.number("stereo_p3",
                   stereo_p3,
                   -1e3,
                   1e3,
                   "stereo (Keller): parameter p3 of equation 6.2 in Lange 2016");
    visitor.number("stereo_p4",
                   stereo_p4,
                   -1e4,
                   1e4,
                   "stereo (Keller): parameter p4 of equation 6.2 in Lange 2016");
    visitor.number("stereo_p5",
                   stereo_p5,
                   -1e3,
                   1e3,
                   "stereo (Keller): parameter p5 of equation 6.2 in Lange 2016");
    visitor.number("stereo_depth_to_disparity_px_m",
                   stereo_depth_to_disparity_px_m,
                   1e-3,
                   1e5,
                   "stereo (Keller): factor D = focal length times baseline [px m]");
    visitor.number("stereo_lateral",
                   stereo_lateral,
                   0.0,
                   1.0,
                   "stereo (Keller): sigma across the line of sight per metre of range");
    visitor.number("simplified_disparity_px",
                   simplified_disparity_px,
                   0.0,
                   100.0,
                   "simplified stereo: largest error of a disparity; a quarter of the depth error "
                   "that it causes counts as one sigma");
    visitor.number("simplified_lateral",
                   simplified_lateral,
                   0.0,
                   1.0,
                   "simplified stereo: sigma across the line of sight per metre of range");
    visitor.number(
        "basic_constant_m2", basic_constant_m2, 0.0, 1.0, "basic: height variance at range 0");
    visitor.number("basic_per_m_m",
                   basic_per_m_m,
                   0.0,
                   1.0,
                   "basic: growth of the height variance per metre of range");
}

RayVariance model_variance(const SensorConfig& config, const SensorReading& r) noexcept {
    switch (config.model) {
        case SensorModel::matcher: return matcher_variance(config, r);
        case SensorModel::perfect: return {0.0 * r.range_m, 0.0 * r.range_m};  // NaN stays NaN
        case SensorModel::laser: return laser(config, r);
        case SensorModel::kinect: return kinect(config, r);
        case SensorModel::stereo: return stereo(config, r);
        case SensorModel::simplified_stereo: return simplified_stereo(config, r);
        case SensorModel::basic: return basic(config, r);
    }
    return {};
}

double height_variance_m2(const RayVariance& ray,
                          const Eigen::Vector3d& p_sensor_m,
                          const Eigen::Vector3d& up_sensor,
                          const Matrix6& pose_covariance) {
    const double n = up_sensor.dot(p_sensor_m) / p_sensor_m.norm();
    // p_odom = R Exp(theta) p + t + R dp, so dh = up . dp + up . (theta x p)
    //                                         = up . dp + (p x up) . theta
    Vector6 J;
    J.head<3>() = up_sensor;
    J.tail<3>() = p_sensor_m.cross(up_sensor);
    return ray.along_m2 * n * n + ray.lateral_m2 * (1.0 - n * n) + J.dot(pose_covariance * J);
}

}  // namespace surefoot::elevation
