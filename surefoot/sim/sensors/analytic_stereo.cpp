// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/sensors/analytic_stereo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/sim/rendering/ray_caster.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector3d;

/// Number of independent random streams per frame, their names, and the stream that all frames
/// share.
constexpr std::uint64_t kStreams = 3;
enum Stream : std::uint64_t { white, correlated, luck };
constexpr std::uint64_t kSurfaceStream = ~std::uint64_t{0};

/// Table of the normal distribution over [-4, 4]; `luck` needs an accuracy of 1/500 only.
constexpr int kCdfEnd = 4;
constexpr int kCdfPerUnit = 128;

std::vector<float> normal_cdf() {
    std::vector<float> table;
    for (int i = 0; i <= 2 * kCdfEnd * kCdfPerUnit; ++i) {
        const double x = static_cast<double>(i) / kCdfPerUnit - kCdfEnd;
        table.push_back(static_cast<float>(0.5 * std::erfc(-x / std::numbers::sqrt2)));
    }
    return table;
}

float uniform_from(const std::vector<float>& cdf, float normal) {
    const float place = (normal + static_cast<float>(kCdfEnd)) * static_cast<float>(kCdfPerUnit);
    return cdf[std::min(saturated_integer<std::size_t>(place + 0.5F), cdf.size() - 1)];
}

/// Returns the camera of every `stride`-th pixel; the first pixel is in the middle of `stride`
/// pixels.
camera::RectifiedRig thinned(const camera::RectifiedRig& full, int stride) {
    const int first = stride / 2;
    camera::RectifiedRig rig = full;
    rig.width = (full.width - first + stride - 1) / stride;
    rig.height = (full.height - first + stride - 1) / stride;
    rig.fx_px = full.fx_px / stride;
    rig.fy_px = full.fy_px / stride;
    rig.cx_px = (full.cx_px - first) / stride;
    rig.cy_px = (full.cy_px - first) / stride;
    return rig;
}

camera::Camera ideal(const camera::RectifiedRig& rig) {
    camera::PinholeRadTan lens;
    lens.fx_px = rig.fx_px;
    lens.fy_px = rig.fy_px;
    lens.cx_px = rig.cx_px;
    lens.cy_px = rig.cy_px;
    return {lens, rig.width, rig.height};
}

/// Errors of one frame in units of the output's pixels.
struct Scales {
    float white_px = 0.0F;
    float correlated_px = 0.0F;
    float fixed_px = 0.0F;
    float locking_px = 0.0F;
    float reported_px = 0.0F;
    float full_pixels = 1.0F;  ///< number of real pixels across one output pixel

    explicit Scales(const AnalyticStereoConfig& config) {
        const double sigma_px = config.sigma_px / config.stride;
        const double smooth_px = sigma_px * std::sqrt(config.correlated_share);
        const double amplitude_px = config.locking_px / config.stride;
        white_px = static_cast<float>(sigma_px * std::sqrt(1.0 - config.correlated_share));
        correlated_px = static_cast<float>(smooth_px * std::sqrt(1.0 - config.fixed_share));
        fixed_px = static_cast<float>(smooth_px * std::sqrt(config.fixed_share));
        locking_px = static_cast<float>(amplitude_px);
        // The variance of a sine over many periods is half of its squared amplitude.
        reported_px =
            static_cast<float>(config.sigma_factor *
                               std::sqrt(sigma_px * sigma_px + 0.5 * amplitude_px * amplitude_px));
        full_pixels = static_cast<float>(config.stride);
    }
};

}  // namespace

void AnalyticStereoConfig::describe(ConfigVisitor& visitor) {
    visitor.integer(
        "stride",
        stride,
        1,
        16,
        "distance in pixels between the rows and columns that are used; 1 = every row and column");
    visitor.number("sigma_px",
                   sigma_px,
                   0.0,
                   10.0,
                   "one sigma of the white and correlated disparity noise together");
    visitor.number("correlated_share",
                   correlated_share,
                   0.0,
                   1.0,
                   "share of the noise variance that is correlated between pixels");
    visitor.number("correlation_px",
                   correlation_px,
                   1.0,
                   500.0,
                   "distance at which the correlation of the noise has fallen to 1/e");
    visitor.number("fixed_share",
                   fixed_share,
                   0.0,
                   1.0,
                   "share of the correlated variance that is attached to the surface and repeats "
                   "in every frame");
    visitor.number(
        "fixed_size_m",
        fixed_size_m,
        0.001,
        10.0,
        "correlation length, on the surface, of the noise that is attached to the surface");
    visitor.number(
        "locking_px",
        locking_px,
        0.0,
        0.5,
        "amplitude of the disparity error that repeats with each whole pixel of disparity");
    visitor.number("sigma_factor",
                   sigma_factor,
                   0.01,
                   100.0,
                   "reported sigma of a disparity divided by its true sigma");
    visitor.number("jump_px",
                   shadow.jump_px,
                   0.0,
                   100.0,
                   "smallest disparity jump between neighbouring pixels that counts as an edge, in "
                   "addition to a slope of 0.2 px per px");
    visitor.number(
        "fattening_px",
        shadow.fattening_px,
        0.0,
        100.0,
        "width of the seam beside an edge that gets the disparity of the nearer surface");
    visitor.number(
        "ramp_px",
        shadow.ramp_px,
        0.0,
        250.0,
        "largest width, beside an edge, of the ramps in which disparities may be interpolated");
    visitor.number("invented_share",
                   invented_share,
                   0.0,
                   1.0,
                   "share of the pixels in ramps and of the occluded pixels that get interpolated "
                   "disparities");
    visitor.number("edge_suspicion",
                   edge_suspicion,
                   0.0,
                   1.0,
                   "outlier probability reported in the seams and ramps beside edges");
    visitor.number("plain_suspicion",
                   plain_suspicion,
                   0.0,
                   1.0,
                   "outlier probability reported outside the seams and ramps beside edges");
    visitor.number(
        "max_disparity_px", max_disparity_px, 1.0, 4096.0, "largest disparity of the search range");
    visitor.number("missing_share",
                   missing_share,
                   0.0,
                   1.0,
                   "share of the pixels that are lost in patches without a cause in the scene");
    visitor.number("patch_px",
                   patch_px,
                   1.0,
                   500.0,
                   "size of the patches that are lost without a cause in the scene");
    visitor.number("fade_incidence_deg",
                   fade_incidence_deg,
                   0.0,
                   90.0,
                   "angle of incidence from which pixels begin to be lost");
    visitor.number("max_incidence_deg",
                   max_incidence_deg,
                   0.0,
                   90.0,
                   "angle of incidence from which all pixels are lost");
    visitor.number(
        "least_contrast",
        least_contrast,
        0.0,
        1.0,
        "lowest contrast of a texture that causes no loss of pixels; at half of this contrast, "
        "half of the pixels are lost");
}

Result<AnalyticStereo> AnalyticStereo::make(const Scene& scene,
                                            const camera::RectifiedRig& rig,
                                            const AnalyticStereoConfig& config,
                                            std::uint64_t seed) {
    if (config.stride < 1 || config.stride > std::min(rig.width, rig.height)) {
        return usage_error(
            fmt::format("simulator: analytic stereo: stride = {} must be between 1 and the {} px "
                        "of the shorter image side",
                        config.stride,
                        std::min(rig.width, rig.height)));
    }
    const auto is_share = [](double value) { return value >= 0.0 && value <= 1.0; };
    if (!is_share(config.correlated_share) || !is_share(config.fixed_share)) {
        return usage_error(
            fmt::format("simulator: analytic stereo: correlated_share = {} and fixed_share = {} "
                        "must both be between 0 and 1",
                        config.correlated_share,
                        config.fixed_share));
    }
    return AnalyticStereo(scene, rig, config, seed);
}

AnalyticStereo::AnalyticStereo(const Scene& scene,
                               const camera::RectifiedRig& rig,
                               const AnalyticStereoConfig& config,
                               std::uint64_t seed)
    : scene_(&scene),
      config_(config),
      seed_(seed),
      rig_(thinned(rig, config.stride)),
      rays_(ideal(rig_)),
      surface_noise_(mix_seed(seed, kSurfaceStream), config.fixed_size_m),
      fixed_noise_(config.sigma_px > 0.0 && config.correlated_share > 0.0 &&
                   config.fixed_share > 0.0),
      fade_cosine_(std::cos(config.fade_incidence_deg / kDegPerRad)),
      cdf_(normal_cdf()) {
    known_.reserve(scene.surfaces().size());
    for (const Surface& surface : scene.surfaces()) {
        known_.push_back(
            known_share(scene.materials()[static_cast<std::size_t>(surface.material)]));
    }
}

void AnalyticStereo::cast(const Pose& T_world_body, Executor& executor, View& out) const {
    const Pose T_world_camera = T_world_body * rig_.T_body_camera;
    out.disparity_px.resize(rig_.width, rig_.height);
    out.surface.resize(rig_.width, rig_.height);
    out.fixed.resize(rig_.width, rig_.height);
    out.missing_chance.resize(rig_.width, rig_.height);
    executor.parallel_for(rays_.blocks_y(),
                          [&](int block_y) { cast_rows(T_world_camera, block_y, out); });
}

/// Casts one row of blocks.
void AnalyticStereo::cast_rows(const Pose& T_world_camera, int block_y, View& out) const {
    const ImageViews views(T_world_camera);
    const double depth_to_disparity_px_m = rig_.depth_to_disparity_px_m();
    CastBlock block;
    SurfaceNoise::Square square;
    for (int block_x = 0; block_x < rays_.blocks_x(); ++block_x) {
        cast_block(*scene_, rays_, views, block_x, block_y, block);
        const double* ray_z = rays_.block(block_x, block_y).z;
        std::size_t i = 0;
        for (int v = block.v0; v < block.v0 + block.height; ++v) {
            float* disparity_px = out.disparity_px.row(v);
            float* fixed = out.fixed.row(v);
            float* missing_chance = out.missing_chance.row(v);
            for (int u = block.u0; u < block.u0 + block.width; ++u, ++i) {
                const RayHit hit = block.hits[i];
                out.surface.row(v)[u] = hit.face;
                disparity_px[u] = kNanF;
                missing_chance[u] = 1.0F;
                if (hit.face < 0) continue;
                // The depth is rounded to float, as in the depth images of the renderer.
                const auto depth_m = static_cast<float>(hit.distance_m * ray_z[i]);
                disparity_px[u] =
                    static_cast<float>(depth_to_disparity_px_m / static_cast<double>(depth_m));
                const Vector3d direction = block.directions[i];
                const Look seen = look(T_world_camera.translation_m + hit.distance_m * direction,
                                       direction,
                                       hit.face,
                                       square);
                fixed[u] = seen.fixed;
                missing_chance[u] = seen.missing_chance;
            }
        }
    }
}

AnalyticStereo::Look AnalyticStereo::look(const Vector3d& point_m,
                                          const Vector3d& direction,
                                          int surface,
                                          SurfaceNoise::Square& square) const {
    const auto index = static_cast<std::size_t>(surface);
    const FaceFrame& frame = scene_->surfaces()[index].frame;
    double u_m = 0.0;
    double v_m = 0.0;
    double cosine = 0.0;
    if (frame.curved) {
        const SurfacePoint at = scene_->surface_point(surface, point_m);
        u_m = at.u_m;
        v_m = at.v_m;
        cosine = -at.normal.dot(direction);
    } else {
        u_m = frame.tangent_u.dot(point_m);
        v_m = frame.tangent_v.dot(point_m);
        cosine = -frame.normal.dot(direction);
    }
    Look seen;
    seen.missing_chance = static_cast<float>(missing_chance(known_[index], cosine));
    if (fixed_noise_) seen.fixed = surface_noise_.at(noise_, surface, u_m, v_m, square);
    return seen;
}

double AnalyticStereo::known_share(const Material& material) const {
    if (material.finish != Finish::matte) return 0.0;
    const double known = 1.0 - config_.missing_share;
    return material.contrast < config_.least_contrast
               ? known * (material.contrast / config_.least_contrast)
               : known;
}

double AnalyticStereo::missing_chance(double known, double cosine) const {
    if (cosine < fade_cosine_) {
        const double incidence_deg = std::acos(std::clamp(cosine, 0.0, 1.0)) * kDegPerRad;
        const double width_deg = config_.max_incidence_deg - config_.fade_incidence_deg;
        if (incidence_deg >= config_.max_incidence_deg) return 1.0;
        known *= (config_.max_incidence_deg - incidence_deg) / width_deg;
    }
    return 1.0 - known;
}

void AnalyticStereo::measure(
    const Pose& T_world_body, int frame, Executor& executor, View& view, DepthImage& out) const {
    cast(T_world_body, executor, view);
    find_shadows(
        view.disparity_px, view.surface, config_.shadow, config_.stride, executor, view.shadows);

    const std::uint64_t stream = kStreams * static_cast<std::uint64_t>(frame);
    const auto smooth = [&](std::uint64_t of, double length_px) {
        return SmoothNoise(noise_,
                           mix_seed(seed_, stream + of),
                           rig_.width,
                           rig_.height,
                           config_.stride,
                           length_px);
    };
    const SmoothNoise errors = smooth(correlated, config_.correlation_px);
    const SmoothNoise fortune = smooth(luck, config_.patch_px);
    const std::uint64_t white_key = PixelNoise::key(seed_, stream + white);
    out.resize(rig_.width, rig_.height);
    executor.parallel_for(rig_.height, [&](int v) {
        std::vector<float> scratch;
        std::vector<float> white_row(static_cast<std::size_t>(rig_.width));
        std::vector<float> error_row(static_cast<std::size_t>(rig_.width));
        std::vector<float> luck_row(static_cast<std::size_t>(rig_.width));
        noise_.fill(white_key, static_cast<std::uint32_t>(v * rig_.width), white_row);
        errors.row(v, scratch, error_row);
        fortune.row(v, scratch, luck_row);
        measure_row(view, v, white_row, error_row, luck_row, out);
    });
}

/// Returns the disparity that the matcher finds in a pixel, before noise.
AnalyticStereo::Match AnalyticStereo::match(const View& view, int u, int v, float luck) const {
    const Shadow shadow = view.shadows.shadow.row(v)[u];
    const bool hidden = shadow == Shadow::occluded;
    const bool bridged =
        (hidden || shadow == Shadow::ramp) && luck < static_cast<float>(config_.invented_share);
    Match match;
    match.invented = bridged || shadow == Shadow::fattened;
    const float found_px =
        match.invented ? view.shadows.bridge_px.row(v)[u] : view.disparity_px.row(v)[u];
    const auto search_px = static_cast<float>(config_.max_disparity_px / config_.stride);
    // This test uses the upper end of `luck`, and the bridges use its lower end. So bridged pixels
    // are missing only if the two chances together exceed 1.
    const bool missing = 1.0F - luck < view.missing_chance.row(v)[u];
    const bool nothing = shadow == Shadow::outside || (hidden && !bridged) || missing;
    match.disparity_px = nothing || !(found_px <= search_px) ? kNanF : found_px;
    return match;
}

void AnalyticStereo::measure_row(const View& view,
                                 int v,
                                 std::span<const float> whites,
                                 std::span<const float> errors,
                                 std::span<const float> luck,
                                 DepthImage& out) const {
    constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;
    const Scales scale(config_);
    for (int u = 0; u < rig_.width; ++u) {
        const auto column = static_cast<std::size_t>(u);
        const Match found = match(view, u, v, uniform_from(cdf_, luck[column]));
        float measured_px = found.disparity_px + scale.white_px * whites[column] +
                            scale.correlated_px * errors[column] +
                            scale.fixed_px * view.fixed.row(v)[u];
        if (scale.locking_px > 0.0F) {
            measured_px +=
                scale.locking_px * std::sin(kTurn * scale.full_pixels * found.disparity_px);
        }
        // This test also drops pixels whose errors make the disparity zero or negative.
        const bool known = measured_px > 0.0F;
        const double suspicion = found.invented ? config_.edge_suspicion : config_.plain_suspicion;
        out.disparity_px.row(v)[u] = known ? measured_px : kNanF;
        out.sigma_px.row(v)[u] = known ? scale.reported_px : kNanF;
        out.outlier_probability.row(v)[u] = known ? static_cast<float>(suspicion) : 1.0F;
    }
}

}  // namespace surefoot::sim
