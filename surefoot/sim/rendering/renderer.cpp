// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/renderer.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "surefoot/core/unknown.hpp"
#include "surefoot/sim/rendering/edge_pixels.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

/// Four sub-pixel positions with different rows and columns: edges of any direction get
/// intermediate values.
constexpr std::array<std::array<double, 2>, 4> kPlaces_px{
    {{-0.125, -0.375}, {0.375, -0.125}, {0.125, 0.375}, {-0.375, 0.125}}};

/// Calls `work(block_x, block_y, block)` for every block of pixels; `block` is a workspace.
template <typename Work>
void for_each_block(const RayField& rays, Executor& executor, const Work& work) {
    executor.parallel_for(rays.blocks_y(), [&](int block_y) {
        CastBlock block;
        for (int block_x = 0; block_x < rays.blocks_x(); ++block_x) work(block_x, block_y, block);
    });
}

/// Finds the end points of the rays of a block.
void find_sights(const RayField& rays,
                 const ImageViews& views,
                 int block_x,
                 int block_y,
                 const CastBlock& block,
                 SightBatch& out) {
    const auto width = static_cast<std::size_t>(block.width);
    const std::size_t span = views.single() ? block.pixels() : width;
    for (std::size_t first = 0; first < block.pixels(); first += span) {
        const int v = block.v0 + static_cast<int>(first / width);
        end_points(views.row(v).origin_m,
                   block.directions,
                   block.hits,
                   {first, first + span},
                   out.points_m);
    }
    out.count = block.pixels();
    const float* angles_rad = rays.block(block_x, block_y).pixel_angle_rad;
    std::copy_n(angles_rad, out.count, out.pixel_angle_rad.begin());
    std::copy_n(block.hits.distance_m.begin(), out.count, out.way_m.begin());
    std::copy_n(block.directions.x.begin(), out.count, out.directions.x.begin());
    std::copy_n(block.directions.y.begin(), out.count, out.directions.y.begin());
    std::copy_n(block.directions.z.begin(), out.count, out.directions.z.begin());
}

void resize(const RayField& rays, CleanImage& image) {
    image.signal_dn.resize(rays.width(), rays.height());
    image.depth_m.resize(rays.width(), rays.height());
    image.surface.resize(rays.width(), rays.height());
    image.key.resize(rays.width(), rays.height());
}

void store_geometry(const RayField& rays, const CastBlock& block, CleanImage& out) {
    std::size_t i = 0;
    for (int v = block.v0; v < block.v0 + block.height; ++v) {
        for (int u = block.u0; u < block.u0 + block.width; ++u, ++i) {
            const RayHit hit = block.hits[i];
            out.surface.row(v)[u] = static_cast<std::int16_t>(hit.face);
            out.depth_m.row(v)[u] =
                hit.face < 0 ? kNanF : static_cast<float>(hit.distance_m * rays.ray(u, v).z());
        }
    }
}

/// A body that does not move.
class AtRest final : public Motion {
  public:
    explicit AtRest(const Pose& T_world_body) { state_.T_world_body = T_world_body; }
    [[nodiscard]] MotionState at(double /*time_s*/) const override { return state_; }
    [[nodiscard]] double duration_s() const override { return 0.0; }

  private:
    MotionState state_;
};

}  // namespace

Result<Renderer> Renderer::make(const Scene& scene,
                                const camera::StereoRig& rig,
                                const CameraConfig& config,
                                std::uint64_t seed) {
    if (const auto problem = rig.problem()) return usage_error("simulator: rig: " + *problem);
    if (!rig.right) {
        return usage_error("simulator: rig '" + rig.name +
                           "' has no right camera; use a stereo rig");
    }
    return Renderer(scene, rig, config, seed);
}

Renderer::Renderer(const Scene& scene,
                   const camera::StereoRig& rig,
                   const CameraConfig& config,
                   std::uint64_t seed)
    : scene_(&scene),
      rig_(rig),
      config_(config),
      seed_(seed),
      left_rays_(rig.left),
      right_rays_(*rig.right),
      shader_(scene, seed) {}

void Renderer::render(const Pose& T_world_body,
                      int frame,
                      Executor& executor,
                      RenderedPair& out) const {
    CleanPair clean;
    Shot shot;
    shot.exposure_s = config_.exposure.exposure_s;
    collect(AtRest(T_world_body), 0.0, shot.exposure_s, executor, clean);
    expose(clean, shot, frame, executor, out);
}

void Renderer::collect(const Motion& motion,
                       double stamp_s,
                       double exposure_s,
                       Executor& executor,
                       CleanPair& out) const {
    const Pose T_body_left = rig_.body_from_left();
    const Pose T_body_right = T_body_left * rig_.T_left_right;
    const auto look = [&](const RayField& rays, const Pose& T_body_camera, CleanImage& image) {
        collect_camera(
            rays, motion, T_body_camera, stamp_s, exposure_s, executor, out.instant, image);
        apply_optics(config_.optics, &rays == &left_rays_, executor, image.signal_dn);
        executor.parallel_for(rays.height(), [&](int v) {
            vignette_row(config_.imaging,
                         v,
                         rays.height(),
                         {image.signal_dn.row(v), static_cast<std::size_t>(rays.width())});
        });
    };
    look(left_rays_, T_body_left, out.left);
    look(right_rays_, T_body_right, out.right);
}

void Renderer::collect_camera(const RayField& rays,
                              const Motion& motion,
                              const Pose& T_body_camera,
                              double stamp_s,
                              double exposure_s,
                              Executor& executor,
                              CleanImage& instant,
                              CleanImage& out) const {
    const double readout_s = config_.shutter.rolling ? rig_.readout_s : 0.0;
    const auto views_at = [&](double offset_s) {
        return ImageViews(motion, T_body_camera, stamp_s + offset_s, readout_s, rays.height());
    };
    const ImageViews middle = views_at(0.0);
    std::vector<ImageViews> moving;
    for (const double offset_s : blur_offsets_s(exposure_s, config_.shutter.blur_samples)) {
        moving.push_back(views_at(offset_s));
    }
    const bool at_rest = std::all_of(
        moving.begin(), moving.end(), [&](const ImageViews& views) { return views == middle; });
    if (moving.size() < 2 || at_rest) {
        render_instant(rays, middle, kPlaces_px, Wanted::picture_and_depth, executor, out);
    } else {
        blur(rays, middle, moving, executor, instant, out);
    }
}

/// Computes the depth at the middle of the exposure and the mean signal of all instants.
void Renderer::blur(const RayField& rays,
                    const ImageViews& middle,
                    std::span<const ImageViews> moving,
                    Executor& executor,
                    CleanImage& instant,
                    CleanImage& out) const {
    resize(rays, out);
    for_each_block(rays, executor, [&](int block_x, int block_y, CastBlock& block) {
        cast_block(*scene_, rays, middle, block_x, block_y, block);
        store_geometry(rays, block, out);
    });
    const auto share = 1.0F / static_cast<float>(moving.size());
    out.signal_dn.fill(0.0F);
    for (std::size_t k = 0; k < moving.size(); ++k) {
        const auto place = Places(kPlaces_px).subspan(k % kPlaces_px.size(), 1);
        render_instant(rays, moving[k], place, Wanted::picture, executor, instant);
        executor.parallel_for(rays.height(), [&](int v) {
            for (int u = 0; u < rays.width(); ++u) {
                out.signal_dn.row(v)[u] += share * instant.signal_dn.row(v)[u];
            }
        });
    }
    std::swap(out.key, instant.key);
}

void Renderer::render_clean(const RayField& rays,
                            const Pose& T_world_camera,
                            Executor& executor,
                            CleanImage& out) const {
    render_instant(
        rays, ImageViews(T_world_camera), kPlaces_px, Wanted::picture_and_depth, executor, out);
}

void Renderer::render_instant(const RayField& rays,
                              const ImageViews& views,
                              Places places,
                              Wanted wanted,
                              Executor& executor,
                              CleanImage& out) const {
    resize(rays, out);
    for_each_block(rays, executor, [&](int block_x, int block_y, CastBlock& block) {
        cast_block(*scene_, rays, views, block_x, block_y, block);
        if (wanted == Wanted::picture_and_depth) store_geometry(rays, block, out);
        shade_block(rays, views, block_x, block_y, block, out);
    });
    for_each_block(rays, executor, [&](int block_x, int block_y, CastBlock& block) {
        soften_block(rays, views, places, block_x, block_y, block, out);
    });
}

/// Shades face by face, because look-ups of many points on one surface are faster together.
void Renderer::shade_by_face(const HitBatch& hits,
                             const SightBatch& sights,
                             std::span<Seen> out) const {
    // Only filled entries are read. NOLINTBEGIN(cppcoreguidelines-pro-type-member-init)
    BatchArray<std::size_t> waiting;
    BatchArray<std::size_t> chosen;
    SightBatch chosen_sights;
    // NOLINTEND(cppcoreguidelines-pro-type-member-init)
    BatchArray<Seen> chosen_seen;
    std::iota(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(sights.count), 0U);
    for (std::size_t left = sights.count; left > 0;) {
        const int face = hits.face[waiting[0]];
        std::size_t later = 0;
        std::size_t count = 0;
        for (std::size_t k = 0; k < left; ++k) {
            const std::size_t i = waiting[k];
            (hits.face[i] == face ? chosen[count++] : waiting[later++]) = i;
        }
        left = later;
        if (face < 0) {
            for (std::size_t k = 0; k < count; ++k) out[chosen[k]] = Shader::background();
            continue;
        }
        chosen_sights.count = 0;
        for (std::size_t k = 0; k < count; ++k) chosen_sights.add(sights[chosen[k]]);
        shader_.surface(face, chosen_sights, chosen_seen);
        for (std::size_t k = 0; k < count; ++k) out[chosen[k]] = chosen_seen[k];
    }
}

void Renderer::shade_block(const RayField& rays,
                           const ImageViews& views,
                           int block_x,
                           int block_y,
                           const CastBlock& block,
                           CleanImage& out) const {
    SightBatch
        sights;  // Only filled entries are read. NOLINT(cppcoreguidelines-pro-type-member-init)
    BatchArray<Seen> seen;
    find_sights(rays, views, block_x, block_y, block, sights);
    if (block.plane) {
        shader_.surface(block.plane->face, sights, seen);
    } else {
        shade_by_face(block.hits, sights, seen);
    }
    std::size_t i = 0;
    const auto white_dn = static_cast<float>(255.0 * config_.imaging.exposure);
    for (int v = block.v0; v < block.v0 + block.height; ++v) {
        for (int u = block.u0; u < block.u0 + block.width; ++u, ++i) {
            out.signal_dn.row(v)[u] = white_dn * seen[i].radiance;
            out.key.row(v)[u] = seen[i].key;
        }
    }
}

/// Averages several sub-pixel positions in pixels next to another surface, as real pixels do.
void Renderer::soften_block(const RayField& rays,
                            const ImageViews& views,
                            Places places,
                            int block_x,
                            int block_y,
                            CastBlock& block,
                            CleanImage& out) const {
    std::array<Pixel, CastBlock::kPixels> pixels;
    const std::span<const Pixel> edge(pixels.data(), find_edge(out.key, block_x, block_y, pixels));
    if (edge.empty()) return;
    find_primitives(*scene_, rays, views, block_x, block_y, block);
    SightBatch
        sights;  // Only filled entries are read. NOLINT(cppcoreguidelines-pro-type-member-init)
    BatchArray<Seen> seen;
    BatchArray<float> sum{};
    for (const auto& place : places) {
        cast_within(*scene_, rays, views, place, edge, block);
        sights.count = 0;
        for (std::size_t i = 0; i < edge.size(); ++i) {
            const auto [u, v] = edge[i];
            const RayHit hit = block.hits[i];
            const Vector3d direction = block.directions[i];
            sights.add({views.row(v).origin_m + hit.distance_m * direction,
                        direction,
                        hit.distance_m,
                        rays.pixel_angle_rad(u, v)});
        }
        shade_by_face(block.hits, sights, seen);
        for (std::size_t i = 0; i < edge.size(); ++i) sum[i] += seen[i].radiance;
    }
    const auto white_dn = static_cast<float>(255.0 * config_.imaging.exposure);
    for (std::size_t i = 0; i < edge.size(); ++i) {
        out.signal_dn.row(edge[i].v)[edge[i].u] =
            white_dn * sum[i] / static_cast<float>(places.size());
    }
}

void Renderer::expose(const CleanPair& clean,
                      const Shot& shot,
                      int frame,
                      Executor& executor,
                      RenderedPair& out) const {
    const auto stream = 2U * static_cast<std::uint64_t>(frame);
    expose_camera(clean.left, shot, stream, executor, out.left);
    Shot right = shot;
    right.gain *= config_.exposure.right_gain;
    right.light *= config_.exposure.right_gain;
    expose_camera(clean.right, right, stream + 1U, executor, out.right);
    out.depth_m = clean.left.depth_m;
}

void Renderer::expose_camera(const CleanImage& clean,
                             const Shot& shot,
                             std::uint64_t stream,
                             Executor& executor,
                             GreyImage& out) const {
    const int width = clean.signal_dn.width();
    const auto pixels = static_cast<std::size_t>(width);
    out.resize(width, clean.signal_dn.height());
    const Image<float> normals = noise_image(width, out.height(), stream, executor);
    executor.parallel_for(out.height(), [&](int v) {
        expose_row(config_.imaging,
                   shot.gain,
                   shot.light,
                   {clean.signal_dn.row(v), pixels},
                   {normals.row(v), pixels},
                   {out.row(v), pixels});
    });
}

Image<float> Renderer::noise_image(int width,
                                   int height,
                                   std::uint64_t stream,
                                   Executor& executor) const {
    Image<float> normals(width, height);
    const std::uint64_t key = PixelNoise::key(seed_, stream);
    executor.parallel_for(height, [&](int v) {
        noise_.fill(key,
                    static_cast<std::uint32_t>(v * width),
                    {normals.row(v), static_cast<std::size_t>(width)});
    });
    if (config_.imaging.noise_size_px <= 0.0) return normals;
    const std::vector<float> kernel = smear_kernel(config_.imaging.noise_size_px);
    smear(kernel, executor, normals);
    // The numbers are independent and have variance 1. Smoothing along one direction multiplies the
    // variance by the sum of the squared weights. Two directions thus multiply the sigma by this
    // sum.
    float squares = 0.0F;
    for (const float weight : kernel) squares += weight * weight;
    executor.parallel_for(height, [&](int v) {
        for (int u = 0; u < width; ++u) normals.row(v)[u] /= squares;
    });
    return normals;
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
    Image<float> depth_m(rig.width, rig.height, kNanF);
    const ImageViews views(T_world_camera);
    for_each_block(rays, executor, [&](int block_x, int block_y, CastBlock& block) {
        cast_block(scene, rays, views, block_x, block_y, block);
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
