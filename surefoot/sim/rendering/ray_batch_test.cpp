// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/ray_batch.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "surefoot/camera/simd_targets_testing.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/sim/scenes/primitives.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

/// No whole number of vectors of any instruction set, and it does not begin at one.
constexpr BatchRange kOddRange{3, 250};

bool same_bits(double a, double b) {
    return std::memcmp(&a, &b, sizeof(a)) == 0;
}

RayBatch random_rays(Rng& rng) {
    RayBatch rays;
    for (std::size_t i = 0; i < kBatchRays; ++i) {
        rays.set(i, Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized());
    }
    return rays;
}

TEST(RayBatchTest, TurnsAsAMatrixTurnsOneRayOnEveryTarget) {
    Rng rng(1);
    const RayBatch optical = random_rays(rng);
    const Eigen::Matrix3d R = exp_so3({0.3, -1.1, 0.7}).toRotationMatrix();
    camera::test::on_every_target([&](const char* target) {
        RayBatch world;
        turn_rays(R, optical.x.data(), optical.y.data(), optical.z.data(), kOddRange, world);
        for (std::size_t i = kOddRange.first; i < kOddRange.end; ++i) {
            const Vector3d expected = R * optical[i];
            for (int axis = 0; axis < 3; ++axis)
                ASSERT_TRUE(same_bits(world[i][axis], expected[axis])) << target << " " << i;
        }
    });
}

/// Boxes, ramps and steps from outside, above, below and inside, rays that were shortened before.
TEST(RayBatchTest, MeetsAConvexSolidAsOneRayDoesOnEveryTarget) {
    Rng rng(2);
    const std::vector<Prism> solids{
        make_box({2.0, 0.5}, {1.0, 0.6}, 0.0, 0.8, 0.4),
        make_ramp({-1.0, 0.0}, 2.0, 1.0, 0.0, 0.5, 2.0),
        {{{0.5, 0.0}, {1.5, 0.1}, {0.6, 1.2}}, -0.2, {0.3, {0.1, -0.2}, {0.0, 0.0}}}};
    int met = 0;
    for (int round = 0; round < 200; ++round) {
        const Prism& solid = solids[static_cast<std::size_t>(round % 3)];
        const Vector3d origin_m(
            rng.uniform(-1.0, 3.0), rng.uniform(-1.0, 2.0), rng.uniform(-0.5, 1.5));
        RayBatch rays = random_rays(rng);
        rays.set(9, Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
        HitBatch before;
        for (std::size_t i = 0; i < kBatchRays; ++i)
            before.set(i, i % 3 == 0 ? RayHit{rng.uniform(0.0, 2.0), 7} : RayHit{});
        camera::test::on_every_target([&](const char* target) {
            HitBatch hits = before;
            solid.intersect(origin_m, rays, kOddRange, 40, hits);
            for (std::size_t i = 0; i < kBatchRays; ++i) {
                RayHit alone = before[i];
                const Vector3d direction = rays[i];
                if (i >= kOddRange.first && i < kOddRange.end)
                    solid.intersect(origin_m, {&direction, 1}, 40, {&alone, 1});
                ASSERT_EQ(hits.face[i], alone.face) << target << " " << round << " " << i;
                ASSERT_TRUE(same_bits(hits.distance_m[i], alone.distance_m)) << target;
                met += alone.face >= 40 ? 1 : 0;
            }
        });
    }
    EXPECT_GT(met, 2000);
}

TEST(RayBatchTest, MeetsAPlaneAndEndsThereAsOneRayDoesOnEveryTarget) {
    Rng rng(3);
    RayBatch rays = random_rays(rng);
    rays.set(5, Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
    const Vector3d normal = Vector3d(0.2, -0.3, 0.9).normalized();
    const Vector3d origin_m(0.3, 0.1, 1.2);
    camera::test::on_every_target([&](const char* target) {
        HitBatch hits;
        PointBatch points;
        meet_plane(normal, 0.83, 4, rays, kOddRange, hits);
        end_points(origin_m, rays, hits, kOddRange, points);
        for (std::size_t i = kOddRange.first; i < kOddRange.end; ++i) {
            const double speed = normal.dot(rays[i]);
            const RayHit alone = speed < 0.0 ? RayHit{-0.83 / speed, 4} : RayHit{};
            ASSERT_EQ(hits.face[i], alone.face) << target << " " << i;
            ASSERT_TRUE(same_bits(hits.distance_m[i], alone.distance_m)) << target << " " << i;
            if (alone.face < 0) continue;
            const Vector3d end_m = origin_m + alone.distance_m * rays[i];
            ASSERT_TRUE(same_bits(points.x[i], end_m.x()));
            ASSERT_TRUE(same_bits(points.y[i], end_m.y()));
            ASSERT_TRUE(same_bits(points.z[i], end_m.z()));
        }
    });
}

}  // namespace
}  // namespace surefoot::sim
