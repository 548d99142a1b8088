// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/core/depth_image.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/sim/rendering/ray_field.hpp"
#include "surefoot/sim/rendering/smooth_noise.hpp"
#include "surefoot/sim/scenes/scene.hpp"
#include "surefoot/sim/sensors/stereo_shadows.hpp"

namespace surefoot::sim {

/// Error model of a stereo matcher. Pixels are those of the full rectified image for any stride.
///
/// Disparity of a pixel that both cameras see = exact + white + correlated + locking, with
///   white       independent in every pixel and frame, variance (1 - correlated_share) sigma^2
///   correlated  smooth over `correlation_px`, variance correlated_share sigma^2. The share
///               `fixed_share` of this variance is attached to the surface: a mean over frames does
///               not remove it.
///   locking     locking_px sin(2 pi d), d = exact disparity: repeats with each whole disparity
/// Beside a jump, a seam of pixels gets the disparity of the nearer surface (Shadow::fattened). A
/// share of ramp and occluded pixels is interpolated; other occluded or outside ones are unknown.
///
/// Nominal sigma: best planar windows of real pairs scatter by 0.28-0.43 px; 0.25 px is the nominal
/// figure of the project's accuracy tables. ASSUMPTION: every other default, until measured on
/// rendered kerbs and stairs.
struct AnalyticStereoConfig {
    int stride = 1;                 ///< distance between used rows and columns [px]; 1 = all
    double sigma_px = 0.25;         ///< one sigma of the white and correlated noise together
    double correlated_share = 0.5;  ///< share of the noise variance that is correlated
    double correlation_px = 15.0;   ///< lag at which correlation has fallen to 1/e
    double fixed_share = 0.3;       ///< share of the correlated variance attached to the surface
    double fixed_size_m = 0.09;     ///< correlation length on the surface: 30 px at 1 m
    double locking_px = 0.05;       ///< amplitude of the error that repeats with each pixel
    double sigma_factor = 1.0;      ///< reported sigma / true sigma; < 1 = optimistic

    ShadowConfig shadow;
    double invented_share = 0.5;    ///< share of ramp and occluded pixels that are interpolated
    double edge_suspicion = 0.15;   ///< outlier probability reported in seams and ramps
    double plain_suspicion = 0.02;  ///< outlier probability reported elsewhere

    double max_disparity_px = 128.0;  ///< largest disparity of the search range
    double missing_share = 0.02;      ///< share of the pixels lost without a cause, in patches
    double patch_px = 8.0;
    double fade_incidence_deg = 75.0;  ///< incidence from which pixels begin to be lost
    double max_incidence_deg = 85.0;   ///< incidence from which all pixels are lost
    double least_contrast =
        0.1;  ///< lowest contrast that loses no pixels; half of it loses half of the pixels

    void describe(ConfigVisitor& visitor);
};

/// Computes the output of rectification and a matcher straight from the scene geometry; it renders
/// no image. With every error at 0 it equals `rectified_disparity_px` where both cameras see the
/// point. Mirrors and glass return nothing (ASSUMPTION). Occlusion uses only surfaces that the left
/// camera sees; an object that only the right camera sees hides nothing. Immutable after
/// construction; the executor does not change the result.
class AnalyticStereo {
  public:
    /// `rig`: the full rectified camera. Fails on an unusable stride or share. The scene must
    /// outlive the object.
    [[nodiscard]] static Result<AnalyticStereo> make(const Scene& scene,
                                                     const camera::RectifiedRig& rig,
                                                     const AnalyticStereoConfig& config,
                                                     std::uint64_t seed);
    /// The camera of the depth images: for stride 1 the `rig` of `make`. Otherwise a smaller camera
    /// with proportionally shorter focal lengths; disparities are in its own pixels.
    [[nodiscard]] const camera::RectifiedRig& rig() const noexcept { return rig_; }
    /// View of the left camera before errors. Reuse the object, so that it allocates memory once.
    struct View {
        Image<float> disparity_px;  ///< exact, in output pixels; NaN without a surface
        Image<std::int32_t> surface;
        Image<float> fixed;           ///< noise of the surface, variance 1 (fixed_share)
        Image<float> missing_chance;  ///< probability of no match; 1 = never matched
        ShadowMap shadows;
    };
    /// `frame` selects the noise.
    void measure(
        const Pose& T_world_body, int frame, Executor& executor, View& view, DepthImage& out) const;

  private:
    AnalyticStereo(const Scene& scene,
                   const camera::RectifiedRig& rig,
                   const AnalyticStereoConfig& config,
                   std::uint64_t seed);
    void cast(const Pose& T_world_body, Executor& executor, View& out) const;
    /// Properties of the surface point that a ray hits.
    struct Look {
        float fixed = 0.0F;
        float missing_chance = 1.0F;
    };
    [[nodiscard]] Look look(const Eigen::Vector3d& point_m,
                            const Eigen::Vector3d& direction,
                            int surface,
                            SurfaceNoise::Square& square) const;
    void cast_rows(const Pose& T_world_camera, int block_y, View& out) const;
    struct Match {
        float disparity_px = 0.0F;  ///< NaN = no match
        bool invented = false;
    };
    [[nodiscard]] Match match(const View& view, int u, int v, float luck) const;
    void measure_row(const View& view,
                     int v,
                     std::span<const float> whites,
                     std::span<const float> errors,
                     std::span<const float> luck,
                     DepthImage& out) const;
    [[nodiscard]] double known_share(const Material& material) const;
    [[nodiscard]] double missing_chance(double known, double cosine) const;

    const Scene* scene_;
    AnalyticStereoConfig config_;
    std::uint64_t seed_ = 0;
    camera::RectifiedRig rig_;
    RayField rays_;
    PixelNoise noise_;
    SurfaceNoise surface_noise_;
    std::vector<double> known_;  ///< matched share of each surface, seen head-on
    bool fixed_noise_ = false;   ///< true: noise is attached to the surfaces
    double fade_cosine_ = 0.0;   ///< cosine of `fade_incidence_deg`
    std::vector<float> cdf_;
};

}  // namespace surefoot::sim
