// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/shader.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

/// Radiance of the background: grey 30 at the default exposure, like a dim, uniform surrounding.
constexpr float kBackground = 30.0F / (255.0F * 1.4F);
/// Distance from a surface at which a continued ray starts, so that it does not hit the surface
/// again.
constexpr double kClear_m = 1e-6;
constexpr int kMaxBounces = 2;

Footprint footprint_of(const Sight& sight, const SurfacePoint& at) {
    const double cosine = std::max(-at.normal.dot(sight.direction), kLeastCosine);
    Footprint footprint;
    footprint.minor_m = sight.way_m * sight.pixel_angle_rad;
    footprint.major_m = footprint.minor_m / cosine;
    const double along_u = at.tangent_u.dot(sight.direction);
    const double along_v = at.tangent_v.dot(sight.direction);
    const double sine = std::sqrt(along_u * along_u + along_v * along_v);
    if (sine > 1e-9) {
        footprint.axis_u = along_u / sine;
        footprint.axis_v = along_v / sine;
    }
    return footprint;
}

/// Length of the bright parts of a grating between 0 and x.
double bright_length(double x, double bright, double period) {
    const double whole = std::floor(x / period);
    return whole * bright + std::min(x - whole * period, bright);
}

Seen mixed(const Seen& a, float share_a, const Seen& b, float share_b) {
    return {share_a * a.radiance + share_b * b.radiance, a.key * 0x9e3779b1U + b.key};
}

Sight onward(const Sight& sight, const Vector3d& direction) {
    return {sight.point_m + kClear_m * direction, direction, sight.way_m, sight.pixel_angle_rad};
}

/// Share of light that a pane reflects (Schlick, "An Inexpensive BRDF Model", 1994). The share is 1
/// at grazing incidence.
float reflected_share(float straight_on, double cosine) {
    const auto missing = static_cast<float>(1.0 - std::clamp(cosine, 0.0, 1.0));
    const float squared = missing * missing;
    return straight_on + (1.0F - straight_on) * squared * squared * missing;
}

/// Direction across the stripes, perpendicular to the rays of the lamp. Horizontal at yaw 0.
Vector3d stripe_axis(const Vector3d& towards_lamp, double yaw_deg) {
    const Vector3d sideways = Vector3d::UnitZ().cross(towards_lamp);
    const Vector3d level = sideways.norm() > 1e-9 ? sideways.normalized() : Vector3d::UnitY();
    return Eigen::AngleAxisd(yaw_deg * std::numbers::pi / 180.0, towards_lamp) * level;
}

}  // namespace

Shader::Shader(const Scene& scene, std::uint64_t seed)
    : scene_(&scene),
      lighting_(scene.lighting()),
      textures_(scene.materials(), seed),
      towards_lamp_(lighting_.towards_lamp()),
      across_stripes_(stripe_axis(towards_lamp_, lighting_.stripe_yaw_deg)) {
    int previous = -1;
    for (const Surface& surface : scene.surfaces()) {
        const Material& material = scene.materials()[static_cast<std::size_t>(surface.material)];
        add_face(surface, material);
        const Sphere& bounds = scene.bounds(surface.primitive);
        lamp_plane_m_ =
            std::max(lamp_plane_m_, towards_lamp_.dot(bounds.center_m) + bounds.radius_m);
        if (surface.primitive == previous || material.finish == Finish::glass) continue;
        blockers_.push_back({surface.primitive, bounds});
        previous = surface.primitive;
    }
}

void Shader::add_face(const Surface& surface, const Material& material) {
    const FaceFrame& frame = surface.frame;
    // The face number shifts the pattern. The number counts the faces of the scene or, with
    // `same_look`, the faces of one solid.
    int number = static_cast<int>(faces_.size());
    if (material.same_look) number -= scene_->first_surface(surface.primitive);
    Face face;
    face.placement = textures_.place(surface.material, number);
    face.normal = frame.normal;
    face.tangent_u = frame.tangent_u;
    face.tangent_v = frame.tangent_v;
    PlaneTexels& texels = face.texels;
    texels.texel_u =
        face.placement.along * frame.tangent_u + face.placement.across * frame.tangent_v;
    texels.texel_v =
        face.placement.along * frame.tangent_v - face.placement.across * frame.tangent_u;
    if (material.same_look && !frame.curved) {
        const Vector3d& middle_m = scene_->bounds(surface.primitive).center_m;
        face.placement.u_texel -= texels.texel_u.dot(middle_m);
        face.placement.v_texel -= texels.texel_v.dot(middle_m);
    }
    texels.normal = frame.normal;
    texels.u_texel = face.placement.u_texel;
    texels.v_texel = face.placement.v_texel;
    texels.texels_per_m = face.placement.texels_per_m;
    face.facing_lamp = frame.normal.dot(towards_lamp_);
    face.finish = material.finish;
    face.curved = frame.curved;
    face.gloss = static_cast<float>(material.gloss);
    faces_.push_back(face);
}

Seen Shader::background() noexcept {
    return {kBackground, 0};
}

Seen Shader::surface(int surface, const Sight& sight) const {
    return seen(surface, sight, 0);
}

void Shader::surface(int surface, const SightBatch& sights, std::span<Seen> out) const {
    const Face& face = faces_[static_cast<std::size_t>(surface)];
    if (face.finish != Finish::matte) {
        for (std::size_t i = 0; i < sights.count; ++i) out[i] = seen(surface, sights[i], 0);
    } else if (face.curved) {
        curved(surface, sights, out);
    } else {
        plane(surface, sights, out);
    }
}

void Shader::plane(int surface, const SightBatch& sights, std::span<Seen> out) const {
    const Face& face = faces_[static_cast<std::size_t>(surface)];
    TextureBatch batch;
    look_at(face.texels, sights, batch);
    // Only filled entries are read. NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
    std::array<float, TextureBatch::kMost> albedo;
    textures_.reflectances(face.placement, batch, albedo.data());
    const std::vector<Blocker> blockers = blockers_of(face, sights);
    // Without shadows and stripes the light is the same on the whole plane.
    const bool even = blockers.empty() && !(lighting_.stripe_width_m > 0.0);
    const Seen white = lit_surface(surface, sights[0], face.facing_lamp, 1.0F, blockers);
    for (std::size_t i = 0; i < sights.count; ++i) {
        out[i] = even ? Seen{white.radiance * albedo[i], white.key}
                      : lit_surface(surface, sights[i], face.facing_lamp, albedo[i], blockers);
    }
}

void Shader::curved(int surface, const SightBatch& sights, std::span<Seen> out) const {
    const Face& face = faces_[static_cast<std::size_t>(surface)];
    TextureBatch batch;
    // Only filled entries are read. NOLINTBEGIN(cppcoreguidelines-pro-type-member-init)
    BatchArray<double> facing;
    std::array<float, TextureBatch::kMost> albedo;
    // NOLINTEND(cppcoreguidelines-pro-type-member-init)
    for (std::size_t i = 0; i < sights.count; ++i) {
        const Sight sight = sights[i];
        const SurfacePoint at = scene_->surface_point(surface, sight.point_m);
        batch.add(Textures::look(face.placement, at.u_m, at.v_m, footprint_of(sight, at)));
        facing[i] = at.normal.dot(towards_lamp_);
    }
    textures_.reflectances(face.placement, batch, albedo.data());
    for (std::size_t i = 0; i < sights.count; ++i) {
        out[i] = lit_surface(surface, sights[i], facing[i], albedo[i], blockers_);
    }
}

Seen Shader::along(const Sight& sight, int bounces) const {
    const auto hit = scene_->intersect(sight.point_m, sight.direction);
    if (!hit) return background();
    const Sight there{
        hit->point_m, sight.direction, sight.way_m + hit->distance_m, sight.pixel_angle_rad};
    return seen(hit->surface, there, bounces);
}

Seen Shader::seen(int surface, const Sight& sight, int bounces) const {
    const Face& face = faces_[static_cast<std::size_t>(surface)];
    if (face.finish == Finish::matte || bounces == kMaxBounces) return matte(surface, sight);
    const Vector3d normal = point_on(surface, sight.point_m).normal;
    const double towards = normal.dot(sight.direction);
    const Vector3d back = sight.direction - 2.0 * towards * normal;
    const Seen reflected = along(onward(sight, back), bounces + 1);
    if (face.finish == Finish::mirror) {
        return mixed(reflected, face.gloss, matte(surface, sight), 1.0F - face.gloss);
    }
    const float share = reflected_share(1.0F - face.gloss, -towards);
    const Seen behind = along(onward(sight, sight.direction), bounces + 1);
    return mixed(behind, 1.0F - share, reflected, share);
}

SurfacePoint Shader::point_on(int surface, const Vector3d& point_m) const {
    const Face& face = faces_[static_cast<std::size_t>(surface)];
    if (face.curved) return scene_->surface_point(surface, point_m);
    return {face.normal,
            face.tangent_u,
            face.tangent_v,
            face.tangent_u.dot(point_m),
            face.tangent_v.dot(point_m)};
}

Seen Shader::matte(int surface, const Sight& sight) const {
    const Face& face = faces_[static_cast<std::size_t>(surface)];
    float albedo = 0.0F;
    double facing = 0.0;
    if (face.curved) {
        const SurfacePoint at = scene_->surface_point(surface, sight.point_m);
        albedo = textures_.reflectance(face.placement, at.u_m, at.v_m, footprint_of(sight, at));
        facing = at.normal.dot(towards_lamp_);
    } else {
        albedo = textures_.reflectance(face.placement, look_at(face.texels, sight));
        facing = face.facing_lamp;
    }
    return lit_surface(surface, sight, facing, albedo, blockers_);
}

Seen Shader::lit_surface(int surface,
                         const Sight& sight,
                         double facing_lamp,
                         float albedo,
                         std::span<const Blocker> blockers) const {
    const bool bright = facing_lamp > 0.0 && lit(sight.point_m, blockers);
    double light = lighting_.ambient;
    if (bright) {
        const bool striped = lighting_.stripe_width_m > 0.0;
        const double share = striped ? stripes(sight, point_on(surface, sight.point_m)) : 1.0;
        light += lighting_.lamp * facing_lamp * share;
    }
    const auto key = 2U * (static_cast<std::uint32_t>(surface) + 1U) + (bright ? 1U : 0U);
    return {static_cast<float>(light) * albedo, key};
}

/// Returns the bright share of the footprint of a pixel. It is exact for a footprint that is a line
/// across the stripes.
double Shader::stripes(const Sight& sight, const SurfacePoint& at) const {
    const Footprint footprint = footprint_of(sight, at);
    const Vector3d major = footprint.axis_u * at.tangent_u + footprint.axis_v * at.tangent_v;
    const Vector3d minor = at.normal.cross(major);
    const double along_major = footprint.major_m * across_stripes_.dot(major);
    const double along_minor = footprint.minor_m * across_stripes_.dot(minor);
    const double half_m = std::max(0.5 * std::hypot(along_major, along_minor), 1e-6);
    const double place_m = across_stripes_.dot(sight.point_m);
    const double period_m = lighting_.stripe_width_m + lighting_.stripe_gap_m;
    const double bright_m = bright_length(place_m + half_m, lighting_.stripe_width_m, period_m) -
                            bright_length(place_m - half_m, lighting_.stripe_width_m, period_m);
    return bright_m / (2.0 * half_m);
}

bool Shader::lit(const Vector3d& point_m) const {
    return lit(point_m, blockers_);
}

/// Casts a ray from the lamp, because surfaces are visible from outside only. So the rim of a pit
/// shades the pit.
bool Shader::lit(const Vector3d& point_m, std::span<const Blocker> blockers) const {
    if (!lighting_.shadows) return true;
    const double far_m = lamp_plane_m_ - towards_lamp_.dot(point_m) + 1.0;
    const Vector3d from_m = point_m + far_m * towards_lamp_;
    const Vector3d direction = -towards_lamp_;
    RayHit nearest{far_m - kClear_m, -1};
    for (const Blocker& blocker : blockers) {
        if (!may_shade(blocker.bounds, {point_m, 0.0})) continue;
        scene_->intersect_primitive(blocker.primitive, from_m, {&direction, 1}, {&nearest, 1});
        if (nearest.face >= 0) return false;
    }
    return true;
}

/// Returns true if the first sphere meets the path of the light from the lamp to a point of the
/// second sphere.
bool Shader::may_shade(const Sphere& blocker, const Sphere& points) const {
    const Vector3d to_center = blocker.center_m - points.center_m;
    const double along_m = towards_lamp_.dot(to_center);
    const double radius_m = blocker.radius_m + points.radius_m;
    return along_m >= -radius_m &&
           to_center.squaredNorm() - along_m * along_m <= radius_m * radius_m;
}

/// Primitives that may shade some points of a plane; primitives behind the plane are left out.
std::vector<Shader::Blocker> Shader::blockers_of(const Face& face, const SightBatch& sights) const {
    std::vector<Blocker> blockers;
    if (!lighting_.shadows || !(face.facing_lamp > 0.0)) return blockers;
    Sphere points{sights[sights.count / 2].point_m, 0.0};
    for (std::size_t i = 0; i < sights.count; ++i) {
        points.radius_m =
            std::max(points.radius_m, (sights[i].point_m - points.center_m).squaredNorm());
    }
    points.radius_m = std::sqrt(points.radius_m) + kClear_m;
    const double offset_m = face.normal.dot(points.center_m) + kClear_m;
    for (const Blocker& blocker : blockers_) {
        const auto& hull_m = scene_->hull(blocker.primitive);
        if (may_shade(blocker.bounds, points) &&
            std::any_of(hull_m.begin(), hull_m.end(), [&](const Vector3d& corner_m) {
                return face.normal.dot(corner_m) > offset_m;
            })) {
            blockers.push_back(blocker);
        }
    }
    return blockers;
}

}  // namespace surefoot::sim
