// SPDX-License-Identifier: Apache-2.0
#include "studies/lange2016/thesis_truth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "surefoot/core/executor.hpp"
#include "surefoot/sim/scenes/scene_file.hpp"

namespace surefoot::app {
namespace {

/// A floor with railings beside the path: bars of 4 cm, 0.9 m above the floor, on posts.
constexpr const char* kRailings =
    "name: test\n"
    "description: for a test\n"
    "parameters: {}\n"
    "materials:\n"
    "  stone: {pattern: concrete, albedo: 0.4}\n"
    "motion:\n"
    "  waypoints: [{x_m: 0, y_m: 0, pause_s: 1}, {x_m: 1, y_m: 0}]\n"
    "solids:\n"
    "  - floor: {min_x_m: -9, min_y_m: -9, max_x_m: 9, max_y_m: 9, material: stone}\n"
    "  - box: {x_m: 1.5, y_m: 1, length_m: 2, width_m: 0.04, bottom_m: 0.9, top_m: 0.94,"
    " material: stone}\n"
    "  - box: {x_m: 0.5, y_m: 1, length_m: 0.05, width_m: 0.05, top_m: 0.94, material: stone}\n"
    "  - box: {x_m: 2.5, y_m: 1, length_m: 0.05, width_m: 0.05, top_m: 0.94, material: stone}\n"
    "scan: {stations: [{x_m: 0.5, y_m: -1.5}, {x_m: 3.0, y_m: -1.0}]}\n";

/// Highest and lowest true surface [m] of a cell and its neighbours.
std::pair<double, double> true_heights_m(const sim::Scene& scene, const Eigen::Vector2d& at_m) {
    constexpr double kBeside_m = 0.025;
    double lowest_m = 1e9;
    double highest_m = -1e9;
    for (const double dx_m : {-kBeside_m, 0.0, kBeside_m}) {
        for (const double dy_m : {-kBeside_m, 0.0, kBeside_m}) {
            const auto top = scene.height_at(at_m.x() + dx_m, at_m.y() + dy_m);
            if (!top) continue;
            lowest_m = std::min(lowest_m, top->z_m);
            highest_m = std::max(highest_m, top->z_m);
        }
    }
    return {lowest_m, highest_m};
}

TEST(ScanPlace, HeightsBehindRailingsAreThoseOfTheFloor) {
    const auto script = sim::read_scene({"test.yaml", kRailings}, "", 1);
    ASSERT_TRUE(script) << script.error().message;
    sim::LaserScannerConfig config;
    config.step_deg = 0.108;
    Serial serial;
    const auto place = scan_place(*script, config, 1, area_around(*script, 3.0), 0.025, serial);
    ASSERT_TRUE(place) << place.error().message;
    EXPECT_EQ(place->stations, 2);
    int known = 0;
    int off = 0;
    int rail = 0;
    for (int iy = 0; iy < place->geometry.ny; ++iy) {
        for (int ix = 0; ix < place->geometry.nx; ++ix) {
            const double z_m = static_cast<double>(place->height_m.at(ix, iy));
            if (std::isnan(z_m)) continue;
            ++known;
            const auto [lowest_m, highest_m] =
                true_heights_m(script->scene, place->geometry.center_m({ix, iy}));
            constexpr double kNoise_m = 0.01;
            // The cells of a rail may also contain the floor below it.
            const bool right = std::abs(z_m - highest_m) < kNoise_m ||
                               std::abs(z_m - lowest_m) < kNoise_m ||
                               (highest_m > 0.5 && z_m < 0.95);
            off += right ? 0 : 1;
            rail += z_m > 0.9 ? 1 : 0;
        }
    }
    EXPECT_GT(known, 0.9 * place->geometry.nx * place->geometry.ny);
    EXPECT_GT(rail, 2.0 / 0.025);  // the bar is there
    EXPECT_LE(off, known / 5000);
}

TEST(ScanPlace, SaysWhatItCannotScan) {
    auto script = sim::read_scene({"test.yaml", kRailings}, "", 1);
    ASSERT_TRUE(script);
    Serial serial;
    ScanArea sky = area_around(*script, 3.0);
    sky.ceiling_m = -5.0;
    sim::LaserScannerConfig config;
    config.step_deg = 1.0;
    const auto place = scan_place(*script, config, 1, sky, 0.025, serial);
    ASSERT_FALSE(place);
    EXPECT_NE(place.error().message.find("no point"), std::string::npos) << place.error().message;
}

}  // namespace
}  // namespace surefoot::app
