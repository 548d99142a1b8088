// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/sim/motion/motion.hpp"
#include "surefoot/sim/rendering/exposure.hpp"
#include "surefoot/sim/rendering/imaging.hpp"
#include "surefoot/sim/rendering/optics.hpp"
#include "surefoot/sim/rendering/ray_caster.hpp"
#include "surefoot/sim/rendering/ray_field.hpp"
#include "surefoot/sim/rendering/shader.hpp"
#include "surefoot/sim/rendering/shutter.hpp"
#include "surefoot/sim/scenes/scene.hpp"

namespace surefoot::sim {

/// Image of one camera before the sensor. Depth is along the optical axis z, exact at pixel centres
/// in the middle of their exposure; NaN without a surface, where `surface` is -1. A mirror or a
/// pane has the depth of its own surface.
struct CleanImage {
    Image<float> signal_dn;
    Image<float> depth_m;
    Image<std::int16_t> surface;
    Image<std::uint32_t> key;  ///< see Seen::key
};

/// Signals of both cameras behind their lenses, for the configured exposure.
struct CleanPair {
    CleanImage left;
    CleanImage right;
    CleanImage instant;  ///< scratch memory
};

struct RenderedPair {
    GreyImage left;
    GreyImage right;
    Image<float> depth_m;  ///< depth of the raw left camera
};

/// All effects between the light of a scene and a grey value.
struct CameraConfig {
    ImagingConfig imaging;
    OpticsConfig optics;
    ShutterConfig shutter;
    ExposureConfig exposure;
};

/// Renders a scene by casting the exact ray of each pixel through its lens model, from the camera
/// pose at the exposure of that row. Textures are averaged over the pixel. Surface edges are
/// averaged over 4 points in it; with motion blur over 1 point in each blurred image. The executor
/// does not change the result. Immutable after construction.
class Renderer {
  public:
    /// Returns an error that names the problem if the rig cannot be rendered, for example an RGB-D
    /// rig without a right camera. The scene must outlive the renderer.
    [[nodiscard]] static Result<Renderer> make(const Scene& scene,
                                               const camera::StereoRig& rig,
                                               const CameraConfig& config,
                                               std::uint64_t seed);

    /// Collects the signals of both cameras of a moving rig around a stamp (see `row_offset_s`).
    void collect(const Motion& motion,
                 double stamp_s,
                 double exposure_s,
                 Executor& executor,
                 CleanPair& out) const;
    /// Converts the signals to grey values; `frame` selects the noise.
    void expose(const CleanPair& clean,
                const Shot& shot,
                int frame,
                Executor& executor,
                RenderedPair& out) const;
    /// Renders both images of a body at rest, with the configured exposure.
    void render(const Pose& T_world_body, int frame, Executor& executor, RenderedPair& out) const;
    /// Renders the image of one camera at rest behind an ideal lens.
    void render_clean(const RayField& rays,
                      const Pose& T_world_camera,
                      Executor& executor,
                      CleanImage& out) const;
    [[nodiscard]] const RayField& left_rays() const noexcept { return left_rays_; }
    [[nodiscard]] const RayField& right_rays() const noexcept { return right_rays_; }

  private:
    /// Sub-pixel positions: offsets from the pixel centre in px.
    using Places = std::span<const std::array<double, 2>>;
    /// Outputs of `render_instant` that the caller needs.
    enum class Wanted : std::uint8_t { picture, picture_and_depth };
    Renderer(const Scene& scene,
             const camera::StereoRig& rig,
             const CameraConfig& config,
             std::uint64_t seed);
    void collect_camera(const RayField& rays,
                        const Motion& motion,
                        const Pose& T_body_camera,
                        double stamp_s,
                        double exposure_s,
                        Executor& executor,
                        CleanImage& instant,
                        CleanImage& out) const;
    void blur(const RayField& rays,
              const ImageViews& middle,
              std::span<const ImageViews> moving,
              Executor& executor,
              CleanImage& instant,
              CleanImage& out) const;
    void render_instant(const RayField& rays,
                        const ImageViews& views,
                        Places places,
                        Wanted wanted,
                        Executor& executor,
                        CleanImage& out) const;
    void shade_block(const RayField& rays,
                     const ImageViews& views,
                     int block_x,
                     int block_y,
                     const CastBlock& block,
                     CleanImage& out) const;
    void shade_by_face(const HitBatch& hits, const SightBatch& sights, std::span<Seen> out) const;
    void soften_block(const RayField& rays,
                      const ImageViews& views,
                      Places places,
                      int block_x,
                      int block_y,
                      CastBlock& block,
                      CleanImage& out) const;
    /// Unit normal noise of one image, smoothed as configured.
    [[nodiscard]] Image<float> noise_image(int width,
                                           int height,
                                           std::uint64_t stream,
                                           Executor& executor) const;
    void expose_camera(const CleanImage& clean,
                       const Shot& shot,
                       std::uint64_t stream,
                       Executor& executor,
                       GreyImage& out) const;

    const Scene* scene_;
    camera::StereoRig rig_;
    CameraConfig config_;
    std::uint64_t seed_ = 0;
    RayField left_rays_;
    RayField right_rays_;
    Shader shader_;
    PixelNoise noise_;
};

/// Exact disparity of a rectified left camera: fx * baseline / depth; NaN without a surface.
[[nodiscard]] Image<float> disparity_px(const Image<float>& depth_m,
                                        const camera::RectifiedRig& rig);

/// Exact disparity in the rectified left camera of a rig at a body pose, for rigs whose raw images
/// are distorted or rotated.
[[nodiscard]] Image<float> rectified_disparity_px(const Scene& scene,
                                                  const camera::RectifiedRig& rig,
                                                  const Pose& T_world_body,
                                                  Executor& executor);

}  // namespace surefoot::sim
