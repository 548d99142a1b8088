// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/doors/doors.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;

constexpr double kCell_m = 0.025;
constexpr double kWall_m = 2.0;

/// A box on the floor; `length_m` along its yaw.
struct Box {
    Vector2d middle_m;
    double yaw_rad = 0.0;
    double length_m = 0.0;
    double width_m = 0.0;
    double top_m = 0.0;

    /// True if the box shares area with a cell: no side of either one separates them.
    [[nodiscard]] bool overlaps(const Vector2d& cell_m, double cell_side_m) const {
        constexpr double kTouch_m = 1e-9;
        const Vector2d x(std::cos(yaw_rad), std::sin(yaw_rad));
        const Vector2d y(-x.y(), x.x());
        const Vector2d d = cell_m - middle_m;
        const double half_m = 0.5 * cell_side_m;
        const double cell_half_m = half_m * (std::abs(x.x()) + std::abs(x.y()));
        const double box_x_m = 0.5 * (length_m * std::abs(x.x()) + width_m * std::abs(y.x()));
        const double box_y_m = 0.5 * (length_m * std::abs(x.y()) + width_m * std::abs(y.y()));
        return std::abs(d.dot(x)) < 0.5 * length_m + cell_half_m - kTouch_m &&
               std::abs(d.dot(y)) < 0.5 * width_m + cell_half_m - kTouch_m &&
               std::abs(d.x()) < box_x_m + half_m - kTouch_m &&
               std::abs(d.y()) < box_y_m + half_m - kTouch_m;
    }
};

/// A floor of 5 x 5 m about the origin; each cell holds its highest point.
struct World {
    grid::GridGeometry geometry;
    Image<float> height_m;
    Image<float> var_m2;
    Image<float> clearance_m;
    Vector2d stance_m{-1.5, 0.0};

    explicit World(double cell_m = kCell_m, double side_m = 5.0) {
        const int cells = static_cast<int>(std::lround(side_m / cell_m));
        geometry = {cell_m, cells, cells, Vector2d::Constant(-0.5 * side_m)};
        height_m = Image<float>(cells, cells, 0.0F);
        var_m2 = Image<float>(cells, cells, 0.0F);
        clearance_m = Image<float>(cells, cells, kNanF);
    }
    template <typename F>
    World& each(const F& change) {
        for (int iy = 0; iy < geometry.ny; ++iy)
            for (int ix = 0; ix < geometry.nx; ++ix)
                change(geometry.center_m({ix, iy}), height_m.at(ix, iy));
        return *this;
    }
    World& add(const Box& box) {
        return each([&](const Vector2d& p_m, float& z_m) {
            if (box.overlaps(p_m, geometry.resolution_m))
                z_m = std::max(z_m, static_cast<float>(box.top_m));
        });
    }
    /// Adds errors of single cells, and errors that squares of 0.1 m share.
    World& add_noise(Rng& rng, double cell_sigma_m, double shared_sigma_m) {
        const int shared = static_cast<int>(std::lround(0.1 / geometry.resolution_m));
        Image<float> error_m(geometry.nx / shared + 1, geometry.ny / shared + 1);
        for (std::size_t i = 0; i < error_m.size(); ++i)
            error_m.data()[i] = static_cast<float>(shared_sigma_m * rng.normal());
        for (int iy = 0; iy < geometry.ny; ++iy) {
            for (int ix = 0; ix < geometry.nx; ++ix) {
                height_m.at(ix, iy) += error_m.at(ix / shared, iy / shared) +
                                       static_cast<float>(cell_sigma_m * rng.normal());
                var_m2.at(ix, iy) = static_cast<float>(cell_sigma_m * cell_sigma_m +
                                                       shared_sigma_m * shared_sigma_m);
            }
        }
        return *this;
    }
    [[nodiscard]] Terrain terrain() const {
        Terrain terrain;
        terrain.geometry = geometry;
        terrain.height_m = height_m.view();
        terrain.height_var_m2 = var_m2.view();
        terrain.clearance_m = clearance_m.view();
        terrain.stance_m = stance_m;
        return terrain;
    }
};

struct DoorPlan {
    Vector2d middle_m = Vector2d::Zero();
    double yaw_rad = 0.0;  ///< direction through the door
    double width_m = 0.9;
    double depth_m = 0.12;
    double sill_m = 0.0;
    double wall_length_m = 1.2;
    double wall_height_m = kWall_m;

    [[nodiscard]] Vector2d along() const { return {std::cos(yaw_rad), std::sin(yaw_rad)}; }
    [[nodiscard]] Vector2d left() const { return {-along().y(), along().x()}; }
};

void add_door(World& world, const DoorPlan& plan) {
    for (const double side : {-1.0, 1.0}) {
        const double away_m = side * 0.5 * (plan.width_m + plan.wall_length_m);
        world.add({plan.middle_m + away_m * plan.left(),
                   plan.yaw_rad,
                   plan.depth_m,
                   plan.wall_length_m,
                   plan.wall_height_m});
    }
    if (plan.sill_m > 0.0)
        world.add({plan.middle_m, plan.yaw_rad, plan.depth_m, plan.width_m, plan.sill_m});
}

struct Found {
    std::vector<Door> doors;
    std::vector<LineFeature> sills;
};

Found find(const World& world, const DoorConfig& config = {}) {
    Found found;
    DoorFinder(config).find(world.terrain(), found.doors, found.sills);
    return found;
}

Found find(const DoorPlan& plan, double cell_m = kCell_m) {
    World world(cell_m);
    add_door(world, plan);
    return find(world);
}

double angle_between_rad(double a, double b) {
    return std::abs(std::remainder(a - b, 2.0 * std::numbers::pi));
}

/// The error of each jamb is uniform over one cell, centred on the measured position.
TEST(Doors, WidthIsExactToACellInWallsAlongTheGrid) {
    double sum_m = 0.0;
    int count = 0;
    for (const double turn : {0.0, 90.0}) {
        for (int shift = 0; shift < 10; ++shift) {
            for (int more = 0; more < 5; ++more) {
                DoorPlan plan;
                plan.yaw_rad = turn * kRadPerDeg;
                plan.width_m = 0.80 + 0.2 * more * kCell_m;
                plan.middle_m = (0.03 + 0.1 * shift) * kCell_m * plan.left();
                const Found found = find(plan);
                ASSERT_EQ(found.doors.size(), 1U) << turn << ' ' << shift << ' ' << more;
                const double error_m = found.doors[0].width_m - plan.width_m;
                EXPECT_LE(std::abs(error_m), kCell_m + 1e-6) << turn << ' ' << shift;
                EXPECT_NEAR(found.doors[0].width_sigma_m, 0.013, 0.002);
                sum_m += error_m;
                ++count;
            }
        }
    }
    // The positions within a cell are sampled in steps of a tenth of a cell, on both sides.
    EXPECT_NEAR(sum_m / count, 0.0, 0.1 * kCell_m);
}

/// Rows of an oblique wall end at different positions within a cell, so their mean is more accurate
/// than half a cell. At 45 deg all rows end at the same position of a shorter cell.
TEST(Doors, WidthIsExactToTenMillimetresInObliqueWalls) {
    for (const double yaw_deg : {12.0, 20.0, 33.0, 45.0, 61.0, 80.0, 110.0, 135.0, 160.0}) {
        const double tolerance_m =
            std::fmod(yaw_deg, 90.0) == 45.0 ? kCell_m / std::numbers::sqrt2 : 0.010;
        for (int shift = 0; shift < 6; ++shift) {
            DoorPlan plan;
            plan.yaw_rad = yaw_deg * kRadPerDeg;
            plan.width_m = 0.76 + 0.11 * shift;
            plan.middle_m = shift * Vector2d(0.0041, -0.0067);
            const Found found = find(plan);
            ASSERT_EQ(found.doors.size(), 1U) << yaw_deg << ' ' << shift;
            EXPECT_NEAR(found.doors[0].width_m, plan.width_m, tolerance_m)
                << yaw_deg << ' ' << shift;
        }
    }
}

TEST(Doors, WidthIsExactToACellAtEveryResolution) {
    for (const double cell_m : {0.005, 0.01, 0.02, 0.05}) {
        for (const double yaw_deg : {0.0, 25.0}) {
            DoorPlan plan;
            plan.yaw_rad = yaw_deg * kRadPerDeg;
            plan.middle_m = {0.013, 0.004};
            plan.depth_m = 0.15;
            const Found found = find(plan, cell_m);
            ASSERT_EQ(found.doors.size(), 1U) << cell_m << ' ' << yaw_deg;
            EXPECT_NEAR(found.doors[0].width_m, plan.width_m, cell_m) << yaw_deg;
        }
    }
}

TEST(Doors, PoseLeadsThroughTheMiddleAwayFromTheStance) {
    for (const double yaw_deg : {0.0, 18.0, -40.0}) {
        for (int shift = 0; shift < 8; ++shift) {
            DoorPlan plan;
            plan.yaw_rad = yaw_deg * kRadPerDeg;
            plan.middle_m = Vector2d(0.21, -0.13) + 0.00625 * shift * plan.left();
            World world;
            add_door(world, plan);
            for (const bool turned : {false, true}) {
                world.stance_m = plan.middle_m + (turned ? 1.5 : -1.5) * plan.along();
                const Found found = find(world);
                ASSERT_EQ(found.doors.size(), 1U) << yaw_deg;
                const FeaturePose& pose = found.doors[0].pose;
                const double yaw_rad = plan.yaw_rad + (turned ? std::numbers::pi : 0.0);
                EXPECT_LT(angle_between_rad(pose.yaw_rad, yaw_rad), 1.0 * kRadPerDeg) << yaw_deg;
                const Vector2d error_m = pose.p_m.head<2>() - plan.middle_m;
                // The error of each jamb is at most half a cell. The error of the middle is half of
                // their sum.
                EXPECT_LT(std::abs(error_m.dot(plan.left())), 0.5 * kCell_m + 1e-6) << yaw_deg;
                EXPECT_LT(std::abs(error_m.dot(plan.along())), kCell_m) << yaw_deg;
                EXPECT_EQ(pose.p_m.z(), 0.0);
            }
        }
    }
}

TEST(Doors, TheGridMayBeTurnedAndMirrored) {
    World world;
    DoorPlan plan;
    plan.yaw_rad = 8.0 * kRadPerDeg;
    plan.middle_m = {0.3, 0.11};
    plan.sill_m = 0.02;
    add_door(world, plan);
    Rng rng(3);
    world.add_noise(rng, 0.003, 0.0);
    const Found first = find(world);
    ASSERT_EQ(first.doors.size(), 1U);
    for (int mode = 1; mode < 8; ++mode) {
        World other = world;
        const int last = world.geometry.nx - 1;
        for (int iy = 0; iy <= last; ++iy) {
            for (int ix = 0; ix <= last; ++ix) {
                const int jx = (mode & 1) != 0 ? last - ix : ix;
                const int jy = (mode & 2) != 0 ? last - iy : iy;
                const bool swapped = (mode & 4) != 0;
                other.height_m.at(swapped ? jy : jx, swapped ? jx : jy) = world.height_m.at(ix, iy);
            }
        }
        Vector2d stance_m((mode & 1) != 0 ? -world.stance_m.x() : world.stance_m.x(),
                          (mode & 2) != 0 ? -world.stance_m.y() : world.stance_m.y());
        if ((mode & 4) != 0) std::swap(stance_m.x(), stance_m.y());
        other.stance_m = stance_m;
        const Found found = find(other);
        ASSERT_EQ(found.doors.size(), 1U) << mode;
        EXPECT_NEAR(found.doors[0].width_m, first.doors[0].width_m, 1e-9) << mode;
        EXPECT_NEAR(found.doors[0].sill_m, first.doors[0].sill_m, 0.001) << mode;
    }
}

TEST(Doors, NearestToTheStanceFirst) {
    World world;
    DoorPlan plan;
    plan.wall_length_m = 0.6;
    for (const double x_m : {1.2, -0.4}) {
        plan.middle_m = {x_m, 0.0};
        add_door(world, plan);
    }
    world.stance_m = {2.3, 0.0};
    const Found found = find(world);
    ASSERT_EQ(found.doors.size(), 2U);
    EXPECT_NEAR(found.doors[0].pose.p_m.x(), 1.2, kCell_m);
    EXPECT_NEAR(found.doors[1].pose.p_m.x(), -0.4, kCell_m);
}

/// Noise of 3 mm per cell and 2 mm shared by squares of 0.1 m. The mean over 0.75 m x 0.05 m has a
/// sigma of 1 mm, and so has the ground beside it.
TEST(Doors, SillsOf20mmAreFoundInNoiseAndFloorsHaveNone) {
    constexpr int kSeeds = 40;
    int found_sills = 0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        Rng rng(static_cast<std::uint64_t>(seed));
        DoorPlan plan;
        plan.yaw_rad = (seed * 17 % 90) * kRadPerDeg;
        plan.depth_m = 0.09 + 0.01 * (seed % 10);
        for (const double sill_m : {0.0, 0.02}) {
            plan.sill_m = sill_m;
            World world;
            add_door(world, plan);
            world.add_noise(rng, 0.003, 0.002);
            const Found found = find(world);
            ASSERT_EQ(found.doors.size(), 1U) << seed;
            const Door& door = found.doors[0];
            EXPECT_NEAR(door.pose.p_m.z(), 0.0, 0.002) << seed;
            if (sill_m == 0.0) {
                EXPECT_EQ(door.sill_m, 0.0) << seed;
                EXPECT_TRUE(found.sills.empty()) << seed;
                continue;
            }
            ASSERT_EQ(found.sills.size(), 1U) << seed;
            ++found_sills;
            EXPECT_NEAR(door.sill_m, sill_m, 3.4 * door.sill_sigma_m) << seed;
            EXPECT_LT(door.sill_sigma_m, 0.003) << seed;
            const LineFeature& line = found.sills[0];
            EXPECT_EQ(line.height_m, door.sill_m);
            EXPECT_EQ(line.length_m, door.width_m);
            EXPECT_LT((line.pose.p_m.head<2>() - plan.middle_m).norm(), 0.5 * plan.depth_m + 0.05);
            EXPECT_EQ(line.pose.yaw_rad, door.pose.yaw_rad);
        }
    }
    EXPECT_EQ(found_sills, kSeeds);
}

/// Behind a sill a matcher returns to the floor only after 0.2 m or more.
TEST(Doors, ASillIsOneWhateverAMatcherMakesOfTheGroundBehindIt) {
    for (const double reach_m : {0.1, 0.2}) {
        DoorPlan plan;
        plan.sill_m = 0.04;
        World world;
        add_door(world, plan);
        world.each([&](const Vector2d& p_m, float& z_m) {
            const double behind_m = p_m.x() - 0.5 * plan.depth_m;
            if (behind_m > 0.0 && z_m < 0.02F)
                z_m = static_cast<float>(plan.sill_m * std::max(0.0, 1.0 - behind_m / reach_m));
        });
        const Found found = find(world);
        ASSERT_EQ(found.sills.size(), 1U) << reach_m;
        EXPECT_NEAR(found.sills[0].height_m, plan.sill_m, 0.003) << reach_m;
        EXPECT_NEAR(found.doors[0].sill_m, plan.sill_m, 0.003) << reach_m;
    }
}

/// A higher floor behind the door is no sill, but a foot meets the step.
TEST(Doors, AStepInADoorIsNoSill) {
    for (const double step_m : {0.06, -0.06}) {
        World world;
        DoorPlan plan;
        add_door(world, plan);
        world.each([&](const Vector2d& p_m, float& z_m) {
            if (p_m.x() > 0.0 && z_m < 1.0F) z_m = static_cast<float>(step_m);
        });
        const Found found = find(world);
        ASSERT_EQ(found.doors.size(), 1U) << step_m;
        EXPECT_TRUE(found.sills.empty()) << step_m;
        EXPECT_NEAR(found.doors[0].sill_m, std::max(0.0, step_m), 0.001) << step_m;
        EXPECT_EQ(found.doors[0].pose.p_m.z(), 0.0);
    }
}

TEST(Doors, ARampBehindADoorIsNoSill) {
    for (const double slope : {0.083, -0.083}) {
        World world;
        add_door(world, {});
        world.each([&](const Vector2d& p_m, float& z_m) {
            if (p_m.x() > 0.0 && z_m < 1.0F) z_m = static_cast<float>(slope * p_m.x());
        });
        const Found found = find(world);
        ASSERT_EQ(found.doors.size(), 1U) << slope;
        EXPECT_TRUE(found.sills.empty()) << slope;
    }
}

TEST(Doors, ClearanceIsWhatWasSeenAboveTheOpening) {
    World world;
    add_door(world, {});
    EXPECT_TRUE(std::isnan(find(world).doors.at(0).clearance_m));
    const int middle = world.geometry.nx / 2;
    world.clearance_m.at(middle, middle + 2) = 1.2F;  // a single wrong match
    EXPECT_TRUE(std::isnan(find(world).doors.at(0).clearance_m));
    for (int ix = middle - 3; ix < middle + 3; ++ix)
        for (int iy = middle - 18; iy < middle + 18; ++iy) world.clearance_m.at(ix, iy) = 2.03F;
    world.clearance_m.at(middle, middle + 2) = 1.2F;
    EXPECT_FLOAT_EQ(static_cast<float>(find(world).doors.at(0).clearance_m), 2.03F);
}

TEST(Doors, NothingIsFoundInEmptyMaps) {
    World unknown;
    unknown.height_m.fill(kNanF);
    EXPECT_TRUE(find(unknown).doors.empty());
    EXPECT_TRUE(find(World()).doors.empty());
    for (const double side_m : {0.0, kCell_m, 2 * kCell_m})
        EXPECT_TRUE(find(World(kCell_m, side_m)).doors.empty());
    unknown.height_m.at(100, 100) = 2.0F;
    EXPECT_TRUE(find(unknown).doors.empty());
}

TEST(Doors, NoneInNoise) {
    for (int seed = 1; seed <= 10; ++seed) {
        Rng rng(static_cast<std::uint64_t>(seed));
        for (const double sigma_m : {0.01, 0.1, 0.5}) {
            World world;
            world.add_noise(rng, sigma_m, 0.5 * sigma_m);
            EXPECT_TRUE(find(world).doors.empty()) << seed << ' ' << sigma_m;
        }
    }
}

/// Objects that form no door, each beside a variant that forms one.
TEST(Doors, WallsMustFaceEachOtherInOneLine) {
    const Box left{{0.0, 1.05}, 0.0, 0.12, 1.2, kWall_m};
    const Box right{{0.0, -1.05}, 0.0, 0.12, 1.2, kWall_m};
    EXPECT_EQ(find(World().add(left).add(right)).doors.size(), 1U);
    EXPECT_TRUE(find(World().add(left)).doors.empty());
    Box other = right;
    other.middle_m.x() = 0.5;  // not in line with the left wall
    EXPECT_TRUE(find(World().add(left).add(other)).doors.empty());
    other = right;
    other.width_m = 0.1;  // a post
    other.middle_m.y() = -0.5;
    EXPECT_TRUE(find(World().add(left).add(other)).doors.empty());
    other = right;
    other.top_m = 0.4;  // a bench
    EXPECT_TRUE(find(World().add(left).add(other)).doors.empty());
    other = {{0.0, -0.85}, 0.0, 1.4, 0.8, 0.72};  // a table
    EXPECT_TRUE(find(World().add(left).add(other)).doors.empty());
}

/// A wall that meets the opening from one side can be passed.
TEST(Doors, AWallThatLeadsToTheOpeningIsNoJamb) {
    const Box right{{0.0, -1.05}, 0.0, 0.12, 1.2, kWall_m};
    for (const double side : {-1.0, 1.0}) {
        const Box wall{{side * 0.54, 0.65}, 0.0, 1.2, 0.4, kWall_m};
        EXPECT_TRUE(find(World().add(wall).add(right)).doors.empty()) << side;
    }
}

TEST(Doors, AWrongMatchInTheOpeningHidesNoDoor) {
    World world;
    DoorPlan plan;
    add_door(world, plan);
    for (const float wrong_m : {1.0F, -1.0F}) {
        world.height_m.at(world.geometry.nx / 2, world.geometry.ny / 2 + 3) = wrong_m;
        const Found found = find(world);
        ASSERT_EQ(found.doors.size(), 1U) << wrong_m;
        EXPECT_NEAR(found.doors[0].width_m, plan.width_m, kCell_m + 1e-6);
        EXPECT_EQ(found.doors[0].sill_m, 0.0);
    }
}

TEST(Doors, ThingsInTheWayToADoorDoNotHideIt) {
    DoorPlan plan;
    plan.yaw_rad = 40.0 * kRadPerDeg;
    World world;
    add_door(world, plan);
    world.add({-0.65 * plan.along(), plan.yaw_rad, 0.2, 0.5, 0.6});
    const Found found = find(world);
    ASSERT_EQ(found.doors.size(), 1U);
    EXPECT_NEAR(found.doors[0].width_m, plan.width_m, kCell_m);
}

/// Matchers mix a jamb with the objects beside it.
TEST(Doors, GhostsBehindAJambDoNotTurnTheWall) {
    Rng rng(5);
    DoorPlan plan;
    plan.depth_m = 0.06;
    World world;
    add_door(world, plan);
    world.each([&](const Vector2d& p_m, float& z_m) {
        const bool behind = p_m.x() > 0.03 && p_m.x() < 0.3 && p_m.y() > 0.5 && p_m.y() < 0.8;
        if (behind && rng.uniform() < 0.5) z_m = 0.5F;
    });
    const Found found = find(world);
    ASSERT_EQ(found.doors.size(), 1U);
    EXPECT_LT(angle_between_rad(found.doors[0].pose.yaw_rad, plan.yaw_rad), 1.0 * kRadPerDeg);
}

TEST(Doors, ThingsBesideTheWallDoNotTurnIt) {
    DoorPlan plan;
    World world;
    add_door(world, plan);
    world.add({{-0.6, 1.1}, 0.0, 0.3, 0.8, 0.7});
    const Found found = find(world);
    ASSERT_EQ(found.doors.size(), 1U);
    EXPECT_LT(angle_between_rad(found.doors[0].pose.yaw_rad, plan.yaw_rad), 1.0 * kRadPerDeg);
}

/// The wall may begin anywhere in the unknown cells.
TEST(Doors, AJambBehindUnknownCellsIsNotMeasured) {
    World world;
    add_door(world, {});
    world.each([&](const Vector2d& p_m, float& z_m) {
        if (std::abs(p_m.y() - 0.41) < 0.05) z_m = kNanF;
    });
    EXPECT_TRUE(find(world).doors.empty());
}

/// The end of a table may be narrow, and the wall beside it leads on.
TEST(Doors, AWallBesideATableIsNoDoor) {
    const Box wall{{0.0, 0.5}, 0.0, 5.0, 0.12, kWall_m};
    for (const double table_m : {0.3, 0.8}) {
        const Box table{{0.0, -0.95}, 0.0, table_m, 1.0, 0.72};
        EXPECT_TRUE(find(World().add(wall).add(table)).doors.empty()) << table_m;
    }
}

TEST(Doors, OpeningsOfOtherSizesAreNoDoors) {
    DoorPlan plan;
    for (const double width_m : {0.4, 0.55, 1.45, 1.8}) {
        plan.width_m = width_m;
        EXPECT_TRUE(find(plan).doors.empty()) << width_m;
    }
    plan.width_m = 0.9;
    for (const double depth_m : {0.05, 0.3}) {
        plan.depth_m = depth_m;
        EXPECT_EQ(find(plan).doors.size(), 1U) << depth_m;
    }
    for (const double depth_m : {0.8, 3.0}) {  // a corridor
        plan.depth_m = depth_m;
        EXPECT_TRUE(find(plan).doors.empty()) << depth_m;
    }
}

TEST(Doors, ANicheIsNoDoor) {
    World world;
    add_door(world, {});
    world.add({{0.36, 0.0}, 0.0, 0.12, 3.3, kWall_m});
    EXPECT_TRUE(find(world).doors.empty());
}

TEST(Doors, TheGroundIsKnownOnBothSides) {
    for (const double side : {-1.0, 1.0}) {
        World world;
        add_door(world, {});
        world.each([&](const Vector2d& p_m, float& z_m) {
            if (side * p_m.x() > 0.15) z_m = kNanF;
        });
        EXPECT_TRUE(find(world).doors.empty()) << side;
    }
    World between;
    add_door(between, {});
    between.each([&](const Vector2d& p_m, float& z_m) {
        if (p_m.x() > -0.03 && p_m.x() < 0.2 && std::abs(p_m.y()) < 0.44) z_m = kNanF;
    });
    EXPECT_TRUE(find(between).doors.empty());
    World high;
    add_door(high, {});
    high.each([&](const Vector2d& p_m, float& z_m) {
        if (p_m.x() > 0.0 && z_m < 1.0F) z_m = -0.5F;
    });
    EXPECT_TRUE(find(high).doors.empty());
}

/// The heights and the positions of wall cells scatter.
TEST(Doors, WallsMayScatter) {
    for (int seed = 1; seed <= 20; ++seed) {
        Rng rng(static_cast<std::uint64_t>(seed));
        DoorPlan plan;
        plan.yaw_rad = (seed % 12) * kRadPerDeg;
        World world;
        add_door(world, plan);
        world.each([&](const Vector2d& p_m, float& z_m) {
            if (z_m > 1.0F) z_m = rng.uniform() < 0.2 ? kNanF : static_cast<float>(rng.uniform());
            const double before_m = -(p_m - plan.middle_m).dot(plan.along()) - 0.06;
            const double beside_m = std::abs((p_m - plan.middle_m).dot(plan.left()));
            const bool near_wall = beside_m > 0.5 && beside_m < 1.6 && std::abs(before_m) < 0.1;
            if (near_wall && rng.uniform() < 0.3) z_m = static_cast<float>(rng.uniform());
        });
        world.add_noise(rng, 0.003, 0.002);
        const Found found = find(world);
        ASSERT_EQ(found.doors.size(), 1U) << seed;
        // Rows that miss the first cell of a wall end half a cell later on average, on both sides.
        EXPECT_NEAR(found.doors[0].width_m, plan.width_m, 2.0 * kCell_m) << seed;
        EXPECT_TRUE(found.sills.empty()) << seed;
    }
}

TEST(Doors, OneFinderServesMapsOfAllSizes) {
    DoorFinder finder{DoorConfig{}};
    Found found;
    for (const double cell_m : {0.02, 0.05, 0.025, 0.02}) {
        World world(cell_m);
        add_door(world, {});
        finder.find(world.terrain(), found.doors, found.sills);
        const Found fresh = find(world);
        ASSERT_EQ(found.doors.size(), 1U) << cell_m;
        EXPECT_EQ(found.doors[0].width_m, fresh.doors.at(0).width_m) << cell_m;
    }
    finder.find(World().terrain(), found.doors, found.sills);
    EXPECT_TRUE(found.doors.empty());
}

TEST(DoorConfig, SaysWhatCannotBe) {
    EXPECT_FALSE(DoorConfig{}.problem());
    DoorConfig config;
    config.max_width_m = 0.5;
    EXPECT_EQ(config.problem(),
              "stairs.doors.max_width_m = 0.5 must not be below "
              "stairs.doors.min_width_m = 0.6");
    config = {};
    config.wall_height_m = 0.1;
    EXPECT_EQ(config.problem(),
              "stairs.doors.wall_height_m = 0.1 must not be below stairs.doors.rise_m = 0.2");
}

}  // namespace
}  // namespace surefoot::stairs
