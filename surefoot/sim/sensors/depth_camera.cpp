// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/depth_camera.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <variant>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/sim/rendering/counter_random.hpp"
#include "surefoot/sim/rendering/ray_caster.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

/// Number of independent random streams per frame, and their names.
constexpr std::uint64_t kStreams = 4;
enum Stream : std::uint64_t { axial, lateral_u, lateral_v, loss };
/// Distance from an edge [px] up to which lateral noise acts: three sigma of 0.8 px.
constexpr int kEdgeReach_px = 3;
/// A light ray from the projector ends this far before its surface, so that the surface does not
/// block the ray.
constexpr double kSelf_m = 1e-6;

double smaller_angle_rad(double cosine) {
    return std::acos(std::clamp(cosine, 0.0, 1.0));
}

camera::Camera pinhole(int width, int height, double focal_px) {
    camera::PinholeRadTan lens;
    lens.fx_px = focal_px;
    lens.fy_px = focal_px;
    lens.cx_px = 0.5 * (width - 1);
    lens.cy_px = 0.5 * (height - 1);
    return {lens, width, height};
}

template <typename Seen>
bool near_edge(const Image<Seen>& seen, int u, int v) {
    const int surface = seen.row(v)[u].surface;
    const int u_end = std::min(u + kEdgeReach_px, seen.width() - 1);
    const int v_end = std::min(v + kEdgeReach_px, seen.height() - 1);
    for (int y = std::max(v - kEdgeReach_px, 0); y <= v_end; ++y) {
        for (int x = std::max(u - kEdgeReach_px, 0); x <= u_end; ++x) {
            if (seen.row(y)[x].surface != surface) return true;
        }
    }
    return false;
}

}  // namespace

void DepthCameraConfig::describe(ConfigVisitor& visitor) {
    visitor.number("axial_offset_m",
                   axial_offset_m,
                   0.0,
                   1.0,
                   "smallest sigma of the axial noise, at depth axial_center_m");
    visitor.number(
        "axial_slope_1_m",
        axial_slope_1_m,
        0.0,
        1.0,
        "growth of the axial sigma per squared distance of the depth from axial_center_m");
    visitor.number(
        "axial_center_m", axial_center_m, 0.0, 10.0, "depth at which the axial noise is smallest");
    visitor.number(
        "axial_angle",
        axial_angle,
        0.0,
        1.0,
        "factor of the part of the axial sigma that grows with the angle of incidence, in m^1.5");
    visitor.number("lateral_share",
                   lateral_share,
                   0.0,
                   0.1,
                   "one sigma of the lateral noise, as a share of the depth");
    visitor.number("min_range_m", min_range_m, 0.0, 100.0, "smallest depth that is measured");
    visitor.number("max_range_m", max_range_m, 0.0, 1000.0, "largest depth that is measured");
    visitor.number(
        "projector_x_m",
        projector_x_m,
        -1.0,
        1.0,
        "offset of the projector along the x axis of the camera; 0 = light from the camera itself");
    visitor.number("disparity_step_px",
                   disparity_step_px,
                   0.0,
                   2.0,
                   "step of the quantised disparities of structured light; 0 = no quantisation");
    visitor.number("max_incidence_deg",
                   max_incidence_deg,
                   0.0,
                   90.0,
                   "largest angle of incidence at which a depth is measured");
    visitor.number("least_return",
                   least_return,
                   0.0,
                   1.0,
                   "lowest share of returned light that causes no loss of pixels; at half of this "
                   "share, half of the "
                   "pixels are lost");
    visitor.boolean("mixes_edges",
                    mixes_edges,
                    "true: pixels on an edge lie between the two surfaces, as with time of flight");
}

DepthCameraConfig DepthCameraConfig::with_noise(double factor) const {
    DepthCameraConfig scaled = *this;
    scaled.axial_offset_m *= factor;
    scaled.axial_slope_1_m *= factor;
    scaled.axial_angle *= factor;
    return scaled;
}

DepthCameraPreset depth_camera_preset(DepthCameraKind kind) {
    DepthCameraPreset preset;
    switch (kind) {
        case DepthCameraKind::kinect_v1:
            preset.camera = pinhole(640, 480, 585.0);  // 57 deg from side to side
            break;
        case DepthCameraKind::kinect_v2:
            preset.camera = pinhole(512, 424, 365.0);  // 70 deg from side to side
            preset.config.projector_x_m = 0.0;
            preset.config.disparity_step_px = 0.0;
            preset.config.mixes_edges = true;
            break;
    }
    return preset;
}

Result<DepthCamera> DepthCamera::make(const Scene& scene,
                                      const camera::Camera& camera,
                                      const DepthCameraConfig& config,
                                      std::uint64_t seed) {
    if (const auto problem = camera.problem()) {
        return usage_error("simulator: depth camera: " + *problem);
    }
    if (!(config.min_range_m < config.max_range_m)) {
        return usage_error(
            fmt::format("simulator: depth camera: min_range_m = {} must be below max_range_m = {}",
                        config.min_range_m,
                        config.max_range_m));
    }
    return DepthCamera(scene, camera, config, seed);
}

DepthCamera::DepthCamera(const Scene& scene,
                         const camera::Camera& camera,
                         const DepthCameraConfig& config,
                         std::uint64_t seed)
    : scene_(&scene), config_(config), seed_(seed), rays_(camera) {
    focal_px_ = std::visit([](const auto& lens) { return lens.fx_px; }, camera.model);
}

double DepthCamera::sigma_m(double depth_m, double incidence_rad) const {
    const double far_m = depth_m - config_.axial_center_m;
    const double left_rad = std::max(0.5 * std::numbers::pi - incidence_rad, 1e-3);
    const double slant = incidence_rad / left_rad;
    return config_.axial_offset_m + config_.axial_slope_1_m * far_m * far_m +
           config_.axial_angle / std::sqrt(depth_m) * slant * slant;
}

double DepthCamera::normal(std::uint64_t stream, std::uint32_t pixel) const {
    return static_cast<double>(noise_.normal(PixelNoise::key(seed_, stream), pixel));
}

/// Difference of depth between two neighbouring steps of the disparity at depth_m, from depth = f b
/// / d.
double DepthCamera::depth_step_m(double depth_m) const {
    const double factor_px_m = focal_px_ * std::abs(config_.projector_x_m);
    if (factor_px_m == 0.0) return 0.0;
    return depth_m * depth_m * config_.disparity_step_px / factor_px_m;
}

void DepthCamera::render(const Pose& T_world_camera,
                         int frame,
                         Executor& executor,
                         DepthFrame& out) const {
    Image<Seen> seen(rays_.width(), rays_.height());
    cast(T_world_camera, executor, seen);
    out.depth_m.resize(rays_.width(), rays_.height());
    out.sigma_m.resize(rays_.width(), rays_.height());
    executor.parallel_for(rays_.height(),
                          [&](int v) { measure_row(T_world_camera, frame, v, seen, out); });
}

void DepthCamera::cast(const Pose& T_world_camera, Executor& executor, Image<Seen>& out) const {
    const ImageViews views(T_world_camera);
    executor.parallel_for(rays_.blocks_y(), [&](int block_y) {
        CastBlock block;
        for (int block_x = 0; block_x < rays_.blocks_x(); ++block_x) {
            cast_block(*scene_, rays_, views, block_x, block_y, block);
            std::size_t i = 0;
            for (int v = block.v0; v < block.v0 + block.height; ++v) {
                for (int u = block.u0; u < block.u0 + block.width; ++u, ++i) {
                    const RayHit hit = block.hits[i];
                    if (hit.face < 0) continue;
                    out.row(v)[u] = {hit.distance_m * rays_.ray(u, v).z(),
                                     hit.face,
                                     block.directions[i],
                                     hit.distance_m};
                }
            }
        }
    });
}

void DepthCamera::measure_row(
    const Pose& T_world_camera, int frame, int v, const Image<Seen>& seen, DepthFrame& out) const {
    const std::uint64_t stream = kStreams * static_cast<std::uint64_t>(frame);
    for (int u = 0; u < rays_.width(); ++u) {
        out.depth_m.row(v)[u] = kNanF;
        out.sigma_m.row(v)[u] = kNanF;
        Seen at = seen.row(v)[u];
        const bool edge = near_edge(seen, u, v);
        if (edge) at = beside_edge(T_world_camera, u, v, at, stream);
        if (at.surface < 0) continue;
        const Vector3d point_m = T_world_camera.translation_m + at.distance_m * at.direction;
        const double cosine = -scene_->surface_point(at.surface, point_m).normal.dot(at.direction);
        const auto pixel = static_cast<std::uint32_t>(v * rays_.width() + u);
        if (!returns(T_world_camera, at, cosine, uniform_at(seed_, stream + loss, pixel))) continue;
        if (edge && config_.mixes_edges) at.depth_m = mixed_depth_m(T_world_camera, u, v, at);
        const double sigma = sigma_m(at.depth_m, smaller_angle_rad(cosine));
        // Nguyen's measured noise already includes rounding to steps, an error that is uniform in
        // one step.
        const double step_m = depth_step_m(at.depth_m);
        const double before_m = std::sqrt(std::max(0.0, sigma * sigma - step_m * step_m / 12.0));
        double depth_m = at.depth_m + before_m * normal(stream + axial, pixel);
        if (!(depth_m > config_.min_range_m && depth_m < config_.max_range_m)) continue;
        if (step_m > 0.0) {
            const double factor_px_m = focal_px_ * std::abs(config_.projector_x_m);
            const double steps = std::round(factor_px_m / depth_m / config_.disparity_step_px);
            depth_m = factor_px_m / (steps * config_.disparity_step_px);
        }
        out.depth_m.row(v)[u] = static_cast<float>(depth_m);
        out.sigma_m.row(v)[u] = static_cast<float>(sigma);
    }
}

DepthCamera::Seen DepthCamera::look(
    const Pose& T_world_camera, int u, int v, double du_px, double dv_px) const {
    const Vector3d ray = rays_.ray_within(u, v, du_px, dv_px);
    const Vector3d direction = T_world_camera.rotation * ray;
    const auto hit = scene_->intersect(T_world_camera.translation_m, direction);
    if (!hit) return {};
    return {hit->distance_m * ray.z(), hit->surface, direction, hit->distance_m};
}

/// Applies lateral noise: the camera measures a neighbouring point. The depth of this point counts
/// if it lies on another surface.
DepthCamera::Seen DepthCamera::beside_edge(
    const Pose& T_world_camera, int u, int v, const Seen& center, std::uint64_t stream) const {
    const double sigma_px = config_.lateral_share / rays_.pixel_angle_rad(u, v);
    if (sigma_px == 0.0) return center;
    const auto pixel = static_cast<std::uint32_t>(v * rays_.width() + u);
    const Seen other = look(T_world_camera,
                            u,
                            v,
                            sigma_px * normal(stream + lateral_u, pixel),
                            sigma_px * normal(stream + lateral_v, pixel));
    return other.surface == center.surface ? center : other;
}

/// Returns the mean depth at four sub-pixel positions if they lie on several surfaces. Otherwise,
/// or if a position has no surface, returns the depth of `center`.
double DepthCamera::mixed_depth_m(const Pose& T_world_camera,
                                  int u,
                                  int v,
                                  const Seen& center) const {
    static constexpr std::array<std::array<double, 2>, 4> kPlaces_px{
        {{-0.25, -0.25}, {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}}};
    double sum_m = 0.0;
    bool mixed = false;
    for (const auto& place : kPlaces_px) {
        const Seen at = look(T_world_camera, u, v, place[0], place[1]);
        if (at.surface < 0) return center.depth_m;
        mixed = mixed || at.surface != center.surface;
        sum_m += at.depth_m;
    }
    return mixed ? 0.25 * sum_m : center.depth_m;
}

bool DepthCamera::returns(const Pose& T_world_camera,
                          const Seen& seen,
                          double cosine,
                          double luck) const {
    if (seen.depth_m < config_.min_range_m || seen.depth_m > config_.max_range_m) return false;
    if (smaller_angle_rad(cosine) > config_.max_incidence_deg * kRadPerDeg) return false;
    const Surface& surface = scene_->surfaces()[static_cast<std::size_t>(seen.surface)];
    const Material& material = scene_->materials()[static_cast<std::size_t>(surface.material)];
    if (material.finish != Finish::matte) return false;
    // The share that is lost grows from 0 at `least_return` to 1 where no light comes back.
    if (material.albedo * cosine < config_.least_return * luck) return false;
    if (config_.projector_x_m == 0.0) return true;
    const Vector3d projector_m = T_world_camera * Vector3d(config_.projector_x_m, 0.0, 0.0);
    const Vector3d point_m = T_world_camera.translation_m + seen.distance_m * seen.direction;
    const Vector3d light = point_m - projector_m;
    const double distance_m = light.norm();
    // A face that points away from the projector is dark. Other faces may be in a shadow.
    if (scene_->surface_point(seen.surface, point_m).normal.dot(light) >= 0.0) return false;
    return !scene_->blocked(projector_m, light / distance_m, distance_m - kSelf_m);
}

}  // namespace surefoot::sim
