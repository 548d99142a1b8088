// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include "surefoot/core/config.hpp"

namespace surefoot::elevation {

/// Conditions under which a pixel of a depth image may give a height.
struct PixelFilterConfig {
    double max_outlier_probability = 0.2;  ///< kTrustedOutlierProbability
    bool surface_check = true;  ///< checks jumps and incidence; needs neighbours in the image
    int reach_px = 3;           ///< neighbours left, right, above and below at this distance
    double jump_px = 0.5;       ///< largest difference to the mean of two opposite neighbours
    double jump_sigma = 2.0;    ///< added to jump_px [sigma of the disparity]
    /// Matchers bridge depth edges with ramps along the line of sight. At 70 deg, ten frames of the
    /// simulated ZED invent ground in 4.3 % of the cells hidden behind drop edges and keep 96.0 %
    /// of the visible floor (docs/lab/correlated_depth.md).
    double max_incidence_deg = 70.0;
    /// A distant table top is observed at 80-84 deg; without its pixels, the floor under it becomes
    /// the surface. A table top is level; a bridge along the line of sight is not.
    double max_incidence_level_deg = 85.0;
    /// Surfaces with less tilt are level, if the line of sight is so flat that a level surface
    /// exceeds `max_incidence_deg`. Noise alone tilts a distant table top by 10 deg; a limit of
    /// 8 deg loses its far half (docs/lab/terrain.md). On steeper lines of sight, a surface with
    /// the same small tilt and flat incidence is a bridge behind a low kerb.
    double level_deg = 15.0;

    void describe(ConfigVisitor& visitor);
};

/// Disparities `reach_px` away from a pixel; NaN = no match or outside of the image.
struct Neighbours {
    float left_px = 0.0F;
    float right_px = 0.0F;
    float above_px = 0.0F;
    float below_px = 0.0F;
};

/// Filter settings and constants of the frame, in floats, for the check of a pixel.
struct SurfaceLimits {
    float fx_px = 0.0F;
    float fy_px = 0.0F;
    float per_reach = 0.0F;  ///< 1 / reach_px
    float jump_px = 0.0F;
    float jump_sigma = 0.0F;
    float up_x = 0.0F;  ///< unit vector against gravity in the camera frame
    float up_y = 0.0F;
    float up_z = 0.0F;
    float min_cosine_sq = 0.0F;
    float min_cosine_when_level_sq = 0.0F;
    float min_level_cosine_sq = 0.0F;
};

/// Decides from the disparities around a pixel if it lies on a surface that a stereo matcher can
/// measure. Holds the constants of a frame; cheap enough for every pixel.
///
/// A plane n . p = h projects to a disparity that is linear in the pixel, d = d0 + a du + b dv, and
///   n ~ (a fx, b fy, d - a fx x - b fy y)   at the ray (x, y, 1), with n . ray ~ d,
/// so the angle between normal and ray follows from the gradient alone.
class SurfaceCheck {
  public:
    /// `up_camera`: unit vector against gravity in the camera frame; zero = unknown, then no
    /// surface counts as level.
    SurfaceCheck(const PixelFilterConfig& config,
                 double fx_px,
                 double fy_px,
                 const Eigen::Vector3d& up_camera = Eigen::Vector3d::Zero());

    /// False for a disparity jump, grazing incidence, or no neighbour along the row or column.
    [[nodiscard]] bool accepts(const Neighbours& around,
                               float disparity_px,
                               float sigma_px,
                               float ray_x,
                               float ray_y) const noexcept {
        const SurfaceLimits& l = limits_;
        const float limit_px = l.jump_px + l.jump_sigma * sigma_px;
        const float a = gradient(around.left_px, around.right_px, disparity_px, limit_px) * l.fx_px;
        const float b =
            gradient(around.above_px, around.below_px, disparity_px, limit_px) * l.fy_px;
        const float c = disparity_px - a * ray_x - b * ray_y;
        const float normal_sq = a * a + b * b + c * c;
        const float ray_sq = ray_x * ray_x + ray_y * ray_y + 1.0F;
        const float norms_sq = normal_sq * ray_sq;
        const float facing_sq = disparity_px * disparity_px;  // comparisons are false for NaN
        if (facing_sq >= l.min_cosine_sq * norms_sq) return true;
        const float upward = a * l.up_x + b * l.up_y + c * l.up_z;
        const float rise = ray_x * l.up_x + ray_y * l.up_y + l.up_z;  // rise of the line of sight
        return rise * rise <= l.min_cosine_sq * ray_sq &&
               upward * upward >= l.min_level_cosine_sq * normal_sq &&
               facing_sq >= l.min_cosine_when_level_sq * norms_sq && upward != 0.0F;
    }

    [[nodiscard]] const SurfaceLimits& limits() const noexcept { return limits_; }

  private:
    /// Returns the gradient per pixel. If one side has no match, the other side is enough. Returns
    /// NaN if both sides have no match or if the three values do not lie on a line.
    [[nodiscard]] float gradient(float before_px,
                                 float after_px,
                                 float here_px,
                                 float limit_px) const noexcept {
        if (std::isnan(before_px)) return (after_px - here_px) * limits_.per_reach;
        if (std::isnan(after_px)) return (here_px - before_px) * limits_.per_reach;
        const float departure_px = std::abs(0.5F * (before_px + after_px) - here_px);
        return departure_px > limit_px ? NAN : 0.5F * (after_px - before_px) * limits_.per_reach;
    }

    SurfaceLimits limits_;
};

}  // namespace surefoot::elevation
