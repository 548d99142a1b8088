// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"

namespace surefoot::grid {

/// A rectangle of lattice cells. Cell k of the lattice covers [k resolution, (k+1) resolution) from
/// the origin of its frame, as in `MovingWindow`. Two regions with the same frame and resolution
/// therefore share their cells.
struct LatticeBox {
    std::int64_t first_ix = 0;  ///< lattice index of cell (0, 0)
    std::int64_t first_iy = 0;
    int nx = 0;
    int ny = 0;

    /// Returns the first problem (sides, number of cells, distance from the origin), or nullopt.
    [[nodiscard]] std::optional<std::string> problem() const;
    friend bool operator==(const LatticeBox&, const LatticeBox&) = default;
};

/// Limits of a region: at most the cells of 102 x 102 m at 25 mm (740 MB with all layers), within
/// 2^40 cells of the origin. There a double still resolves a thousandth of a cell.
inline constexpr int kMaxRegionSide = 1 << 14;
inline constexpr std::int64_t kMaxRegionCells = std::int64_t{1} << 24;
inline constexpr std::int64_t kMaxLatticeIndex = std::int64_t{1} << 40;
/// Longest name of a frame [bytes].
inline constexpr std::size_t kMaxFrameName = 31;

/// Returns the box of a geometry whose cells lie on the lattice.
[[nodiscard]] LatticeBox box_of(const GridGeometry& geometry);
/// Returns the smallest box around both boxes. This box may exceed the limits of a region.
[[nodiscard]] LatticeBox united(const LatticeBox& a, const LatticeBox& b);

/// A piece of an elevation map that can be stored, sent and merged: the knowledge about the ground
/// at `stamp_ns`. For the meaning of the layers see `elevation::ElevationLayers`. In an unknown
/// cell the height is NaN, count and seen are 0, and all other layers are NaN.
///
/// Variance and drift are relative to the body at `stamp_ns`. To use the region from another pose,
/// add the uncertainty of the motion in between (`elevation::pay_for_motion`).
struct MapRegion {
    double resolution_m = 0.025;
    LatticeBox box;

    std::string frame = "odom";  ///< frame of the lattice and of the heights
    /// Start time of the frame: the stamp of the run's first image. Every run has its own odom, so
    /// two frames are the same only if name and time agree.
    std::int64_t frame_since_ns = 0;
    std::int64_t stamp_ns = 0;
    Pose T_frame_body;  ///< pose of base_link at `stamp_ns`
    std::uint64_t config_hash = 0;

    Image<float> height_m;
    Image<float> height_var_m2;
    Image<std::uint32_t> count;
    Image<std::int64_t> seen_ns;
    Image<float> horizontal_drift_m;
    Image<float> highest_m;
    Image<float> lowest_m;
    Image<float> clearance_m;
    Image<float> confidence;
    Image<float> density_ratio;

    [[nodiscard]] GridGeometry geometry() const;
    [[nodiscard]] std::int64_t known_cells() const noexcept;
    /// Returns the first problem of the region, with the cell and the value, or nullopt.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// Name and unit of a layer, in files and tables.
struct RegionLayer {
    const char* name;
    const char* unit;  ///< empty = a pure number
};

/// Calls visit(RegionLayer, member, value of unknown cells) for every layer. This is the only list
/// of the layers. A member is a pointer to a member of MapRegion.
template <typename Visit>
void for_each_layer(const Visit& visit) {
    using R = MapRegion;
    visit(RegionLayer{"elevation", "m"}, &R::height_m, kNanF);
    visit(RegionLayer{"variance", "m2"}, &R::height_var_m2, kNanF);
    visit(RegionLayer{"count", ""}, &R::count, std::uint32_t{0});
    visit(RegionLayer{"seen", "ns"}, &R::seen_ns, std::int64_t{0});
    visit(RegionLayer{"drift", "m"}, &R::horizontal_drift_m, kNanF);
    visit(RegionLayer{"highest", "m"}, &R::highest_m, kNanF);
    visit(RegionLayer{"lowest", "m"}, &R::lowest_m, kNanF);
    visit(RegionLayer{"clearance", "m"}, &R::clearance_m, kNanF);
    visit(RegionLayer{"confidence", ""}, &R::confidence, kNanF);
    visit(RegionLayer{"density_ratio", ""}, &R::density_ratio, kNanF);
}

/// Returns the region, cut or extended to another box. Cells outside `region` are unknown.
/// `box.problem()` must be empty.
[[nodiscard]] MapRegion cut(MapRegion region, const LatticeBox& box);

/// Makes cell iy * nx + ix unknown.
void forget(MapRegion& region, std::size_t cell);

}  // namespace surefoot::grid
