// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/laser_scanner.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "surefoot/core/angles.hpp"
#include "surefoot/sim/sensors/sensor_scenes_testing.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

LaserScannerConfig window(double half_width_deg, double step_deg) {
    LaserScannerConfig config;
    config.azimuth_min_deg = -half_width_deg;
    config.azimuth_max_deg = half_width_deg;
    config.elevation_min_deg = -half_width_deg;
    config.elevation_max_deg = half_width_deg;
    config.step_deg = step_deg;
    return config;
}

LaserScannerConfig noiseless(LaserScannerConfig config) {
    config.noise_floor_m = 0.0;
    config.noise_growth = 0.0;
    return config;
}

Pose station() {
    Pose T_world_scanner;
    T_world_scanner.translation_m = {0.0, 0.0, 1.5};
    return T_world_scanner;
}

std::vector<ScanPoint> scanned(const Scene& scene,
                               const LaserScannerConfig& config,
                               const Pose& T_world_scanner,
                               int station_number = 0,
                               Executor* executor = nullptr) {
    Serial serial;
    std::vector<ScanPoint> points;
    LaserScanner::make(scene, config, 5)
        .value()
        .scan(T_world_scanner,
              station_number,
              executor != nullptr ? *executor : serial,
              [&](const ScanColumn& column) {
                  points.insert(points.end(), column.points.begin(), column.points.end());
                  return true;
              });
    return points;
}

Material grey(double reflectance) {
    Material material;
    material.albedo = reflectance;
    return material;
}

double range_sigma_m(double distance_m, double reflectance, double& mean_error_m) {
    const Scene scene = test::wall_ahead(distance_m, grey(reflectance));
    double sum = 0.0;
    double squares = 0.0;
    double count = 0.0;
    for (const ScanPoint& point : scanned(scene, window(2.0, 0.04), station())) {
        const double range_m = point.point_scanner_m.norm();
        // Along the beam: a wall across x is met at distance / cos.
        const double error_m = range_m - distance_m * range_m / point.point_scanner_m.x();
        sum += error_m;
        squares += error_m * error_m;
        count += 1.0;
    }
    mean_error_m = sum / count;
    return std::sqrt(squares / count);
}

TEST(LaserScannerTest, WithoutNoisePointsLieOnTheSurfaces) {
    LaserScannerConfig config = noiseless(window(60.0, 0.5));
    config.elevation_min_deg = -60.0;
    config.elevation_max_deg = 10.0;
    Pose T_world_scanner = station();
    T_world_scanner.rotation = exp_so3({0.02, -0.03, 0.7});
    const Scene scene = test::scene_with_box();
    int on_floor = 0;
    int on_box = 0;
    for (const ScanPoint& point : scanned(scene, config, T_world_scanner)) {
        if (!point.point_scanner_m.allFinite() || point.mixed) continue;
        const Vector3d p_m = T_world_scanner * point.point_scanner_m;
        const SurfacePoint at = scene.surface_point(point.surface, p_m);
        if (point.surface == 0) {
            EXPECT_NEAR(p_m.z(), 0.0, 1e-9);
            ++on_floor;
        } else if (at.normal.z() > 0.5) {
            EXPECT_NEAR(p_m.z(), 0.3, 1e-9);
            ++on_box;
        } else {
            // Sides of a box of 0.4 x 0.5 m turned by 0.4 rad about (1.6, 0.1).
            const Vector3d local =
                Eigen::AngleAxisd(-0.4, Vector3d::UnitZ()) * (p_m - Vector3d(1.6, 0.1, 0.0));
            const double inside_m =
                std::min(std::abs(std::abs(local.x()) - 0.2), std::abs(std::abs(local.y()) - 0.25));
            EXPECT_NEAR(inside_m, 0.0, 1e-9);
            ++on_box;
        }
    }
    EXPECT_GT(on_floor, 10000);
    EXPECT_GT(on_box, 300);
}

/// The four figures of the data sheet, and the model itself on 10 000 points.
TEST(LaserScannerTest, RangeNoiseIsThatOfTheDataSheet) {
    const struct {
        double range_m;
        double reflectance;
        double sheet_m;
    } figures[] = {
        {10.0, 0.9, 0.60e-3}, {10.0, 0.1, 1.20e-3}, {25.0, 0.9, 0.95e-3}, {25.0, 0.1, 2.20e-3}};
    const Scene scene = test::floor_only();
    const LaserScanner scanner = LaserScanner::make(scene, {}, 1).value();
    for (const auto& figure : figures) {
        EXPECT_NEAR(
            scanner.sigma_m(figure.range_m, figure.reflectance) / figure.sheet_m, 1.0, 0.095);
        double mean_m = 0.0;
        const double sigma_m = range_sigma_m(figure.range_m, figure.reflectance, mean_m);
        const double model_m = scanner.sigma_m(figure.range_m, figure.reflectance);
        EXPECT_NEAR(sigma_m / model_m, 1.0, 0.035) << figure.range_m << " m";  // 5 standard errors
        EXPECT_NEAR(mean_m / model_m, 0.0, 0.05);
    }
}

/// A plate 3 m away before a wall at 5 m. The beam is 3 mm + 0.19 mrad * r wide: rays within half
/// of that, as seen at the range of its middle, beside the plate's edge meet both.
TEST(LaserScannerTest, PointsAreMixedAtEdgesOnlyAndLieBetween) {
    const Scene scene = test::plate_before_wall(3.0, 5.0, 0.5);
    LaserScannerConfig config = noiseless(window(8.0, 0.01));
    config.elevation_min_deg = -0.5;
    config.elevation_max_deg = 0.5;
    int mixed = 0;
    int single = 0;
    for (const ScanPoint& point : scanned(scene, config, station())) {
        const Vector3d& p_m = point.point_scanner_m;
        ASSERT_TRUE(p_m.allFinite());
        const double at_plate_m = std::abs(p_m.y() / p_m.x()) * 3.0;
        if (point.mixed) {
            EXPECT_LT(std::abs(at_plate_m - 0.25), 0.5 * (0.003 + 0.19e-3 * 5.1) + 1e-6);
            EXPECT_GT(p_m.x(), 2.999);
            EXPECT_LT(p_m.x(), 5.001);
            mixed += p_m.x() > 3.1 && p_m.x() < 4.9 ? 1 : 0;
        } else {
            EXPECT_NEAR(p_m.x(), at_plate_m < 0.25 ? 3.0 : 5.0, 1e-9);
            ++single;
        }
    }
    // Two edges of 101 rows; the ring is 3.2 mm wide at 3 m (about 6 steps of 0.52 mm).
    EXPECT_GT(mixed, 2 * 101 * 3);
    EXPECT_LT(mixed, 2 * 101 * 8);
    EXPECT_GT(single, 100000);
}

TEST(LaserScannerTest, AThinBeamIsNeverMixed) {
    LaserScannerConfig config = noiseless(window(6.0, 0.02));
    config.beam_exit_m = 0.0;
    config.beam_divergence_rad = 0.0;
    for (const ScanPoint& point :
         scanned(test::plate_before_wall(3.0, 5.0, 0.5), config, station())) {
        EXPECT_FALSE(point.mixed);
    }
}

TEST(LaserScannerTest, RangeEndsEarlierOnDarkSurfacesAndShinyOnesGiveNothing) {
    const auto known = [](const Scene& scene) {
        double count = 0.0;
        const auto points = scanned(scene, window(1.0, 0.2), station());
        for (const ScanPoint& point : points) count += point.point_scanner_m.allFinite() ? 1 : 0;
        return count / static_cast<double>(points.size());
    };
    EXPECT_EQ(known(test::wall_ahead(119.0, grey(0.9))), 1.0);
    EXPECT_EQ(known(test::wall_ahead(121.0, grey(0.9))), 0.0);
    // 120 m sqrt(0.1 / 0.9) = 40 m.
    EXPECT_EQ(known(test::wall_ahead(39.5, grey(0.1))), 1.0);
    EXPECT_EQ(known(test::wall_ahead(40.5, grey(0.1))), 0.0);
    EXPECT_EQ(known(test::wall_ahead(0.5, grey(0.9))), 0.0) << "nearer than 0.6 m";
    Material glass = grey(0.9);
    glass.finish = Finish::glass;
    EXPECT_EQ(known(test::wall_ahead(5.0, glass)), 0.0);
}

TEST(LaserScannerTest, ColumnsComeInOrderUntilNobodyWantsMore) {
    const Scene scene = test::floor_only();
    const LaserScanner full = LaserScanner::make(scene, {}, 1).value();
    EXPECT_EQ(full.columns(), 10000);
    EXPECT_EQ(full.rows(), 4237);
    const LaserScanner scanner = LaserScanner::make(scene, window(40.0, 1.0), 1).value();
    EXPECT_EQ(scanner.columns(), 80);
    EXPECT_EQ(scanner.rows(), 81);
    Serial serial;
    int next = 0;
    scanner.scan(station(), 0, serial, [&](const ScanColumn& column) {
        EXPECT_EQ(column.index, next++);
        EXPECT_NEAR(column.azimuth_rad, (column.index - 40) * kRadPerDeg, 1e-12);
        EXPECT_EQ(column.points.size(), 81U);
        const Vector3d& lowest_m = column.points.front().point_scanner_m;
        EXPECT_NEAR(std::atan2(lowest_m.y(), lowest_m.x()), column.azimuth_rad, 1e-9);
        EXPECT_NEAR(std::asin(lowest_m.normalized().z()), -40.0 * kRadPerDeg, 1e-9);
        EXPECT_FALSE(column.points.back().point_scanner_m.allFinite()) << "sky";
        return column.index < 36;
    });
    EXPECT_EQ(next, 37);
}

TEST(LaserScannerTest, SameBytesForAnyExecutorAndOtherNoiseFromAnotherStation) {
    const Scene scene = test::scene_with_box();
    LaserScannerConfig config = window(30.0, 0.5);
    config.elevation_min_deg = -60.0;
    Backwards backwards;
    Threads threads(3);
    const auto a = scanned(scene, config, station());
    const auto b = scanned(scene, config, station(), 0, &backwards);
    const auto c = scanned(scene, config, station(), 0, &threads);
    const auto other = scanned(scene, config, station(), 1);
    ASSERT_EQ(a.size(), c.size());
    int differ = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!a[i].point_scanner_m.allFinite()) {
            EXPECT_FALSE(c[i].point_scanner_m.allFinite());
            continue;
        }
        EXPECT_EQ(a[i].point_scanner_m, b[i].point_scanner_m);
        EXPECT_EQ(a[i].point_scanner_m, c[i].point_scanner_m);
        differ += a[i].point_scanner_m != other[i].point_scanner_m ? 1 : 0;
    }
    EXPECT_GT(differ, 5000);
}

TEST(LaserScannerTest, AnglesWithoutABeamAreRefusedInWords) {
    const Scene scene = test::floor_only();
    LaserScannerConfig config = window(10.0, 1.0);
    config.azimuth_max_deg = -20.0;
    const auto none = LaserScanner::make(scene, config, 1);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, ErrorCode::usage);
    EXPECT_NE(none.error().message.find("azimuth -10 to -20 deg"), std::string::npos);
    config = window(10.0, 0.0);
    EXPECT_FALSE(LaserScanner::make(scene, config, 1));
    config = window(10.0, 1.0);
    config.min_range_m = 200.0;
    EXPECT_FALSE(LaserScanner::make(scene, config, 1));
}

}  // namespace
}  // namespace surefoot::sim
