// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

#include "surefoot/core/config.hpp"
#include "surefoot/core/pose.hpp"

namespace surefoot::elevation {

/// Error model of one measured point.
enum class SensorModel : std::uint8_t {
    matcher,            ///< Surefoot: uses the disparity sigma that the matcher gives each pixel
    perfect,            ///< no sensor error; the pose error stays
    laser,              ///< Pomerleau 2012
    kinect,             ///< structured light, Nguyen 2012
    stereo,             ///< Keller; Lange 2016, equations 6.2 and 6.3
    simplified_stereo,  ///< Rodriguez and Aggarwal 1990, eq. 6.4 and 6.5
    basic,              ///< height variance linear in the range; Lange 2016, equation 6.6
};

/// Parameters of all models; only those of the chosen model are used.
struct SensorConfig {
    SensorModel model = SensorModel::matcher;
    double min_var_m2 = 1e-8;  ///< lower limit of both variances, (0.1 mm)^2

    double matcher_lateral_px = 0.5;  ///< standard deviation of a match's image position

    double laser_min_radius_m = 0.018;  ///< Hokuyo, Pomerleau 2012
    double laser_beam_constant_m = 0.0015;
    double laser_beam_angle_rad = 0.0006;

    double kinect_a_m = 0.0012;  ///< sigma along z = a + b (z - c)^2 + d z^e
    double kinect_b_per_m = 0.0019;
    double kinect_c_m = 0.4;
    double kinect_d = 0.0;
    double kinect_e = 1.0;
    double kinect_lateral = 0.001376915;  ///< sigma across the ray per metre of depth z

    double stereo_p1 = 0.03287;  ///< published set; its column offset p4 fits a 752 px wide image
    double stereo_p2 = -0.0001276;
    double stereo_p3 = 0.4850;
    double stereo_p4 = 399.1046;
    double stereo_p5 = 0.000006735;
    double stereo_depth_to_disparity_px_m = 47.3;
    double stereo_lateral = 0.001376915;  ///< sigma across the ray per metre of range

    double simplified_disparity_px = 2.0;  ///< matching error dd of equation 6.4
    double simplified_lateral = 0.001376915;

    double basic_constant_m2 = 0.0010;  ///< height variance = constant + per_m * range
    double basic_per_m_m = 0.0030;

    void describe(ConfigVisitor& visitor);
};

/// Values of one point from which the models compute its variances.
struct SensorReading {
    double depth_m = 0.0;             ///< along the optical axis
    double range_m = 0.0;             ///< distance from the sensor
    double disparity_sigma_px = 0.0;  ///< used by the model `matcher`
    double column_px = 0.0;           ///< used by the model `stereo`
    double row_px = 0.0;              ///< used by the model `stereo`
    double principal_row_px =
        0.0;                ///< used by `stereo`: row R of the principal point in equation 6.2
    double focal_px = 0.0;  ///< used by the model `matcher`
    double depth_to_disparity_px_m =
        0.0;  ///< focal length times baseline; used by `matcher` and `simplified_stereo`
};

/// Variance of a point along its ray (called "normal" in the papers) and across its ray.
struct RayVariance {
    double along_m2 = 0.0;
    double lateral_m2 = 0.0;
};

/// Computes the model `matcher` without the lower limit. Inline, because it runs for every pixel.
/// z = D / d, so sigma_z = z^2 sigma_d / D, and a change of z moves the point along its ray.
[[nodiscard]] inline RayVariance matcher_variance(const SensorConfig& config,
                                                  const SensorReading& reading) noexcept {
    const double along_m = reading.depth_m * reading.range_m * reading.disparity_sigma_px /
                           reading.depth_to_disparity_px_m;
    const double lateral_m = config.matcher_lateral_px * reading.depth_m / reading.focal_px;
    return {along_m * along_m, lateral_m * lateral_m};
}

/// Computes the variances of `config.model` without the lower limit.
[[nodiscard]] RayVariance model_variance(const SensorConfig& config,
                                         const SensorReading& reading) noexcept;

/// Computes the variances of one point by `config.model`, each at least `min_var_m2`. Keller's
/// published parameters give negative variances for small disparities far from the image centre;
/// there the lower limit applies. NaN in the reading gives NaN.
[[nodiscard]] inline RayVariance ray_variance(const SensorConfig& config,
                                              const SensorReading& reading) noexcept {
    const RayVariance free = config.model == SensorModel::matcher
                                 ? matcher_variance(config, reading)
                                 : model_variance(config, reading);
    // std::max returns its first argument when the comparison is false: NaN stays NaN.
    return {std::max(free.along_m2, config.min_var_m2),
            std::max(free.lateral_m2, config.min_var_m2)};
}

/// Returns the height variance of a point, from the Jacobians of the sensor and of its pose:
///   var h = along n^2 + lateral (1 - n^2) + J Sigma J^T,  n = up . p/|p|,  J = [up^T, (p x up)^T]
/// `p_sensor_m`: the point, not at the origin. `up_sensor`: unit vector against gravity. Both are
/// in the frame to which the pose covariance belongs (right perturbation, see pose.hpp).
[[nodiscard]] double height_variance_m2(const RayVariance& ray,
                                        const Eigen::Vector3d& p_sensor_m,
                                        const Eigen::Vector3d& up_sensor,
                                        const Matrix6& pose_covariance);

}  // namespace surefoot::elevation
