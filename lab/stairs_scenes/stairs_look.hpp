// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/stairs/terrain.hpp"

/// What `stairs_truth` gives the finder, with what is true: kept in memory and in files.
namespace surefoot::experiments {

enum class TrueKind : std::uint8_t { none, up, down, kerb, door };
inline constexpr const char* kTrueKindNames[] = {"none", "up", "down", "kerb", "door"};

/// What stands in a scene. Frame of the map.
struct TrueFeature {
    TrueKind kind = TrueKind::none;
    int steps = 0;
    double riser_m = 0.0;  ///< of a kerb: its height
    double going_m = 0.0;
    double width_m = 0.0;
    double sill_m = 0.0;
    /// Middle of the first edge or of the opening; of a kerb the point straight ahead.
    Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
    double yaw_rad = 0.0;  ///< leads over it
    double ahead_m = 0.0;  ///< how far the left camera is from its line, across it
};

/// A map at one moment.
struct Look {
    std::string scene;
    std::uint64_t seed = 0;
    std::string mode;
    int frame = 0;
    double noise_px = 0.0;  ///< scatter of disparities on level floor, see stairs_scene.hpp
    double bias_px = 0.0;   ///< their mean error
    double said_px = 0.0;   ///< median sigma that the matcher states there
    TrueFeature truth;

    grid::GridGeometry geometry;
    grid::Layer height_m;
    grid::Layer height_var_m2;
    grid::Layer free_above_m;
    grid::Layer clearance_m;
    grid::Layer density_ratio;
    Image<std::uint32_t> looks;
    Eigen::Vector2d stance_m = Eigen::Vector2d::Zero();
    stairs::View view;  ///< of the last frame, as what follows
    Image<float> disparity_px;
    Image<float> disparity_sigma_px;

    /// Views of the layers.
    [[nodiscard]] stairs::Terrain terrain() const;
    [[nodiscard]] std::string folder_name() const;  ///< "up_common_21_f32"
};

/// A scene file is called by what stands behind its '#', or by its own name.
[[nodiscard]] std::string short_name(const std::string& scene);

/// Writes a folder: height.asc, variance.asc, free_above.asc, clearance.asc, density.asc,
/// looks.asc, cut to what is known, disparity.pfm and disparity_sigma.pfm, and last truth.txt with
/// what is true and the size of the whole map.
[[nodiscard]] Status save_look(const Look& look, const std::string& folder);
/// The whole map again.
[[nodiscard]] Result<Look> read_look(const std::string& folder);

}  // namespace surefoot::experiments
