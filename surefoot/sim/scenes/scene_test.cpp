// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/scene.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRounding_m = 1e-9;

/// One solid of each kind; no solid is nearer than 5 mm to the edge of another.
std::vector<Primitive> one_of_everything() {
    return {
        Floor({{-2.0, -2.0}, {4.0, 2.0}}, 0.0, {Pit{{{0.5, -1.5}, {1.5, -0.5}}, 0.3}}),
        make_box({1.0, 1.0}, {0.8, 0.6}, 0.0, 0.4),
        make_box({2.5, -1.0}, {0.7, 0.5}, 0.5, 0.55, 0.7),
        make_ramp({2.0, 0.6}, 1.2, 0.8, 0.0, 0.3, 0.4),
        Cylinder({-0.5, 0.5}, 0.2, 0.0, 0.7),
        Prism({{-1.5, -1.5}, {-0.7, -1.4}, {-1.2, -0.6}}, 0.0, {0.25, {0.1, -0.05}, {-1.1, -1.1}})};
}

Scene scene_of(const std::vector<Primitive>& primitives) {
    Scene scene;
    const int material = scene.add_material({});
    for (const Primitive& primitive : primitives) scene.add(primitive, material, Label::object);
    return scene;
}

std::optional<Column> column_of(const Primitive& primitive, double x_m, double y_m) {
    return std::visit([&](const auto& shape) { return shape.column(x_m, y_m); }, primitive);
}

/// Whether the point is inside a solid, or on or below a floor. Uses columns only: an oracle for
/// rays.
bool occupied(const std::vector<Primitive>& primitives, const Vector3d& p) {
    for (const Primitive& primitive : primitives) {
        const auto column = column_of(primitive, p.x(), p.y());
        if (!column || p.z() > column->top_m) continue;
        if (std::holds_alternative<Floor>(primitive) || p.z() >= column->bottom_m) return true;
    }
    return false;
}

Vector3d random_direction(Rng& rng) {
    const Vector3d d(rng.normal(), rng.normal(), rng.normal());
    return d.normalized();
}

TEST(SceneTest, RaysEndWhereMarchingEntersASolid) {
    const auto primitives = one_of_everything();
    const Scene scene = scene_of(primitives);
    constexpr double kStep_m = 0.002;
    constexpr double kLimit_m = 6.0;
    Rng rng(7);
    int hits = 0;
    for (int i = 0; i < 3000; ++i) {
        const Vector3d origin(
            rng.uniform(-1.8, 3.8), rng.uniform(-1.8, 1.8), rng.uniform(0.01, 1.2));
        if (occupied(primitives, origin)) continue;
        const Vector3d direction = random_direction(rng);
        double marched_m = kStep_m;
        while (marched_m < kLimit_m && !occupied(primitives, origin + marched_m * direction)) {
            marched_m += kStep_m;
        }
        const auto hit = scene.intersect(origin, direction);
        const double cast_m = hit ? hit->distance_m : kLimit_m;
        // Marching steps over corners that a ray cuts for less than one step, never the other way.
        if (cast_m < marched_m - kStep_m) {
            ASSERT_TRUE(hit);
            const Vector3d inside = hit->point_m + 1e-7 * direction;
            EXPECT_TRUE(occupied(primitives, inside)) << "ray " << i << " ends in the air";
        } else {
            EXPECT_LE(std::min(cast_m, kLimit_m), marched_m + kRounding_m) << "ray " << i;
        }
        hits += hit.has_value() ? 1 : 0;
    }
    EXPECT_GT(hits, 1000);
}

TEST(SceneTest, HitsLieOnTheirFaceAndLookAtTheOrigin) {
    const Scene scene = scene_of(one_of_everything());
    Rng rng(8);
    for (int i = 0; i < 3000; ++i) {
        const Vector3d origin(
            rng.uniform(-1.8, 3.8), rng.uniform(-1.8, 1.8), rng.uniform(0.8, 1.4));
        const Vector3d direction = random_direction(rng);
        const auto hit = scene.intersect(origin, direction);
        if (!hit) continue;
        EXPECT_LT(hit->at.normal.dot(direction), 0.0) << "surface " << hit->surface;
        EXPECT_NEAR(hit->at.normal.dot(hit->at.tangent_u), 0.0, kRounding_m);
        EXPECT_NEAR(hit->at.normal.dot(hit->at.tangent_v), 0.0, kRounding_m);
        EXPECT_NEAR((hit->point_m - origin).norm(), hit->distance_m, kRounding_m);
        EXPECT_TRUE(scene.blocked(origin, direction, hit->distance_m + 1e-6));
        EXPECT_FALSE(scene.blocked(origin, direction, hit->distance_m - 1e-6));
    }
}

TEST(SceneTest, APlumbLineFromAboveMeetsTheHighestSurface) {
    const Scene scene = scene_of(one_of_everything());
    Rng rng(9);
    for (int i = 0; i < 4000; ++i) {
        const double x_m = rng.uniform(-2.2, 4.2);
        const double y_m = rng.uniform(-2.2, 2.2);
        const auto hit = scene.intersect({x_m, y_m, 5.0}, -Vector3d::UnitZ());
        const auto height = scene.height_at(x_m, y_m);
        ASSERT_EQ(hit.has_value(), height.has_value()) << x_m << " " << y_m;
        if (!hit) continue;
        EXPECT_NEAR(hit->point_m.z(), height->z_m, kRounding_m) << x_m << " " << y_m;
        EXPECT_EQ(hit->surface, height->surface);
        const auto all = scene.surfaces_at(x_m, y_m);
        ASSERT_FALSE(all.empty());
        EXPECT_EQ(all.front().z_m, height->z_m);
    }
}

TEST(SceneTest, SurfacesUnderATableAreListedAndBuriedOnesAreNot) {
    const Scene scene = scene_of(one_of_everything());
    const auto below_table = scene.surfaces_at(2.5, -1.0);
    ASSERT_EQ(below_table.size(), 2U);
    EXPECT_EQ(below_table[0].z_m, 0.55);
    EXPECT_EQ(below_table[1].z_m, 0.0);
    const auto on_box = scene.surfaces_at(1.0, 1.0);
    ASSERT_EQ(on_box.size(), 1U);
    EXPECT_EQ(on_box[0].z_m, 0.4);
    EXPECT_TRUE(scene.surfaces_at(20.0, 0.0).empty());
}

TEST(SceneTest, RimsBelongToTheHigherSurface) {
    const Scene scene = scene_of(one_of_everything());
    EXPECT_EQ(scene.height_at(0.6, 1.0)->z_m, 0.4);  // front face of the box
    EXPECT_EQ(scene.height_at(0.6 - 1e-6, 1.0)->z_m, 0.0);
    EXPECT_EQ(scene.height_at(0.5, -1.0)->z_m, 0.0);  // rim of the pit
    EXPECT_EQ(scene.height_at(0.5 + 1e-6, -1.0)->z_m, -0.3);
}

TEST(SceneTest, HighestOverACellEqualsDenseSampling) {
    const Scene scene = scene_of(one_of_everything());
    constexpr double kCell_m = 0.05;
    constexpr int kSamples = 60;
    Rng rng(10);
    int below = 0;
    constexpr int kCells = 1500;
    for (int i = 0; i < kCells; ++i) {
        const Vector2d low(-2.0 + kCell_m * static_cast<double>(rng.below(120)),
                           -2.0 + kCell_m * static_cast<double>(rng.below(80)));
        const auto exact = scene.highest_over({low, low.array() + kCell_m});
        double sampled_m = -std::numeric_limits<double>::infinity();
        for (int k = 0; k < kSamples * kSamples; ++k) {
            const int row = k / kSamples;
            const double x_m = low.x() + kCell_m * (k % kSamples + 0.5) / kSamples;
            const double y_m = low.y() + kCell_m * (row + 0.5) / kSamples;
            if (const auto z = scene.height_at(x_m, y_m)) sampled_m = std::max(sampled_m, z->z_m);
        }
        ASSERT_TRUE(exact) << low.transpose();
        EXPECT_GE(*exact, sampled_m - kRounding_m) << low.transpose();
        // Steepest slope here is 0.25; samples miss at most one spacing of it in each direction.
        const double spacing_m = 0.25 * 2.0 * kCell_m / kSamples;
        if (*exact > sampled_m + spacing_m) ++below;
    }
    // Turned edges may cut less off a cell than the samples can see.
    EXPECT_LE(below, kCells / 200);
}

TEST(SceneTest, ACellThatOnlyTouchesAStepStaysOnTheFloor) {
    Scene scene;
    const int material = scene.add_material({});
    scene.add(Floor({{-1.0, -1.0}, {1.0, 1.0}}, 0.0), material, Label::floor);
    scene.add(make_box({0.25, 0.0}, {0.5, 1.0}, 0.0, 0.18), material, Label::step);
    EXPECT_EQ(scene.highest_over({{-0.025, 0.0}, {0.0, 0.025}}), 0.0);
    EXPECT_EQ(scene.highest_over({{0.0, 0.0}, {0.025, 0.025}}), 0.18);
    EXPECT_FALSE(scene.highest_over({{1.0, 0.0}, {1.025, 0.025}}));
}

TEST(SceneTest, NothingIsMetFromInsideOrAlongNaN) {
    const Scene scene = scene_of(one_of_everything());
    Scene box;
    box.add(make_box({0.0, 0.0}, {1.0, 1.0}, 0.0, 1.0), box.add_material({}), Label::object);
    EXPECT_FALSE(box.intersect({0.0, 0.0, 0.5}, Vector3d::UnitX()));
    EXPECT_FALSE(box.intersect({2.0, 0.0, 0.5}, Vector3d::UnitX()));
    EXPECT_FALSE(Scene().intersect({0.0, 0.0, 1.0}, -Vector3d::UnitZ()));
    const Vector3d nan = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    for (const Vector3d& origin : {Vector3d(-0.5, 0.5, 2.0), Vector3d(1.0, -1.0, 1.0)}) {
        EXPECT_FALSE(scene.intersect(origin, nan));
    }
}

TEST(SceneTest, CylinderCoordinatesMeasureArcAndHeight) {
    Scene scene;
    scene.add(Cylinder({1.0, 0.0}, 0.5, 0.0, 2.0), scene.add_material({}), Label::object);
    const auto hit = scene.intersect({1.0, -3.0, 0.7}, Vector3d::UnitY());
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->distance_m, 2.5, kRounding_m);
    EXPECT_NEAR(hit->at.u_m, -0.5 * std::acos(-1.0) / 2.0, kRounding_m);
    EXPECT_NEAR(hit->at.v_m, 0.7, kRounding_m);
}

}  // namespace
}  // namespace surefoot::sim
