// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/beam.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "surefoot/core/rng.hpp"
#include "surefoot/sim/scenes/primitives.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

Vector3d in_cube(Rng& rng, double half) {
    return {rng.uniform(-half, half), rng.uniform(-half, half), rng.uniform(-half, half)};
}

/// A beam and rays that lie in it.
struct Case {
    Vector3d tip_m;
    Vector3d axis;
    double half_angle_rad;
    double tip_radius_m;

    explicit Case(Rng& rng)
        : tip_m(in_cube(rng, 3.0)),
          axis(in_cube(rng, 1.0).normalized()),
          half_angle_rad(rng.uniform(0.005, 0.3)),
          tip_radius_m(rng.uniform() < 0.5 ? 0.0 : rng.uniform(0.0, 0.05)) {}

    [[nodiscard]] Beam beam() const { return {tip_m, axis, half_angle_rad, tip_radius_m}; }
    [[nodiscard]] Vector3d origin(Rng& rng) const {
        return tip_m + rng.uniform(0.0, tip_radius_m) * in_cube(rng, 1.0).normalized();
    }
    [[nodiscard]] Vector3d direction(Rng& rng) const {
        const Vector3d side = axis.cross(in_cube(rng, 1.0)).normalized();
        return Eigen::AngleAxisd(half_angle_rad * std::sqrt(rng.uniform()), side) * axis;
    }
};

RayHit cast(const Primitive& primitive, const Vector3d& origin_m, const Vector3d& direction) {
    RayHit hit;
    std::visit(
        [&](const auto& s) {
            s.intersect(origin_m, {&direction, 1}, 0, {&hit, 1});
        },
        primitive);
    return hit;
}

std::vector<Primitive> shapes(Rng& rng) {
    const Eigen::Vector2d middle_m(rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0));
    const double top_m = rng.uniform(-0.5, 1.5);
    const Pit pit{{middle_m, middle_m + Eigen::Vector2d(0.5, 0.8)}, 0.3};
    return {
        make_box(middle_m, {1.0, 2.0}, -1.0, top_m, rng.uniform(0.0, 3.0)),
        make_ramp(middle_m, 2.0, 1.5, -0.5, 0.8, rng.uniform(0.0, 3.0)),
        Cylinder(middle_m, 0.4, -0.5, top_m),
        Floor({{-4.0, -4.0}, {4.0, 4.0}}, -0.6, {pit}),
    };
}

/// Checks the proofs of a beam: if it misses an object, no ray hits the object. If all its rays hit
/// one face, no ray hits anything else, and the distance is exactly equal.
TEST(BeamTest, WhatABeamProvesHoldsForItsRays) {
    Rng rng(7);
    int missed_spheres = 0;
    int missed_hulls = 0;
    int single_faces = 0;
    for (int i = 0; i < 3000; ++i) {
        const Case c(rng);
        const Beam beam = c.beam();
        for (const Primitive& shape : shapes(rng)) {
            const bool misses_sphere =
                beam.misses(std::visit([](const auto& s) { return s.bounds(); }, shape));
            const bool misses_hull =
                beam.misses(std::visit([](const auto& s) { return s.hull(); }, shape));
            const auto plane = std::visit([&](const auto& s) { return s.only_face(beam); }, shape);
            missed_spheres += misses_sphere ? 1 : 0;
            missed_hulls += misses_hull ? 1 : 0;
            single_faces += plane ? 1 : 0;
            for (int k = 0; k < 20; ++k) {
                const Vector3d origin_m = c.origin(rng);
                const Vector3d direction = c.direction(rng);
                const RayHit hit = cast(shape, origin_m, direction);
                ASSERT_FALSE(hit.face >= 0 && (misses_sphere || misses_hull));
                if (!plane) continue;
                ASSERT_EQ(hit.face, plane->face) << "case " << i << " shape " << shape.index();
                ASSERT_EQ(hit.distance_m,
                          -(plane->normal.dot(origin_m) - plane->offset_m) /
                              plane->normal.dot(direction));
            }
        }
    }
    EXPECT_GT(missed_spheres, 4000);
    EXPECT_GT(missed_hulls, 6000);
    EXPECT_GT(single_faces, 300);
}

/// Hulls are tighter than spheres: a beam along a wall misses the wall but not its bounding sphere.
TEST(BeamTest, ABeamAlongAWallMissesIt) {
    const Prism wall = make_box({0.0, 1.0}, {10.0, 0.1}, 0.0, 2.5);
    const Beam beam({-4.0, 0.0, 1.0}, Vector3d::UnitX(), 0.03, 0.0);
    EXPECT_FALSE(beam.misses(wall.bounds()));
    EXPECT_TRUE(beam.misses(wall.hull()));
    EXPECT_FALSE(Beam({-4.0, 0.0, 1.0}, Vector3d::UnitX(), 0.3, 0.0).misses(wall.hull()));
}

TEST(BeamTest, ATipThatMayMoveFarProvesLess) {
    const Floor floor({{-1.0, -1.0}, {1.0, 1.0}}, 0.0);
    const Vector3d tip_m(0.0, 0.0, 1.0);
    EXPECT_TRUE(floor.only_face({tip_m, -Vector3d::UnitZ(), 0.1, 0.1}));
    EXPECT_FALSE(floor.only_face({tip_m, -Vector3d::UnitZ(), 0.1, 0.6}));
    EXPECT_FALSE(floor.only_face({tip_m, -Vector3d::UnitZ(), 0.1, 1.5}));
    EXPECT_FALSE(floor.only_face({tip_m, -Vector3d::UnitZ(), 0.9, 0.0}));
}

}  // namespace
}  // namespace surefoot::sim
