// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/odometry.hpp"

namespace surefoot::odometry {

void OdometryConfig::describe(ConfigVisitor& visitor) {
    visitor.integer(
        "max_tracks", max_tracks, 40, 2000, "largest number of landmarks tracked at the same time");
    visitor.integer(
        "grid_columns",
        grid_columns,
        2,
        100,
        "number of columns of the image grid; every grid cell gets its share of corners");
    visitor.integer("grid_rows",
                    grid_rows,
                    2,
                    100,
                    "number of rows of the image grid; every grid cell gets its share of corners");
    visitor.number("min_depth_m",
                   min_depth_m,
                   0.05,
                   10.0,
                   "smallest depth of a point that is matched between the cameras");
    visitor.number("sigma_px",
                   sigma_px,
                   0.05,
                   3.0,
                   "one sigma of the image position of an aligned point, per camera and axis; a "
                   "clearly larger measured noise replaces it, up to three times this value");
    visitor.integer(
        "window_keyframes",
        window_keyframes,
        3,
        30,
        "number of newest keyframes in the bundle adjustment; their oldest stays fixed");
    visitor.number(
        "still_parallax_px",
        still_parallax_px,
        0.0,
        3.0,
        "largest median parallax at which the camera may count as standing still; the expected "
        "parallax from noise is added; 0 = the camera never counts as standing still");
    visitor.number("bridge_s",
                   bridge_s,
                   0.0,
                   5.0,
                   "time for which landmarks are kept while the odometry is lost; then new "
                   "landmarks are seeded");
    visitor.number("max_gap_s",
                   max_gap_s,
                   0.05,
                   60.0,
                   "longest time between two frames; a longer time counts as a time gap");
    visitor.integer("ok_inliers",
                    ok_inliers,
                    10,
                    1000,
                    "smallest number of points that agree with the pose; with fewer points the "
                    "health is DEGRADED");
    visitor.integer("min_inliers",
                    min_inliers,
                    6,
                    1000,
                    "smallest number of points that agree with the pose; with fewer points the "
                    "health is LOST");
    visitor.number("ok_residual_px",
                   ok_residual_px,
                   0.1,
                   10.0,
                   "largest rms reprojection error; with a larger error the health is DEGRADED");
    visitor.number(
        "calibration_share",
        calibration_share,
        0.0,
        0.1,
        "one sigma of the motion error that the calibration may cause, divided by the motion");
    visitor.number("landmark_s",
                   landmark_s,
                   0.01,
                   60.0,
                   "time after which the errors of two poses count as independent");
    visitor.number("machine_speed_m_s",
                   machine_speed_m_s,
                   0.0,
                   100.0,
                   "largest speed of base_link; 0 = unknown; the machine file sets this value");
    visitor.number("machine_turn_deg_s",
                   machine_turn_deg_s,
                   0.0,
                   3600.0,
                   "largest turn rate of base_link; 0 = unknown; the machine file sets this value");
    visitor.number("lost_speed_m_s",
                   lost_speed_m_s,
                   0.01,
                   100.0,
                   "one sigma of the unmeasured speed while the odometry is lost");
    visitor.number("lost_turn_rad_s",
                   lost_turn_rad_s,
                   0.01,
                   100.0,
                   "one sigma of the unmeasured turn rate while the odometry is lost");
    visitor.group("imu", imu);
}

void InertialConfig::describe(ConfigVisitor& visitor) {
    visitor.boolean("enabled", enabled, "true: use the IMU if the source has one");
    visitor.number("gyro_density_rad_s_sqrt_hz",
                   noise.gyro_density_rad_s_sqrt_hz,
                   1e-6,
                   1.0,
                   "noise density of the gyroscope; includes its errors of scale, alignment, time "
                   "stamps and vibration");
    visitor.number("accel_density_m_s2_sqrt_hz",
                   noise.accel_density_m_s2_sqrt_hz,
                   1e-5,
                   10.0,
                   "noise density of the accelerometer; includes its errors of scale, alignment, "
                   "time stamps and vibration");
    visitor.number("gyro_walk_rad_s2_sqrt_hz",
                   noise.gyro_walk_rad_s2_sqrt_hz,
                   1e-7,
                   1.0,
                   "noise density of the random walk of the gyroscope's bias");
    visitor.number("accel_walk_m_s3_sqrt_hz",
                   noise.accel_walk_m_s3_sqrt_hz,
                   1e-6,
                   10.0,
                   "noise density of the random walk of the accelerometer's bias");
    visitor.number(
        "gyro_range_rad_s",
        limits.gyro_range_rad_s,
        0.0,
        1e3,
        "measuring range of the gyroscope; readings at the range limit are not used; 0 = unknown");
    visitor.number("accel_range_m_s2",
                   limits.accel_range_m_s2,
                   0.0,
                   1e4,
                   "measuring range of the accelerometer; readings at the range limit are not "
                   "used; 0 = unknown");
    visitor.number("max_gap_s",
                   limits.max_gap_s,
                   1e-3,
                   1.0,
                   "longest time without an IMU sample; a longer time counts as an IMU gap");
    visitor.number(
        "gravity_m_s2", gravity_m_s2, 9.7, 9.9, "magnitude of gravity at the location of use");
    visitor.number("gyro_bias_sigma_rad_s",
                   gyro_bias_sigma_rad_s,
                   1e-5,
                   1.0,
                   "one sigma of the gyroscope's bias after the initialisation");
    visitor.number("accel_bias_sigma_m_s2",
                   accel_bias_sigma_m_s2,
                   1e-4,
                   5.0,
                   "one sigma of the accelerometer's bias at the initialisation");
    visitor.number(
        "start_s", start_s, 0.2, 10.0, "duration of the visual odometry that initialises the IMU");
    visitor.number("dead_reckoning_s",
                   dead_reckoning_s,
                   0.0,
                   5.0,
                   "longest time for which the IMU alone continues the pose while the visual "
                   "odometry is lost");
}

}  // namespace surefoot::odometry
