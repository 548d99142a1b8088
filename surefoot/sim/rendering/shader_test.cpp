// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/shader.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "surefoot/camera/simd_targets_testing.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

constexpr double kPixelAngle_rad = 0.003;

Material plain(double albedo) {
    Material material;
    material.albedo = albedo;
    material.contrast = 0.0;
    return material;
}

Sight sight_of(const Hit& hit, const Vector3d& direction) {
    return {hit.point_m, direction, hit.distance_m, kPixelAngle_rad};
}

/// Light that a ray sees; the test fails if the ray hits nothing.
Seen look(const Scene& scene,
          const Shader& shader,
          const Vector3d& from_m,
          const Vector3d& direction) {
    const auto hit = scene.intersect(from_m, direction);
    EXPECT_TRUE(hit);
    if (!hit) return {};
    return shader.surface(hit->surface, sight_of(*hit, direction));
}

/// Textured floor and, on request, a wall at x = 3 with its face towards the camera.
Scene floor_and_wall(const Material* wall) {
    Scene scene;
    scene.add_floor(Floor({{-5.0, -5.0}, {8.0, 5.0}}, 0.0), scene.add_material({}), 0);
    if (wall != nullptr) {
        scene.add(
            make_box({3.05, 0.0}, {0.1, 10.0}, 0.0, 3.0), scene.add_material(*wall), Label::wall);
    }
    return scene;
}

TEST(ShaderTest, AMirrorShowsWhatAMirroredCameraSees) {
    Material mirror;
    mirror.finish = Finish::mirror;
    mirror.gloss = 1.0;
    const Scene with = floor_and_wall(&mirror);
    const Scene without = floor_and_wall(nullptr);
    const Shader shader(with, 1);
    const Shader plain_shader(without, 1);
    Rng rng(3);
    const Vector3d camera_m(0.0, 0.3, 1.0);
    const Vector3d mirrored_m(6.0, 0.3, 1.0);  // behind the plane x = 3
    float least = 1.0F;
    float most = 0.0F;
    for (int i = 0; i < 200; ++i) {
        const Vector3d target_m(3.0, rng.uniform(-1.5, 1.5), rng.uniform(0.05, 0.5));
        const Vector3d direction = (target_m - camera_m).normalized();
        const Vector3d mirrored(-direction.x(), direction.y(), direction.z());
        const auto hit = with.intersect(camera_m, direction);
        const auto expected_hit = without.intersect(mirrored_m, mirrored);
        ASSERT_TRUE(hit && expected_hit);
        ASSERT_NEAR(hit->point_m.x(), 3.0, 1e-9);
        const Seen seen = shader.surface(hit->surface, sight_of(*hit, direction));
        const Seen expected =
            plain_shader.surface(expected_hit->surface, sight_of(*expected_hit, mirrored));
        EXPECT_NEAR(seen.radiance, expected.radiance, 2e-3F) << "ray " << i;
        least = std::min(least, expected.radiance);
        most = std::max(most, expected.radiance);
    }
    EXPECT_GT(most - least, 0.2F) << "the floor must have texture for this test";
}

TEST(ShaderTest, ADullMirrorAddsItsOwnColour) {
    Material mirror = plain(1.0);
    mirror.finish = Finish::mirror;
    mirror.gloss = 0.75;
    Scene scene;
    scene.add(Floor({{-5.0, -5.0}, {8.0, 5.0}}, 0.0), scene.add_material(mirror), Label::floor);
    // Up there is nothing: three quarters of the background, one quarter of a white lit floor.
    const Seen seen = look(scene, Shader(scene, 1), {0.0, 0.0, 1.0}, -Vector3d::UnitZ());
    const Lighting& light = scene.lighting();
    const double own = light.ambient + light.lamp * light.towards_lamp().z();
    EXPECT_NEAR(static_cast<double>(seen.radiance),
                0.75 * static_cast<double>(Shader::background().radiance) + 0.25 * own,
                1e-6);
}

TEST(ShaderTest, APaneShowsWhatIsBehindItAndMoreAndMoreReflections) {
    Material glass = plain(0.5);
    glass.finish = Finish::glass;
    glass.gloss = 0.9;
    Scene scene;
    scene.add(
        make_box({3.0, 0.0}, {0.01, 40.0}, -20.0, 20.0), scene.add_material(glass), Label::object);
    const int white = scene.add_material(plain(0.8));
    scene.add(make_box({6.0, 0.0}, {1.0, 60.0}, -30.0, 30.0), white, Label::wall);
    scene.light({1.0, 0.0});  // even light: the wall is 0.8 everywhere
    const Shader shader(scene, 1);
    const double reflected = static_cast<double>(Shader::background().radiance);
    for (const double angle_rad : {0.0, 0.5, std::acos(0.5)}) {
        const Vector3d direction(std::cos(angle_rad), std::sin(angle_rad), 0.0);
        const double share = 0.1 + 0.9 * std::pow(1.0 - std::cos(angle_rad), 5.0);
        const Seen seen = look(scene, shader, Vector3d::Zero(), direction);
        EXPECT_NEAR(
            static_cast<double>(seen.radiance), (1.0 - share) * 0.8 + share * reflected, 1e-6)
            << angle_rad;
    }
}

TEST(ShaderTest, MirrorsThatFaceEachOtherEnd) {
    Material mirror = plain(0.5);
    mirror.finish = Finish::mirror;
    mirror.gloss = 0.9;
    Scene scene;
    const int material = scene.add_material(mirror);
    scene.add(make_box({3.5, 0.0}, {1.0, 10.0}, -5.0, 5.0), material, Label::wall);
    scene.add(make_box({-3.5, 0.0}, {1.0, 10.0}, -5.0, 5.0), material, Label::wall);
    scene.light({1.0, 0.0});
    // Two bounces, then the third mirror is matte: 0.1 a + 0.9 (0.1 a + 0.9 a) with a = 0.5.
    const Seen seen = look(scene, Shader(scene, 1), Vector3d::Zero(), Vector3d::UnitX());
    EXPECT_NEAR(seen.radiance, 0.5F * (0.1F + 0.9F * (0.1F + 0.9F)), 1e-6F);
}

/// More points than one batch holds, on planes and round a post, in the light and in shadow.
TEST(ShaderTest, ManyPointsTogetherLookLikeEachAlone) {
    for (const bool shadows : {false, true}) {
        Scene scene = floor_and_wall(nullptr);
        scene.add(Cylinder({2.0, 0.0}, 0.3, 0.0, 2.0), 0, Label::object);
        Lighting lighting;
        lighting.shadows = shadows;
        lighting.stripe_width_m = shadows ? 0.05 : 0.0;
        scene.light(lighting);
        const Shader shader(scene, 1);
        const Vector3d camera_m(0.0, 0.0, 1.0);
        std::vector<std::vector<Sight>> sights(scene.surfaces().size());
        for (int i = 0; i < 3000; ++i) {
            const Vector3d direction =
                Vector3d(1.0, -0.6 + 0.0004 * i, -0.05 - 0.01 * (i % 40)).normalized();
            const auto hit = scene.intersect(camera_m, direction);
            if (!hit) continue;
            sights[static_cast<std::size_t>(hit->surface)].push_back(sight_of(*hit, direction));
        }
        EXPECT_GT(sights[0].size(), 600U);
        EXPECT_GT(sights[3].size(), 300U);
        for (std::size_t surface = 0; surface < sights.size(); ++surface) {
            const std::vector<Sight>& all = sights[surface];
            for (std::size_t first = 0; first < all.size(); first += kBatchRays) {
                SightBatch batch;
                const std::size_t end = std::min(first + kBatchRays, all.size());
                for (std::size_t i = first; i < end; ++i) batch.add(all[i]);
                camera::test::on_every_target([&](const char* target) {
                    std::vector<Seen> seen(batch.count);
                    shader.surface(static_cast<int>(surface), batch, seen);
                    for (std::size_t i = 0; i < seen.size(); ++i) {
                        const Seen alone =
                            shader.surface(static_cast<int>(surface), all[first + i]);
                        ASSERT_EQ(seen[i].radiance, alone.radiance)
                            << surface << " " << first + i << " on " << target;
                        ASSERT_EQ(seen[i].key, alone.key) << target;
                    }
                });
            }
        }
    }
}

/// The lamp stands in -x, 45 deg high.
Lighting low_lamp() {
    Lighting lighting;
    lighting.lamp_azimuth_deg = 180.0;
    lighting.lamp_elevation_deg = 45.0;
    lighting.shadows = true;
    return lighting;
}

TEST(ShaderTest, ABoxCastsItsShadowWhereGeometrySays) {
    Scene scene;
    scene.add_floor(Floor({{-5.0, -5.0}, {8.0, 5.0}}, 0.0), scene.add_material({}), 0);
    scene.add(make_box({1.0, 0.0}, {1.0, 1.0}, 0.0, 0.4), 0, Label::object);
    scene.add(Cylinder({1.0, 3.0}, 0.2, 0.0, 1.0), 0, Label::object);
    scene.light(low_lamp());
    const Shader shader(scene, 1);
    // The box ends at x = 1.5 and is 0.4 m high: shadow to 1.9.
    EXPECT_FALSE(shader.lit({1.51, 0.0, 0.0}));
    EXPECT_FALSE(shader.lit({1.899, 0.49, 0.0}));
    EXPECT_TRUE(shader.lit({1.901, 0.0, 0.0}));
    EXPECT_TRUE(shader.lit({1.7, 0.51, 0.0}));
    EXPECT_TRUE(shader.lit({0.49, 0.0, 0.0}));  // before the box
    EXPECT_TRUE(shader.lit({1.0, 0.0, 0.4}));   // on it
    EXPECT_FALSE(shader.lit({1.7, 0.0, 0.199}));
    EXPECT_TRUE(shader.lit({1.7, 0.0, 0.201}));
    EXPECT_FALSE(shader.lit({2.19, 3.0, 0.0}));  // shadow of the cylinder: its axis is 1 m high
    EXPECT_TRUE(shader.lit({2.21, 3.0, 0.0}));
    EXPECT_TRUE(shader.lit({0.799, 3.0, 0.5}));   // bright side of the cylinder
    EXPECT_FALSE(shader.lit({1.201, 3.0, 0.5}));  // dark side of the cylinder
    Lighting soft = low_lamp();
    soft.shadows = false;
    scene.light(soft);
    EXPECT_TRUE(Shader(scene, 1).lit({1.51, 0.0, 0.0}));
}

TEST(ShaderTest, APitIsShadedByItsRimAndGlassCastsNoShadow) {
    Scene scene;
    const Pit pit{{{1.0, -1.0}, {2.0, 1.0}}, 0.3};
    scene.add_floor(Floor({{-5.0, -5.0}, {8.0, 5.0}}, 0.0, {pit}), scene.add_material({}), 0);
    Material glass;
    glass.finish = Finish::glass;
    scene.add(
        make_box({4.0, 0.0}, {0.01, 2.0}, 0.0, 2.0), scene.add_material(glass), Label::object);
    scene.light(low_lamp());
    const Shader shader(scene, 1);
    EXPECT_FALSE(shader.lit({1.29, 0.0, -0.3}));
    EXPECT_TRUE(shader.lit({1.31, 0.0, -0.3}));
    EXPECT_TRUE(shader.lit({4.5, 0.0, 0.0}));
}

TEST(ShaderTest, AShadowLeavesTheEvenLight) {
    Scene scene;
    scene.add_floor(Floor({{-5.0, -5.0}, {8.0, 5.0}}, 0.0), scene.add_material(plain(0.5)), 0);
    scene.add(make_box({1.0, 0.0}, {1.0, 1.0}, 0.0, 0.4), 0, Label::object);
    scene.light(low_lamp());
    const Shader shader(scene, 1);
    const Seen dark = look(scene, shader, {1.7, 0.0, 1.0}, -Vector3d::UnitZ());
    const Seen bright = look(scene, shader, {2.5, 0.0, 1.0}, -Vector3d::UnitZ());
    EXPECT_NEAR(static_cast<double>(dark.radiance), 0.5 * 0.45, 1e-6);
    EXPECT_NEAR(static_cast<double>(bright.radiance), 0.5 * (0.45 + 0.55 * std::sqrt(0.5)), 1e-6);
    EXPECT_NE(dark.key, bright.key);
}

TEST(ShaderTest, StripesAreAsWideAsTheBlindSays) {
    Scene scene;
    scene.add_floor(Floor({{-5.0, -5.0}, {8.0, 5.0}}, 0.0), scene.add_material(plain(1.0)), 0);
    Lighting blind;
    blind.ambient = 0.0;
    blind.lamp = 1.0;
    blind.lamp_azimuth_deg = 0.0;
    blind.lamp_elevation_deg = 90.0;
    blind.stripe_width_m = 0.06;
    blind.stripe_gap_m = 0.14;
    // From straight above the stripes run along x; turned by 90 deg along y.
    for (const bool turned : {false, true}) {
        blind.stripe_yaw_deg = turned ? 90.0 : 0.0;
        scene.light(blind);
        const Shader shader(scene, 1);
        double sum = 0.0;
        int between = 0;
        constexpr int kPlaces = 2000;
        for (int i = 0; i < kPlaces; ++i) {
            const double across_m = (i + 0.5) * 2.0 / kPlaces;  // ten periods
            const Vector3d from_m =
                turned ? Vector3d(across_m, 0.0, 0.1) : Vector3d(0.0, across_m, 0.1);
            const double seen =
                static_cast<double>(look(scene, shader, from_m, -Vector3d::UnitZ()).radiance);
            sum += seen / kPlaces;
            between += seen > 0.01 && seen < 0.99 ? 1 : 0;
        }
        EXPECT_NEAR(sum, 0.3, 1e-3) << turned;
        // A pixel is 0.3 mm wide here: soft are 20 edges of 0.3 mm on 2 m.
        EXPECT_LE(between, 10);
        const Vector3d along = turned ? Vector3d::UnitY() : Vector3d::UnitX();
        const Vector3d start_m = Vector3d(0.03, 0.03, 0.1);
        EXPECT_EQ(look(scene, shader, start_m, -Vector3d::UnitZ()).radiance,
                  look(scene, shader, start_m + along, -Vector3d::UnitZ()).radiance);
    }
}

}  // namespace
}  // namespace surefoot::sim
