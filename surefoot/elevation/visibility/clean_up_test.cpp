// SPDX-License-Identifier: Apache-2.0
// A person who walks through the image must leave the map; a standing object must stay.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/elevation/elevation_map.hpp"

namespace surefoot::elevation {
namespace {

constexpr std::int64_t kFrame_ns = 66'666'667;  ///< 15 Hz
constexpr int kSecond = 15;

struct Box {
    Eigen::Vector3d low_m;
    Eigen::Vector3d high_m;
};

const Box kPerson{{1.4, -0.25, 0.0}, {1.7, 0.25, 0.95}};  // its part below the height cut
const Box kCrate{{1.2, 0.6, 0.0}, {1.6, 1.0, 0.3}};
const Box kTableTop{{1.3, -1.4, 0.68}, {2.0, -0.6, 0.71}};

/// A ZED's VGA image, or half of it.
camera::RectifiedRig rig(int width) {
    const double scale = width / 672.0;
    camera::RectifiedRig rig;
    rig.width = width;
    rig.height = 376 * width / 672;
    rig.fx_px = 342.0 * scale;
    rig.fy_px = rig.fx_px;
    rig.cx_px = 0.5 * (rig.width - 1);
    rig.cy_px = 0.5 * (rig.height - 1);
    rig.baseline_m = 0.12;
    rig.T_body_camera =
        Pose{exp_so3({0.0, 32.0 * std::numbers::pi / 180.0, 0.0}), Eigen::Vector3d::Zero()} *
        T_body_optical();
    return rig;
}

Pose body_at(double x_m) {
    return {Eigen::Quaterniond::Identity(), {x_m, 0.0, 1.05}};
}

/// Returns the distance along a ray to a box; infinite without an intersection (slab method).
double meet(const Box& box, const Eigen::Vector3d& from_m, const Eigen::Vector3d& ray) {
    double enter = 0.0;
    double leave = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (box.low_m[axis] - from_m[axis]) / ray[axis];
        const double b = (box.high_m[axis] - from_m[axis]) / ray[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter < leave ? enter : std::numeric_limits<double>::infinity();
}

DepthImage look(const camera::RectifiedRig& camera,
                const std::vector<Box>& boxes,
                const Pose& T_odom_body,
                Rng& rng) {
    constexpr double kSigma_px = 0.1;
    const Pose T_odom_camera = T_odom_body * camera.T_body_camera;
    const Eigen::Vector3d from_m = T_odom_camera.translation_m;
    DepthImage depth;
    depth.resize(camera.width, camera.height);
    depth.sigma_px.fill(static_cast<float>(kSigma_px));
    depth.outlier_probability.fill(0.05F);
    for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
            const Eigen::Vector3d ray =
                T_odom_camera.R() * Eigen::Vector3d((u - camera.cx_px) / camera.fx_px,
                                                    (v - camera.cy_px) / camera.fy_px,
                                                    1.0);
            double depth_m =
                ray.z() < 0.0 ? -from_m.z() / ray.z() : std::numeric_limits<double>::infinity();
            for (const Box& box : boxes) depth_m = std::min(depth_m, meet(box, from_m, ray));
            depth.disparity_px.at(u, v) =
                std::isfinite(depth_m)
                    ? static_cast<float>(camera.depth_to_disparity_px_m() / depth_m +
                                         kSigma_px * rng.normal())
                    : kNanF;
        }
    }
    return depth;
}

struct Found {
    int floor = 0;
    int higher = 0;
    int unknown = 0;
    int blocked = 0;  ///< an object counts as hanging over the cell
    int free = 0;     ///< floor, without an object over it
};

Found over(const ElevationMap& map, const Box& box) {
    Found found;
    const auto first = map.geometry().cell_at(box.low_m.x(), box.low_m.y());
    const auto last = map.geometry().cell_at(box.high_m.x(), box.high_m.y());
    for (int iy = first->iy; iy <= last->iy; ++iy) {
        for (int ix = first->ix; ix <= last->ix; ++ix) {
            const float height_m = map.layers().height_m.at(ix, iy);
            found.unknown += std::isnan(height_m) ? 1 : 0;
            found.floor += std::abs(height_m) < 0.05F ? 1 : 0;
            found.higher += height_m > 0.05F ? 1 : 0;
            const bool blocked = !std::isnan(map.layers().clearance_m.at(ix, iy));
            found.blocked += blocked ? 1 : 0;
            found.free += std::abs(height_m) < 0.05F && !blocked ? 1 : 0;
        }
    }
    return found;
}

class CleanUp : public ::testing::Test {
  protected:
    FusionCounts frames(const std::vector<Box>& boxes, int count, double step_m = 0.0) {
        FusionCounts sum;
        for (int i = 0; i < count; ++i) {
            x_m_ += step_m;
            map_.follow(body_at(x_m_), Matrix6::Zero());
            sum += map_.add(
                camera_, body_at(x_m_), look(camera_, boxes, body_at(x_m_), rng_), time_ns_);
            time_ns_ += kFrame_ns;
        }
        return sum;
    }

    ElevationMap map_{[] {
        ElevationConfig config;
        config.length_m = 5.0;
        return config;
    }()};
    camera::RectifiedRig camera_ = rig(336);
    Rng rng_{1};
    double x_m_ = 0.0;
    std::int64_t time_ns_ = 1;
};

TEST_F(CleanUp, WhoWalkedThroughIsGoneWithinASecond) {
    camera_ = rig(672);
    frames({kCrate, kTableTop}, 3);
    frames({kCrate, kTableTop, kPerson}, kSecond);
    const Found there = over(map_, kPerson);
    ASSERT_GE(there.higher + there.blocked, 18) << "the row of cells that faces the camera";
    frames({kCrate, kTableTop}, kSecond);
    const Found left = over(map_, kPerson);
    EXPECT_EQ(left.higher, 0);
    EXPECT_EQ(left.blocked, 0);
    EXPECT_GT(left.floor, 10 * left.unknown) << "and the floor is seen again";
}

TEST_F(CleanUp, WhoStoodThereFromTheStartIsGoneWithinASecond) {
    camera_ = rig(672);
    frames({kCrate, kPerson}, kSecond);
    ASSERT_GE(over(map_, kPerson).higher, 18);
    const FusionCounts sum = frames({kCrate}, kSecond);
    const Found left = over(map_, kPerson);
    EXPECT_GT(sum.cells_cleared, 0);
    EXPECT_EQ(left.higher, 0);
    EXPECT_EQ(left.blocked, 0);
    EXPECT_GT(left.floor, 10 * left.unknown);
}

/// Cells of the shown surface over a box that are higher than a floor's noise.
int shown_higher(const ElevationMap& map, const Box& box) {
    grid::Layer surface_m;
    map.surface(surface_m);
    const auto first = map.geometry().cell_at(box.low_m.x(), box.low_m.y());
    const auto last = map.geometry().cell_at(box.high_m.x(), box.high_m.y());
    int higher = 0;
    for (int iy = first->iy; iy <= last->iy; ++iy) {
        for (int ix = first->ix; ix <= last->ix; ++ix)
            higher += surface_m.at(ix, iy) > 0.05F ? 1 : 0;
    }
    return higher;
}

TEST_F(CleanUp, APersonWhoStepsOntoMappedFloorIsShownFromTheSecondFrame) {
    camera_ = rig(672);
    frames({}, kSecond);
    ASSERT_EQ(shown_higher(map_, kPerson), 0);
    frames({kPerson}, 2);
    EXPECT_GE(shown_higher(map_, kPerson), 18) << "the row of cells that faces the camera";
    EXPECT_EQ(over(map_, kPerson).higher, 0) << "the map itself still remembers the floor";
    frames({kPerson}, 2 * kSecond);
    EXPECT_GE(shown_higher(map_, kPerson), 18) << "and while the map learns it";
    frames({}, kSecond);
    EXPECT_EQ(shown_higher(map_, kPerson), 0) << "gone with the person";
}

TEST_F(CleanUp, OnlyWhatStandsOnTheGroundIsShownInPlaceOfIt) {
    camera_ = rig(672);
    const Box lamp{{1.4, -0.25, 0.6}, {1.7, 0.25, 0.7}};
    frames({}, kSecond);
    frames({lamp}, 3);
    const int blocked = over(map_, lamp).blocked;
    ASSERT_GT(blocked, 30);
    grid::Layer surface_m;
    map_.surface(surface_m);
    // In one frame, a cell at the rim holds points of the lamp and of the floor, like a face that
    // stands on the floor. Farther inside, the floor below stays the shown surface.
    constexpr double kRim_m = 0.06;
    for (int iy = 0; iy < surface_m.height(); ++iy) {
        for (int ix = 0; ix < surface_m.width(); ++ix) {
            if (!(surface_m.at(ix, iy) > map_.layers().height_m.at(ix, iy))) continue;
            const Eigen::Vector2d at_m = map_.geometry().center_m({ix, iy});
            EXPECT_LT(at_m.x() - lamp.low_m.x(), kRim_m) << at_m.transpose();
        }
    }
}

TEST_F(CleanUp, WhatStandsThereStays) {
    frames({kCrate, kTableTop}, 5);
    const Found crate = over(map_, kCrate);
    const Found table = over(map_, kTableTop);
    ASSERT_GT(crate.higher, 150);
    ASSERT_GT(table.higher + table.blocked, 100);
    // The machine stands for two seconds, then walks on until both objects leave the image.
    frames({kCrate, kTableTop}, 2 * kSecond);
    frames({kCrate, kTableTop}, 4 * kSecond, 0.01);
    EXPECT_GE(over(map_, kCrate).higher, crate.higher);
    const Found later = over(map_, kTableTop);
    EXPECT_GE(later.higher + later.blocked, table.higher + table.blocked);
    EXPECT_LE(later.unknown, table.unknown);
    EXPECT_LE(later.free, table.free) << "floor seen under the table is not free to walk on";
}

/// The machine stands 0.3 m higher than the floor that begins 1.2 m ahead. The edge hides 0.48 m of
/// the floor.
const Box kPlatform{{-3.0, -3.0, 0.0}, {1.2, 3.0, 0.3}};

TEST_F(CleanUp, LinesOfSightSayHowDeepHiddenGroundLies) {
    frames({kPlatform}, 8);
    const ElevationLayers& layers = map_.layers();
    int hidden = 0;
    for (int iy = 0; iy < map_.geometry().ny; ++iy) {
        for (int ix = 0; ix < map_.geometry().nx; ++ix) {
            const Eigen::Vector2d at = map_.geometry().center_m({ix, iy});
            const float free_m = layers.free_above_m.at(ix, iy);
            if (!std::isnan(layers.height_m.at(ix, iy))) {
                EXPECT_TRUE(std::isnan(free_m));
            }
            const bool behind = at.x() > 1.26 && at.x() < 1.58 && std::abs(at.y()) < 0.3;
            if (!behind || !std::isnan(layers.height_m.at(ix, iy))) continue;
            ++hidden;
            // The bound lies between two lines from the camera at 1.05 m: the line over the edge,
            // and a line that ends on the floor a few cells behind the hidden part (1.68 m), or
            // three sigma of one observation (16 mm) above the floor; plus noise.
            constexpr double kNoise_m = 0.01;
            constexpr double kEnd_m = 3.0 * 0.016;
            EXPECT_GT(static_cast<double>(free_m), 1.05 - 0.75 / 1.2 * at.x() - kNoise_m);
            EXPECT_LT(static_cast<double>(free_m),
                      1.05 - (1.05 - kEnd_m) / 1.85 * at.x() + kNoise_m);
        }
    }
    EXPECT_GT(hidden, 200);
    frames({kPlatform}, 5, 0.1);  // nearer to the edge more is visible, and the bound is deeper
    const auto cell = map_.geometry().cell_at(1.5, 0.0);
    EXPECT_NEAR(static_cast<double>(layers.height_m.at(cell->ix, cell->iy)), 0.0, 0.02);
    EXPECT_TRUE(std::isnan(layers.free_above_m.at(cell->ix, cell->iy)));
}

/// Returns the number of cells whose hidden ground the lines of sight bound.
std::int64_t looked_over(const ElevationMap& map) {
    const float* free_m = map.layers().free_above_m.data();
    return std::count_if(free_m, free_m + map.layers().free_above_m.size(), [](float z_m) {
        return !std::isnan(z_m);
    });
}

TEST_F(CleanUp, OneFrameAloneSaysNothingOfHiddenGround) {
    frames({kPlatform}, 2);
    EXPECT_EQ(looked_over(map_), 0) << "the second look is the first to agree, alone";
    frames({kPlatform}, 1);
    EXPECT_GT(looked_over(map_), 200);
}

TEST_F(CleanUp, LinesOverUnknownGroundCanBeLeftOut) {
    ElevationConfig config;
    config.visibility.drops = false;
    ElevationMap map(config);
    for (int time_ns = 1; time_ns <= 3; ++time_ns)
        map.add(camera_, body_at(0), look(camera_, {kPlatform}, body_at(0), rng_), time_ns);
    EXPECT_EQ(looked_over(map), 0);
}

TEST_F(CleanUp, CanBeSwitchedOff) {
    ElevationConfig config;
    config.visibility.cleanup = false;
    ElevationMap map(config);
    std::int64_t time_ns = 1;
    std::int64_t cleared = 0;
    for (int i = 0; i < 12; ++i) {
        const std::vector<Box> boxes = i < 3 ? std::vector<Box>{kPerson} : std::vector<Box>{};
        cleared += map.add(camera_, body_at(0), look(camera_, boxes, body_at(0), rng_), ++time_ns)
                       .cells_cleared;
    }
    EXPECT_EQ(cleared, 0);
}

}  // namespace
}  // namespace surefoot::elevation
