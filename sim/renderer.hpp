// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "sim/imaging.hpp"
#include "sim/ray_field.hpp"
#include "sim/scene.hpp"
#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::sim {

/// What one camera sees, before noise. Depth is along the optical axis z, exact at pixel centres,
/// NaN where no surface is; `surface` is -1 there.
struct CleanImage {
    Image<float> signal_dn;
    Image<float> depth_m;
    Image<std::int16_t> surface;
};

struct RenderedPair {
    GreyImage left;
    GreyImage right;
    Image<float> depth_m;  ///< of the raw left camera
};

/// Renders a scene by casting the exact ray of each pixel through its lens model. Textures are
/// averaged over the pixel, edges of surfaces over 4 places in it, so that what is too small to be
/// seen blurs as in a real camera. One lamp, diffuse surfaces. Blocks of pixels run through the
/// executor; the same bytes for any executor. Immutable after construction.
class Renderer {
  public:
    /// Fails with the rig's problem in words. The scene must outlive the renderer. An RGB-D rig
    /// (no right camera) is refused.
    [[nodiscard]] static Result<Renderer> make(const Scene& scene,
                                               const camera::StereoRig& rig,
                                               const ImagingConfig& imaging,
                                               std::uint64_t seed);

    /// Both images of a body pose; `frame` selects the noise.
    void render(const Pose& T_world_body, int frame, Executor& executor, RenderedPair& out) const;
    /// One camera without noise.
    void render_clean(const RayField& rays,
                      const Pose& T_world_camera,
                      Executor& executor,
                      CleanImage& out) const;
    [[nodiscard]] const RayField& left_rays() const noexcept { return left_rays_; }
    [[nodiscard]] const RayField& right_rays() const noexcept { return right_rays_; }

  private:
    Renderer(const Scene& scene,
             const camera::StereoRig& rig,
             const ImagingConfig& imaging,
             std::uint64_t seed);
    void render_block(const RayField& rays,
                      const Pose& T_world_camera,
                      int block_x,
                      int block_y,
                      CleanImage& out) const;
    void soften_edges(const RayField& rays,
                      const Pose& T_world_camera,
                      int row,
                      CleanImage& out) const;
    [[nodiscard]] float softened_dn(const RayField& rays,
                                    const Pose& T_world_camera,
                                    int u,
                                    int v) const;
    void add_noise(const CleanImage& clean,
                   std::uint64_t stream,
                   Executor& executor,
                   GreyImage& out) const;
    [[nodiscard]] float signal_dn(int surface,
                                  const Eigen::Vector3d& point_m,
                                  const Eigen::Vector3d& direction,
                                  double distance_m,
                                  double pixel_angle_rad) const;

    const Scene* scene_;
    camera::StereoRig rig_;
    ImagingConfig imaging_;
    std::uint64_t seed_ = 0;
    RayField left_rays_;
    RayField right_rays_;
    Textures textures_;
    PixelNoise noise_;
    Eigen::Vector3d towards_lamp_;
};

/// Exact disparity of a rectified left camera: fx * baseline / depth, NaN where no surface is.
[[nodiscard]] Image<float> disparity_px(const Image<float>& depth_m,
                                        const camera::RectifiedRig& rig);

/// Exact disparity that the rectified left camera of a rig sees from a body pose, for rigs whose
/// raw images are distorted or turned.
[[nodiscard]] Image<float> rectified_disparity_px(const Scene& scene,
                                                  const camera::RectifiedRig& rig,
                                                  const Pose& T_world_body,
                                                  Executor& executor);

}  // namespace surefoot::sim
