// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/terrain_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "service/console/numbers.hpp"
#include "studies/clouds/surface_dem.hpp"
#include "studies/runs/height_image.hpp"
#include "surefoot/eval/maps/dem.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/maps/dem_file.hpp"
#include "surefoot/io/maps/height_rules.hpp"
#include "surefoot/io/maps/snapshot_file.hpp"

namespace surefoot::app {
namespace {

using Eigen::Vector2d;

constexpr double kTenthMm_m = 1e-4;

TerrainMap map_of(io::Dem dem) {
    TerrainMap map;
    map.geometry = dem.geometry;
    map.height_m = std::move(dem.values);
    map.assumed = std::move(dem.notes);
    return map;
}

Result<TerrainMap> from_grid(const std::string& file) {
    auto dem = io::read_height_grid(file);
    if (!dem) return dem.error();
    TerrainMap map = map_of(std::move(dem).value());
    map.assumed.emplace_back("heights are exact, because the grid has no variances");
    return map;
}

Result<TerrainMap> from_image(const TerrainRequest& request) {
    auto dem = read_height_image(request.map, request.scale_m_per_px, request.height_m);
    if (!dem) return dem.error();
    TerrainMap map = map_of(std::move(dem).value());
    map.assumed.emplace_back("heights are exact, because an image has no variances");
    return map;
}

/// Reads a cloud. The ground of each cell is its highest supported surface.
Result<TerrainMap> from_cloud(const TerrainRequest& request) {
    const auto cloud = io::read_cloud(request.map);
    if (!cloud) return cloud.error();
    eval::CloudBounds bounds;
    bounds.add(cloud->points_m);
    const auto grid = bounds.grid(request.resolution_m, eval::Lattice::cell);
    if (!grid) {
        return Error{grid.error().code, fmt::format("{}: {}", request.map, grid.error().message)};
    }
    const auto rules = surface_rules(request.lowest_z_m, request.highest_z_m);
    if (!rules) return rules.error();
    auto dem = surface_dem(*grid, *rules, [&](const auto& take) { return take(cloud->points_m); });
    if (!dem) return dem.error();
    TerrainMap map;
    map.geometry = grid->geometry;
    map.height_m = std::move(dem->height_m);
    map.clearance_m = std::move(dem->clearance_m);
    map.assumed = {
        "z of the cloud points up",
        fmt::format("the ground of a cell of {:g} m is the highest surface that enough points "
                    "share and that does not hang in the air; its height is exact",
                    request.resolution_m)};
    if (const std::string text = left_out_text(*dem); !text.empty()) map.assumed.push_back(text);
    return map;
}

/// Reads another layer. Its cells must be those of `geometry`; otherwise an input error.
Result<grid::Layer> same_cells(const std::string& file, const grid::GridGeometry& geometry) {
    auto dem = io::read_esri_grid(file);
    if (!dem) return dem.error();
    const grid::GridGeometry& g = dem->geometry;
    if (g.nx != geometry.nx || g.ny != geometry.ny || g.resolution_m != geometry.resolution_m ||
        g.origin_m != geometry.origin_m) {
        return input_error(
            fmt::format("{}: the layer has {} x {} cells of {:g} m from ({:g}, {:g}), but the "
                        "height map in the same folder has {} x {} cells of {:g} m from ({:g}, "
                        "{:g}); give the files of one run",
                        file,
                        g.nx,
                        g.ny,
                        g.resolution_m,
                        g.origin_m.x(),
                        g.origin_m.y(),
                        geometry.nx,
                        geometry.ny,
                        geometry.resolution_m,
                        geometry.origin_m.x(),
                        geometry.origin_m.y()));
    }
    return std::move(dem->values);
}

/// Returns the number of observations of each cell; 0 for unknown cells.
Image<std::uint32_t> observations_of(const grid::Layer& count) {
    constexpr float kMost = 1e9F;
    Image<std::uint32_t> observations(count.width(), count.height(), 0);
    for (std::size_t i = 0; i < observations.size(); ++i) {
        const float value = count.data()[i];
        if (value > 0.0F)
            // in range: above 0 and at most kMost
            observations.data()[i] = static_cast<std::uint32_t>(std::min(value, kMost));
    }
    return observations;
}

/// Reads the layers that only `run --layers` writes.
Status read_optional_layers(const std::string& folder, TerrainMap& map) {
    const auto read = [&](const char* name, const char* without) -> Result<grid::Layer> {
        const std::string file = io::join_path(folder, name);
        if (io::is_file(file)) return same_cells(file, map.geometry);
        map.assumed.push_back(
            fmt::format("{} (there is no {}; 'surefoot run --layers' writes it)", without, name));
        return grid::Layer();
    };
    auto free_above =
        read("free_above.asc", "no line of sight shows that ground is lower than the map");
    if (!free_above) return free_above.error();
    map.free_above_m = std::move(free_above).value();
    auto clearance = read("clearance.asc", "no object hangs over the ground");
    if (!clearance) return clearance.error();
    map.clearance_m = std::move(clearance).value();
    auto density = read("density_ratio.asc", "no cell shows the points of a vertical face");
    if (!density) return density.error();
    map.density_ratio = std::move(density).value();
    map.assumed.emplace_back(
        "the viewing directions are not saved, so the end of the known ground does not count as a "
        "drop");
    const auto count = read("count.asc", "every cell was observed more than once");
    if (!count) return count.error();
    if (!count->empty()) map.observations = observations_of(*count);
    return {};
}

Result<TerrainMap> from_folder(const std::string& folder) {
    // ground.asc holds the ground heights of the map; elevation.asc of a run is for display.
    const std::string ground_file = io::join_path(folder, "ground.asc");
    const std::string height_file =
        io::is_file(ground_file) ? ground_file : io::join_path(folder, "elevation.asc");
    if (!io::is_file(height_file)) {
        return input_error(fmt::format(
            "{}: the folder has no elevation.asc; give the output folder of 'surefoot run', or a "
            "height map (.asc or .png), or a point cloud (PLY, PCD, LAS, VTK or XYZ)",
            folder));
    }
    auto height = io::read_height_grid(height_file);
    if (!height) return height.error();
    TerrainMap map = map_of(std::move(height).value());
    const std::string variance_file = io::join_path(folder, "variance.asc");
    if (io::is_file(variance_file)) {
        auto variance = same_cells(variance_file, map.geometry);
        if (!variance) return variance.error();
        map.height_var_m2 = std::move(variance).value();
    } else {
        map.assumed.push_back("heights are exact, because there is no variance.asc");
    }
    if (auto status = read_optional_layers(folder, map); !status) return status.error();
    const std::string snapshot_file = io::join_path(folder, "map.snapshot");
    if (!io::is_file(snapshot_file)) return map;
    const auto snapshot = io::read_snapshot(snapshot_file);
    if (!snapshot) return snapshot.error();
    const grid::MapSnapshot& s = **snapshot;
    Pose T_odom_body;
    T_odom_body.translation_m =
        kTenthMm_m * Eigen::Vector3d(static_cast<double>(s.body_x_tenth_mm),
                                     static_cast<double>(s.body_y_tenth_mm),
                                     static_cast<double>(s.body_z_tenth_mm));
    const double yaw = std::atan2(s.body_sin_yaw, s.body_cos_yaw);
    T_odom_body.rotation = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
    map.T_odom_body = T_odom_body;
    map.gravity_source = s.gravity_source;
    return map;
}

bool is_cloud(const std::string& extension) {
    constexpr std::array kExtensions{
        ".ply", ".pcd", ".xyz", ".las", ".vtk", ".txt", ".csv", ".pts"};
    return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

Result<TerrainMap> load_map(const TerrainRequest& request) {
    if (io::is_folder(request.map)) return from_folder(request.map);
    const std::string extension = io::extension_of(request.map);
    if (extension == ".png") return from_image(request);
    return is_cloud(extension) ? from_cloud(request) : from_grid(request.map);
}

Status check_cells(const std::string& file, const TerrainMap& map) {
    if (map.geometry.nx < 2 || map.geometry.ny < 2) {
        return input_error(
            fmt::format("{}: the map has {} x {} cells; an edge needs at least 2 x 2",
                        file,
                        map.geometry.nx,
                        map.geometry.ny));
    }
    for (std::size_t i = 0; i < map.height_m.size(); ++i)
        if (std::isfinite(map.height_m.data()[i])) return {};
    return input_error(
        fmt::format("{}: none of its {} x {} cells is known, so there is no result; if it is the "
                    "map of a run, its report.json says why it is empty",
                    file,
                    map.geometry.nx,
                    map.geometry.ny));
}

/// Returns the known cell nearest to the middle of the border with the smallest x.
Vector2d nearest_to_border(const TerrainMap& map) {
    const grid::GridGeometry& g = map.geometry;
    const Vector2d middle_m =
        g.origin_m + Vector2d(0.0, 0.5 * static_cast<double>(g.ny) * g.resolution_m);
    Vector2d nearest_m = middle_m;
    double least_m = std::numeric_limits<double>::infinity();
    for (int iy = 0; iy < g.ny; ++iy) {
        for (int ix = 0; ix < g.nx; ++ix) {
            if (!std::isfinite(map.height_m.at(ix, iy))) continue;
            const Vector2d center_m = g.center_m({ix, iy});
            const double distance_m = (center_m - middle_m).norm();
            if (distance_m >= least_m) continue;
            least_m = distance_m;
            nearest_m = center_m;
        }
    }
    return nearest_m;
}

Status stand_as_given(const std::string& from, TerrainMap& map) {
    const auto stance = parse_two_numbers("--from", from, "x,y (m)");
    if (!stance) return stance.error();
    map.stance_m = {(*stance)[0], (*stance)[1]};
    map.T_odom_body.reset();
    const grid::GridGeometry& g = map.geometry;
    if (g.cell_at(map.stance_m.x(), map.stance_m.y())) return {};
    return usage_error(
        fmt::format("--from '{}': the position is outside the map, which extends from ({:g}, {:g}) "
                    "to ({:g}, {:g}) m",
                    from,
                    g.origin_m.x(),
                    g.origin_m.y(),
                    g.origin_m.x() + g.nx * g.resolution_m,
                    g.origin_m.y() + g.ny * g.resolution_m));
}

/// Sets the default standing position: base_link of the run, else the origin, else the near border.
void stand_somewhere(TerrainMap& map) {
    if (map.T_odom_body) {
        map.stance_m = map.T_odom_body->translation_m.head<2>();
        map.assumed.push_back(
            fmt::format("the machine stands at ({:.3f}, {:.3f}): base_link of map.snapshot (--from "
                        "x,y changes it)",
                        map.stance_m.x(),
                        map.stance_m.y()));
        return;
    }
    const auto origin = map.geometry.cell_at(0.0, 0.0);
    if (origin && std::isfinite(map.height_m.at(origin->ix, origin->iy))) {
        map.stance_m = Vector2d::Zero();
        map.assumed.push_back("the machine stands at the origin (0, 0) (--from x,y changes it)");
        return;
    }
    map.stance_m = nearest_to_border(map);
    map.assumed.push_back(
        fmt::format("the machine stands at ({:.3f}, {:.3f}): the known cell nearest to the middle "
                    "of the border with the smallest x (--from x,y changes it)",
                    map.stance_m.x(),
                    map.stance_m.y()));
}

}  // namespace

stairs::Terrain TerrainMap::terrain() const {
    stairs::Terrain terrain;
    terrain.geometry = geometry;
    terrain.height_m = height_m.view();
    if (!height_var_m2.empty()) terrain.height_var_m2 = height_var_m2.view();
    if (!free_above_m.empty()) terrain.free_above_m = free_above_m.view();
    if (!clearance_m.empty()) terrain.clearance_m = clearance_m.view();
    if (!density_ratio.empty()) terrain.density_ratio = density_ratio.view();
    if (!observations.empty()) terrain.observations = observations.view();
    terrain.stance_m = stance_m;
    return terrain;
}

Result<TerrainMap> load_terrain(const TerrainRequest& request) {
    auto map = load_map(request);
    if (!map) return map.error();
    // Clouds also have marks for "no data". The readers of grids have already removed the marks of
    // grids.
    for (std::string& note : io::drop_impossible_heights(map->height_m))
        map->assumed.push_back(std::move(note));
    if (auto status = check_cells(request.map, *map); !status) return status.error();
    if (request.from.empty()) {
        stand_somewhere(*map);
    } else if (auto status = stand_as_given(request.from, *map); !status) {
        return status.error();
    }
    return map;
}

}  // namespace surefoot::app
