// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/stairs/terrain.hpp"

/// Input of the stairs detector at one frame together with the ground truth, in memory and in
/// files. `stairs_truth` writes these files; `stairs_follow` reads them.
namespace surefoot::experiments {

enum class TrueKind : std::uint8_t { none, up, down, kerb, door };
inline constexpr const char* kTrueKindNames[] = {"none", "up", "down", "kerb", "door"};

/// True stairs, kerb or door of a scene, in the map's frame (odom).
struct TrueFeature {
    TrueKind kind = TrueKind::none;
    int steps = 0;
    double riser_m = 0.0;  ///< height of a riser [m]; kerb: height of the kerb
    double going_m = 0.0;
    double width_m = 0.0;
    double sill_m = 0.0;
    /// Middle of the first edge or of the door opening; kerb: the point of its edge straight ahead.
    Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
    double yaw_rad = 0.0;  ///< direction of travel across the edge
    double ahead_m = 0.0;  ///< distance from the left camera to the edge line, along yaw_rad
};

/// Map, camera view and ground truth after one frame.
struct Observation {
    std::string scene;
    std::uint64_t seed = 0;
    std::string mode;
    int frame = 0;
    double noise_px = 0.0;  ///< scatter of disparity errors on level floor; see look_at
    double bias_px = 0.0;   ///< mean disparity error at the same pixels
    double said_px = 0.0;   ///< median sigma that the matcher states at these pixels
    TrueFeature truth;

    grid::GridGeometry geometry;
    grid::Layer height_m;
    grid::Layer height_var_m2;
    grid::Layer free_above_m;
    grid::Layer clearance_m;
    grid::Layer density_ratio;
    Image<std::uint32_t> observations;  ///< number of measurements of each cell
    Eigen::Vector2d stance_m = Eigen::Vector2d::Zero();
    stairs::View view;  ///< camera view of this frame; the disparities below belong to it
    Image<float> disparity_px;
    Image<float> disparity_sigma_px;

    /// Returns views of the layers; they are valid while this object lives.
    [[nodiscard]] stairs::Terrain terrain() const;
    [[nodiscard]] std::string folder_name() const;  ///< "up_common_21_f32"
};

/// Returns the short name of a scene: the part behind the last '#' or '/', up to the first '.'.
[[nodiscard]] std::string short_name(const std::string& scene);

/// Writes a folder. Its layers are height.asc, variance.asc, free_above.asc, clearance.asc,
/// density.asc and looks.asc, cropped to the known cells. Other files: disparity.pfm,
/// disparity_sigma.pfm, and truth.txt with the ground truth and the size of the whole map.
/// truth.txt is written last and marks the folder as complete.
[[nodiscard]] Status save_observation(const Observation& observation, const std::string& folder);
/// Reads a folder that save_observation() wrote, and restores the map in its full size.
[[nodiscard]] Result<Observation> read_observation(const std::string& folder);

}  // namespace surefoot::experiments
