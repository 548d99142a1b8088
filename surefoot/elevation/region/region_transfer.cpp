// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/region/region_transfer.hpp"

#include <cmath>

#include "surefoot/elevation/elevation_map.hpp"
#include "surefoot/elevation/motion/motion_update.hpp"

namespace surefoot::elevation {
namespace {

/// Makes cells unknown whose variance or drift has left the range of a float.
void forget_boundless(grid::MapRegion& region) {
    for (std::size_t cell = 0; cell < region.height_m.size(); ++cell) {
        if (std::isnan(region.height_m.data()[cell])) continue;
        if (std::isfinite(region.height_var_m2.data()[cell]) &&
            std::isfinite(region.horizontal_drift_m.data()[cell])) {
            continue;
        }
        grid::forget(region, cell);
    }
}

}  // namespace

grid::MapRegion region_of(const ElevationMap& map, const std::optional<grid::LatticeBox>& window) {
    const ElevationLayers& layers = map.layers();
    grid::MapRegion region;
    region.resolution_m = map.geometry().resolution_m;
    region.box = grid::box_of(map.geometry());
    region.height_m = layers.height_m.copy();
    region.height_var_m2 = layers.height_var_m2.copy();
    region.count = layers.count.copy();
    region.seen_ns = layers.seen_ns.copy();
    region.horizontal_drift_m = layers.horizontal_drift_m.copy();
    region.highest_m = layers.highest_m.copy();
    region.lowest_m = layers.lowest_m.copy();
    region.clearance_m = layers.clearance_m.copy();
    region.confidence = layers.confidence.copy();
    region.density_ratio = layers.density_ratio.copy();
    forget_boundless(region);
    return window ? grid::cut(std::move(region), *window) : region;
}

Status pay_for_motion(grid::MapRegion& region,
                      const Pose& T_frame_body,
                      const Matrix6& covariance) {
    const MotionNoise noise(covariance, T_frame_body.R());
    if (!T_frame_body.all_finite() || !noise.is_finite()) {
        return input_error(
            "the covariance or the pose that places the map is not finite, so the position of the "
            "cells is unknown: give finite values");
    }
    const grid::GridGeometry geometry = region.geometry();
    for (int iy = 0; iy < region.box.ny; ++iy) {
        const Eigen::Vector2d first_m =
            geometry.center_m({0, iy}) - T_frame_body.translation_m.head<2>();
        noise.blur_row(
            {first_m.x(), first_m.y(), region.resolution_m, T_frame_body.translation_m.z()},
            region.box.nx,
            region.height_m.row(iy),
            region.height_var_m2.row(iy),
            region.horizontal_drift_m.row(iy));
    }
    forget_boundless(region);
    region.T_frame_body = T_frame_body;
    return {};
}

}  // namespace surefoot::elevation
