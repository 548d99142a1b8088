// SPDX-License-Identifier: Apache-2.0
#include "sim/renderer.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "sim/ray_caster.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
/// Grey value where no surface is.
constexpr float kBackground_dn = 30.0F;
/// Nearest to grazing incidence (1.1 deg) that the footprint of a pixel is stretched to.
constexpr double kLeastCosine = 0.02;

/// Calls `work(block_x, block_y)` for every block of pixels.
template <typename Work>
void for_each_block(const RayField& rays, Executor& executor, const Work& work) {
    executor.parallel_for(rays.blocks_y(), [&](int block_y) {
        for (int block_x = 0; block_x < rays.blocks_x(); ++block_x) work(block_x, block_y);
    });
}

bool on_edge(const Image<std::int16_t>& surface, int u, int v) {
    const std::int16_t here = surface.row(v)[u];
    return (u > 0 && surface.row(v)[u - 1] != here) ||
           (u + 1 < surface.width() && surface.row(v)[u + 1] != here) ||
           (v > 0 && surface.row(v - 1)[u] != here) ||
           (v + 1 < surface.height() && surface.row(v + 1)[u] != here);
}

}  // namespace

Result<Renderer> Renderer::make(const Scene& scene,
                                const camera::StereoRig& rig,
                                const ImagingConfig& imaging,
                                std::uint64_t seed) {
    if (const auto problem = rig.problem()) return usage_error("simulator: rig: " + *problem);
    if (!rig.right) {
        return usage_error("simulator: rig '" + rig.name +
                           "' has no right camera; use a stereo rig");
    }
    return Renderer(scene, rig, imaging, seed);
}

Renderer::Renderer(const Scene& scene,
                   const camera::StereoRig& rig,
                   const ImagingConfig& imaging,
                   std::uint64_t seed)
    : scene_(&scene),
      rig_(rig),
      imaging_(imaging),
      seed_(seed),
      left_rays_(rig.left),
      right_rays_(*rig.right),
      textures_(scene.materials(), seed),
      towards_lamp_(scene.lighting().towards_lamp()) {}

void Renderer::render(const Pose& T_world_body,
                      int frame,
                      Executor& executor,
                      RenderedPair& out) const {
    const Pose T_world_left = T_world_body * rig_.body_from_left();
    const auto stream = 2U * static_cast<std::uint64_t>(frame);
    CleanImage clean;
    render_clean(right_rays_, T_world_left * rig_.T_left_right, executor, clean);
    add_noise(clean, stream + 1U, executor, out.right);
    render_clean(left_rays_, T_world_left, executor, clean);
    add_noise(clean, stream, executor, out.left);
    out.depth_m = std::move(clean.depth_m);
}

void Renderer::render_clean(const RayField& rays,
                            const Pose& T_world_camera,
                            Executor& executor,
                            CleanImage& out) const {
    out.signal_dn.resize(rays.width(), rays.height());
    out.depth_m.resize(rays.width(), rays.height());
    out.surface.resize(rays.width(), rays.height());
    for_each_block(rays, executor, [&](int block_x, int block_y) {
        render_block(rays, T_world_camera, block_x, block_y, out);
    });
    executor.parallel_for(rays.height(),
                          [&](int row) { soften_edges(rays, T_world_camera, row, out); });
}

void Renderer::render_block(const RayField& rays,
                            const Pose& T_world_camera,
                            int block_x,
                            int block_y,
                            CleanImage& out) const {
    CastBlock block;
    cast_block(*scene_, rays, T_world_camera, block_x, block_y, block);
    std::size_t i = 0;
    for (int v = block.v0; v < block.v0 + block.height; ++v) {
        for (int u = block.u0; u < block.u0 + block.width; ++u, ++i) {
            const RayHit& hit = block.hits[i];
            out.surface.row(v)[u] = static_cast<std::int16_t>(hit.face);
            if (hit.face < 0) {
                out.depth_m.row(v)[u] = kNan;
                out.signal_dn.row(v)[u] = kBackground_dn;
                continue;
            }
            const Vector3d& direction = block.directions[i];
            const Vector3d point_m = T_world_camera.translation_m + hit.distance_m * direction;
            out.depth_m.row(v)[u] = static_cast<float>(hit.distance_m * rays.ray(u, v).z());
            out.signal_dn.row(v)[u] =
                signal_dn(hit.face, point_m, direction, hit.distance_m, rays.pixel_angle_rad(u, v));
        }
    }
}

/// Pixels beside another surface mix what is seen at four places in them, as real pixels do.
void Renderer::soften_edges(const RayField& rays,
                            const Pose& T_world_camera,
                            int row,
                            CleanImage& out) const {
    for (int u = 0; u < rays.width(); ++u) {
        if (!on_edge(out.surface, u, row)) continue;
        out.signal_dn.row(row)[u] = softened_dn(rays, T_world_camera, u, row);
    }
}

float Renderer::softened_dn(const RayField& rays, const Pose& T_world_camera, int u, int v) const {
    // Four places that no row and no column share: an edge of any direction is graded.
    static constexpr std::array<std::array<double, 2>, 4> kPlaces_px{
        {{-0.125, -0.375}, {0.375, -0.125}, {0.125, 0.375}, {-0.375, 0.125}}};
    const double angle_rad = rays.pixel_angle_rad(u, v);
    float sum_dn = 0.0F;
    for (const auto& place : kPlaces_px) {
        const Vector3d direction =
            T_world_camera.rotation * rays.ray_within(u, v, place[0], place[1]);
        const auto hit = scene_->intersect(T_world_camera.translation_m, direction);
        sum_dn += hit ? signal_dn(hit->surface, hit->point_m, direction, hit->distance_m, angle_rad)
                      : kBackground_dn;
    }
    return 0.25F * sum_dn;
}

float Renderer::signal_dn(int surface,
                          const Vector3d& point_m,
                          const Vector3d& direction,
                          double distance_m,
                          double pixel_angle_rad) const {
    const SurfacePoint at = scene_->surface_point(surface, point_m);
    const double cosine = std::max(-at.normal.dot(direction), kLeastCosine);
    Footprint footprint;
    footprint.minor_m = distance_m * pixel_angle_rad;
    footprint.major_m = footprint.minor_m / cosine;
    const double along_u = at.tangent_u.dot(direction);
    const double along_v = at.tangent_v.dot(direction);
    const double sine = std::sqrt(along_u * along_u + along_v * along_v);
    if (sine > 1e-9) {
        footprint.axis_u = along_u / sine;
        footprint.axis_v = along_v / sine;
    }
    const int material = scene_->surfaces()[static_cast<std::size_t>(surface)].material;
    const float reflectance = textures_.reflectance(material, surface, at.u_m, at.v_m, footprint);
    const Lighting& lighting = scene_->lighting();
    const double light =
        lighting.ambient + lighting.lamp * std::max(0.0, at.normal.dot(towards_lamp_));
    return static_cast<float>(255.0 * imaging_.exposure * light) * reflectance;
}

void Renderer::add_noise(const CleanImage& clean,
                         std::uint64_t stream,
                         Executor& executor,
                         GreyImage& out) const {
    const int width = clean.signal_dn.width();
    const int height = clean.signal_dn.height();
    out.resize(width, height);
    const float half_width = 0.5F * static_cast<float>(width);
    const float half_height = 0.5F * static_cast<float>(height);
    const float loss = static_cast<float>(imaging_.vignetting) /
                       (half_width * half_width + half_height * half_height);
    executor.parallel_for(height, [&](int v) {
        const float y = static_cast<float>(v) + 0.5F - half_height;
        for (int u = 0; u < width; ++u) {
            const float x = static_cast<float>(u) + 0.5F - half_width;
            const float signal = clean.signal_dn.row(v)[u] * (1.0F - loss * (x * x + y * y));
            const auto pixel = static_cast<std::uint32_t>(v * width + u);
            out.row(v)[u] = exposed_pixel(imaging_, signal, noise_.normal(seed_, stream, pixel));
        }
    });
}

Image<float> disparity_px(const Image<float>& depth_m, const camera::RectifiedRig& rig) {
    Image<float> disparity(depth_m.width(), depth_m.height());
    for (int v = 0; v < depth_m.height(); ++v) {
        for (int u = 0; u < depth_m.width(); ++u) {
            disparity.at(u, v) = static_cast<float>(rig.depth_to_disparity_px_m() /
                                                    static_cast<double>(depth_m.at(u, v)));
        }
    }
    return disparity;
}

Image<float> rectified_disparity_px(const Scene& scene,
                                    const camera::RectifiedRig& rig,
                                    const Pose& T_world_body,
                                    Executor& executor) {
    camera::PinholeRadTan ideal;
    ideal.fx_px = rig.fx_px;
    ideal.fy_px = rig.fy_px;
    ideal.cx_px = rig.cx_px;
    ideal.cy_px = rig.cy_px;
    const RayField rays(camera::Camera{ideal, rig.width, rig.height});
    const Pose T_world_camera = T_world_body * rig.T_body_camera;
    Image<float> depth_m(rig.width, rig.height, kNan);
    for_each_block(rays, executor, [&](int block_x, int block_y) {
        CastBlock block;
        cast_block(scene, rays, T_world_camera, block_x, block_y, block);
        std::size_t i = 0;
        for (int v = block.v0; v < block.v0 + block.height; ++v) {
            for (int u = block.u0; u < block.u0 + block.width; ++u, ++i) {
                if (block.hits[i].face < 0) continue;
                depth_m.row(v)[u] =
                    static_cast<float>(block.hits[i].distance_m * rays.ray(u, v).z());
            }
        }
    });
    return disparity_px(depth_m, rig);
}

}  // namespace surefoot::sim
