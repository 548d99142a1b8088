// SPDX-License-Identifier: Apache-2.0
#include "studies/clouds/stray_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "surefoot/sim/sensors/sensor_scenes_testing.hpp"

namespace surefoot::app {
namespace {

using Eigen::Vector3d;

/// A quarter turn towards x with the resolution of the report.
sim::LaserScannerConfig quarter_turn() {
    sim::LaserScannerConfig config;
    config.azimuth_min_deg = -45.0;
    config.azimuth_max_deg = 45.0;
    config.elevation_max_deg = 30.0;
    config.step_deg = 0.072;
    config.max_range_m = 14.0;
    return config;
}

struct Scan {
    std::vector<Vector3d> all_m;  ///< in the frame of the scanner
    std::vector<Vector3d> kept_m;
    int columns = 0;
};

Scan scan_of(const sim::Scene& scene,
             const Vector3d& station_m,
             const sim::LaserScannerConfig& config) {
    const auto scanner = sim::LaserScanner::make(scene, config, 5);
    Pose T_world_scanner;
    T_world_scanner.translation_m = station_m;
    Scan scan;
    StrayFilter filter(config);
    const StrayFilter::Take keep = [&](std::span<const Vector3d> points_m) {
        ++scan.columns;
        for (const Vector3d& p_m : points_m) {
            if (!std::isnan(p_m.x())) scan.kept_m.push_back(p_m);
        }
        return true;
    };
    Serial serial;
    scanner.value().scan(T_world_scanner, 0, serial, [&](const sim::ScanColumn& column) {
        for (const sim::ScanPoint& point : column.points) {
            if (!std::isnan(point.point_scanner_m.x())) scan.all_m.push_back(point.point_scanner_m);
        }
        return filter.add(column, keep);
    });
    filter.finish(keep);
    EXPECT_EQ(scan.columns, scanner.value().columns());
    return scan;
}

int between(const std::vector<Vector3d>& points_m, double low_x_m, double high_x_m) {
    int found = 0;
    for (const Vector3d& p_m : points_m) found += p_m.x() > low_x_m && p_m.x() < high_x_m ? 1 : 0;
    return found;
}

double kept_share(const Scan& scan) {
    return static_cast<double>(scan.kept_m.size()) / static_cast<double>(scan.all_m.size());
}

TEST(StrayFilter, LeavesOutWhatHangsBetweenAnEdgeAndTheWallBehind) {
    const Scan scan =
        scan_of(sim::test::plate_before_wall(2.0, 4.0, 0.3), {0.0, 0.0, 1.6}, quarter_turn());
    // Between the plate (2 mm thick) and the wall there is no surface.
    EXPECT_GT(between(scan.all_m, 2.03, 3.97), 50);
    EXPECT_EQ(between(scan.kept_m, 2.03, 3.97), 0);
    EXPECT_GT(between(scan.kept_m, 1.9, 2.03), between(scan.all_m, 1.9, 2.03) * 98 / 100);
}

TEST(StrayFilter, AlsoOfARailThatIsBarelyWiderThanTheBeam) {
    sim::Scene scene = sim::test::wall_ahead(4.0);
    scene.add(sim::make_box({2.0, 0.0}, {0.02, 3.0}, 0.9, 0.94), 0, sim::Label::object);
    const Scan scan = scan_of(scene, {0.0, 0.0, 1.6}, quarter_turn());
    EXPECT_GT(between(scan.all_m, 2.05, 3.95), 500);
    EXPECT_LT(between(scan.kept_m, 2.05, 3.95), between(scan.all_m, 2.05, 3.95) / 100);
    EXPECT_GT(between(scan.kept_m, 1.9, 2.05), between(scan.all_m, 1.9, 2.05) / 2);
}

TEST(StrayFilter, LevelGroundStaysAsFarAsItIsNotMetAtAGlance) {
    // A scanner height of 1.6 m and a distance of 14 m give an angle of 6.5 deg.
    const Scan scan = scan_of(sim::test::floor_only(), {0.0, 0.0, 1.6}, quarter_turn());
    EXPECT_GT(kept_share(scan), 0.999);
}

TEST(StrayFilter, BothSidesOfACornerStay) {
    sim::Scene scene = sim::test::floor_only();
    scene.add(sim::make_box({4.0, 0.0}, {2.0, 40.0}, 0.0, 0.18), 0, sim::Label::object);
    const Scan scan = scan_of(scene, {0.0, 0.0, 1.6}, quarter_turn());
    EXPECT_GT(kept_share(scan), 0.99);
}

}  // namespace
}  // namespace surefoot::app
