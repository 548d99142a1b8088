// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/grid/map_snapshot.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::app {

/// The height map to load and the options of its file type.
struct TerrainRequest {
    std::string map;  ///< file .asc, .png or a cloud, or the folder of a run
    /// Standing position "x,y" [m]; empty = load_terrain() chooses it from the map.
    std::string from;
    double scale_m_per_px = 0.0;       ///< PNG: size of a pixel [m]
    double height_m = 0.0;             ///< PNG: height of the brightest value [m]
    double resolution_m = 0.025;       ///< cloud: cell size [m]
    std::optional<double> lowest_z_m;  ///< cloud: lower points are ignored
    std::optional<double> highest_z_m;
};

/// The heights of a file or folder, the other known layers, the standing position, and the
/// assumptions that the data needed.
struct TerrainMap {
    grid::GridGeometry geometry;
    grid::Layer height_m;
    grid::Layer height_var_m2;  ///< this and the following layers: empty = unknown
    grid::Layer free_above_m;
    grid::Layer clearance_m;
    grid::Layer density_ratio;
    Image<std::uint32_t> observations;
    Eigen::Vector2d stance_m = Eigen::Vector2d::Zero();
    std::optional<Pose> T_odom_body;  ///< pose of the machine, if known
    /// Gravity source of the run that made the map; grids, images and clouds do not store it.
    grid::GravitySource gravity_source = grid::GravitySource::assumed;
    std::vector<std::string> assumed;

    /// Returns views of the layers; the map must outlive them.
    [[nodiscard]] stairs::Terrain terrain() const;
};

/// Reads an ESRI grid, a height image, a cloud with z up, or the folder of a run. Errors name the
/// problem, the file and the remedy. A map without a known cell is an error.
[[nodiscard]] Result<TerrainMap> load_terrain(const TerrainRequest& request);

}  // namespace surefoot::app
