// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "surefoot/sim/rendering/shader.hpp"
#include "surefoot/sim/scenes/scenes.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

/// Scenes that are named after a surface property show it to the camera.
namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

constexpr std::uint64_t kSeeds = 3;
constexpr int kWantedOfEach = 8;

std::vector<std::string> scenes_named(const std::string& prefix) {
    std::vector<std::string> names;
    for (const SceneInfo& info : list_scenes()) {
        if (info.name.starts_with(prefix)) names.push_back(info.name);
    }
    EXPECT_GE(names.size(), static_cast<std::size_t>(kWantedOfEach)) << prefix;
    return names;
}

struct Ray {
    Vector3d direction;
    Hit hit;
};

/// Surfaces that every eighth pixel of the left camera hits at a share of the path.
std::vector<Ray> view(const ScriptedScene& script, double share) {
    static const camera::StereoRig rig = rig_preset("zed_vga").value();
    const Pose T_world_camera =
        script.motion->at(share * script.motion->duration_s()).T_world_body * rig.body_from_left();
    std::vector<Ray> rays;
    for (int v = 4; v < rig.left.height; v += 8) {
        for (int u = 4; u < rig.left.width; u += 8) {
            const Vector3d direction =
                T_world_camera.rotation * camera::unproject(rig.left.model, {u, v})->normalized();
            const auto hit = script.scene.intersect(T_world_camera.translation_m, direction);
            if (hit) rays.push_back({direction, *hit});
        }
    }
    return rays;
}

const Material& material_of(const Scene& scene, const Hit& hit) {
    const Surface& surface = scene.surfaces()[static_cast<std::size_t>(hit.surface)];
    return scene.materials()[static_cast<std::size_t>(surface.material)];
}

/// Largest share of a view, from three points of the path, for which `is_it(ray)` holds.
template <typename F>
double largest_share(const ScriptedScene& script, F&& is_it) {
    double largest = 0.0;
    for (const double place : {0.0, 0.5, 1.0}) {
        const auto rays = view(script, place);
        const auto count = std::count_if(rays.begin(), rays.end(), is_it);
        largest = std::max(largest, static_cast<double>(count) / static_cast<double>(rays.size()));
    }
    return largest;
}

TEST(SceneLooksTest, GlassAndMirrorsAreInView) {
    for (const auto& [prefix, finish] :
         {std::pair("glass_", Finish::glass), {"mirror_", Finish::mirror}}) {
        for (const std::string& name : scenes_named(prefix)) {
            for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
                const ScriptedScene script = make_scene(name, seed).value();
                EXPECT_GT(largest_share(script,
                                        [&](const Ray& ray) {
                                            return material_of(script.scene, ray.hit).finish ==
                                                   finish;
                                        }),
                          0.03)
                    << name << " seed " << seed;
            }
        }
    }
}

/// Share of the level ground up to 3 m away that the sun reaches, in the middle of the path.
double sunlit_share(const ScriptedScene& script) {
    constexpr double kClear_m = 1e-6;
    constexpr double kFar_m = 100.0;
    const Vector3d towards_sun = script.scene.lighting().towards_lamp();
    int ground = 0;
    int sunlit = 0;
    for (const Ray& ray : view(script, 0.5)) {
        if (ray.hit.distance_m > 3.0 || ray.hit.at.normal.z() < 0.999) continue;
        const Vector3d from_m = ray.hit.point_m + kClear_m * Vector3d::UnitZ();
        ++ground;
        sunlit += script.scene.blocked(from_m, towards_sun, kFar_m) ? 0 : 1;
    }
    return static_cast<double>(sunlit) / ground;
}

TEST(SceneLooksTest, SunStripesLieOnTheGroundInViewAndDiffer) {
    std::set<std::pair<double, double>> gratings;
    for (const std::string& name : scenes_named("stripes_")) {
        for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
            const ScriptedScene script = make_scene(name, seed).value();
            const Lighting& light = script.scene.lighting();
            gratings.emplace(light.stripe_width_m, light.stripe_gap_m);
            EXPECT_GT(light.stripe_width_m, 0.0) << name;
            EXPECT_GT(sunlit_share(script), 0.3) << name << " seed " << seed;
        }
    }
    EXPECT_GE(gratings.size(), static_cast<std::size_t>(kWantedOfEach));
}

TEST(SceneLooksTest, HardShadowsLieOnTheGroundInView) {
    for (const std::string& name : scenes_named("shadow_")) {
        for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
            const ScriptedScene script = make_scene(name, seed).value();
            const double sunlit = sunlit_share(script);
            EXPECT_TRUE(script.scene.lighting().shadows) << name;
            EXPECT_GT(sunlit, 0.15) << name << " seed " << seed;
            EXPECT_LT(sunlit, 0.97) << name << " seed " << seed;
        }
    }
}

TEST(SceneLooksTest, EveryPatternHasItsScene) {
    std::set<Pattern> patterns;
    for (const std::string& name : scenes_named("look_")) {
        const ScriptedScene script = make_scene(name, 1).value();
        const Pattern pattern = script.scene.materials().front().pattern;
        EXPECT_EQ(name, std::string("look_") + to_string(pattern));
        patterns.insert(pattern);
    }
    EXPECT_EQ(patterns.size(), static_cast<std::size_t>(kPatterns));
}

/// Faces of the corridor's doors that point at the path on the left side, by x.
std::vector<int> left_doors(const Scene& scene) {
    std::vector<int> faces;
    for (std::size_t k = 0; k < scene.surfaces().size(); ++k) {
        const Surface& surface = scene.surfaces()[k];
        const bool left = scene.bounds(surface.primitive).center_m.y() > 0.0;
        if (surface.label == Label::door && left && surface.frame.normal.y() < -0.999)
            faces.push_back(static_cast<int>(k));
    }
    return faces;
}

TEST(SceneLooksTest, LookAlikesOfTheCorridorLookAlike) {
    // Texels are weighed in steps of 1/256; rounding of a place may take the next one.
    constexpr float kWeight = 1.0F / 256.0F;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        ScriptedScene script = make_scene("corridor", seed).value();
        script.scene.light({.ambient = 1.0, .lamp = 0.0});
        const Shader shader(script.scene, seed);
        const std::vector<int> doors = left_doors(script.scene);
        ASSERT_GE(doors.size(), 10U);
        const auto radiance = [&](std::size_t door, double along_m, double z_m) {
            const Sphere& bounds = script.scene.bounds(
                script.scene.surfaces()[static_cast<std::size_t>(doors[door])].primitive);
            const Vector3d p(bounds.center_m.x() + along_m, bounds.center_m.y() - 0.015, z_m);
            return shader.surface(doors[door], {p, Vector3d::UnitY(), 1.0, 0.002}).radiance;
        };
        std::set<float> values;
        for (double along_m = -0.4; along_m < 0.4; along_m += 0.07) {
            for (double z_m = 0.1; z_m < 2.0; z_m += 0.13) {
                const float first = radiance(0, along_m, z_m);
                values.insert(first);
                for (const std::size_t door : {1U, 5U, 9U}) {
                    EXPECT_NEAR(radiance(door, along_m, z_m), first, kWeight)
                        << "door " << door << ", seed " << seed;
                }
            }
        }
        EXPECT_GT(values.size(), 50U) << "a look without structure";
    }
}

}  // namespace
}  // namespace surefoot::sim
