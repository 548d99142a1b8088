// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/sampling/pixel_filter.hpp"

#include <numbers>

#include "surefoot/core/depth_image.hpp"

namespace surefoot::elevation {

static_assert(static_cast<float>(PixelFilterConfig{}.max_outlier_probability) ==
              kTrustedOutlierProbability);

void PixelFilterConfig::describe(ConfigVisitor& visitor) {
    visitor.number("max_outlier_probability",
                   max_outlier_probability,
                   0.0,
                   1.0,
                   "largest outlier probability of a pixel that is fused into the map");
    visitor.boolean("surface_check",
                    surface_check,
                    "true: drop pixels at disparity jumps and at grazing incidence");
    visitor.integer("reach_px",
                    reach_px,
                    1,
                    20,
                    "distance from a pixel to the four neighbours with which it is compared [px]");
    visitor.number("jump_px",
                   jump_px,
                   0.0,
                   100.0,
                   "largest difference between a pixel's disparity and the mean of two opposite "
                   "neighbours; jump_sigma is added");
    visitor.number("jump_sigma",
                   jump_sigma,
                   0.0,
                   100.0,
                   "number of disparity sigmas that are added to the limit jump_px");
    visitor.number(
        "max_incidence_deg",
        max_incidence_deg,
        1.0,
        90.0,
        "largest angle between line of sight and surface normal at which a pixel is used");
    visitor.number("max_incidence_level_deg",
                   max_incidence_level_deg,
                   1.0,
                   90.0,
                   "largest angle between line of sight and surface normal at which a pixel on a "
                   "level surface (a distant table top) is used");
    visitor.number("level_deg",
                   level_deg,
                   0.0,
                   45.0,
                   "largest angle to the horizontal at which a surface counts as level");
}

namespace {

float squared_cosine(double angle_deg) {
    const double cosine = std::cos(angle_deg * std::numbers::pi / 180.0);
    return static_cast<float>(cosine * cosine);
}

}  // namespace

SurfaceCheck::SurfaceCheck(const PixelFilterConfig& config,
                           double fx_px,
                           double fy_px,
                           const Eigen::Vector3d& up_camera)
    : limits_{.fx_px = static_cast<float>(fx_px),
              .fy_px = static_cast<float>(fy_px),
              .per_reach = 1.0F / static_cast<float>(config.reach_px),
              .jump_px = static_cast<float>(config.jump_px),
              .jump_sigma = static_cast<float>(config.jump_sigma),
              .up_x = static_cast<float>(up_camera.x()),
              .up_y = static_cast<float>(up_camera.y()),
              .up_z = static_cast<float>(up_camera.z()),
              .min_cosine_sq = squared_cosine(config.max_incidence_deg),
              .min_cosine_when_level_sq = squared_cosine(config.max_incidence_level_deg),
              .min_level_cosine_sq = squared_cosine(config.level_deg)} {}

}  // namespace surefoot::elevation
