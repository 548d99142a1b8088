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
/// the origin of its frame, as in `MovingWindow`: two regions of one frame and one resolution have
/// the same cells.
struct LatticeBox {
    std::int64_t first_ix = 0;  ///< lattice index of cell (0, 0)
    std::int64_t first_iy = 0;
    int nx = 0;
    int ny = 0;

    /// Why no region can have this box, or nothing: sides, number of cells, way from the origin.
    [[nodiscard]] std::optional<std::string> problem() const;
    friend bool operator==(const LatticeBox&, const LatticeBox&) = default;
};

/// Limits of a region: 102 m square at 25 mm, with all layers 740 MB; and 2^40 cells from the
/// origin, where a double still tells millionths of a cell.
inline constexpr int kMaxRegionSide = 1 << 14;
inline constexpr std::int64_t kMaxRegionCells = std::int64_t{1} << 24;
inline constexpr std::int64_t kMaxLatticeIndex = std::int64_t{1} << 40;
/// Longest name of a frame [bytes].
inline constexpr std::size_t kMaxFrameName = 31;

/// The box of a geometry whose cells lie on the lattice.
[[nodiscard]] LatticeBox box_of(const GridGeometry& geometry);
/// The smallest box around both; may be larger than any region.
[[nodiscard]] LatticeBox united(const LatticeBox& a, const LatticeBox& b);

/// A piece of an elevation map that can be kept, sent and put together with others: what was known
/// of the ground at `stamp_ns`. Meaning of the layers: `elevation::ElevationLayers`. A cell whose
/// height is NaN is unknown; then count and seen are 0 and all else is NaN.
///
/// Variance and drift are relative to the body at `stamp_ns`: whoever uses the region from another
/// pose adds what the way there may have blurred (`elevation::pay_for_motion`).
struct MapRegion {
    double resolution_m = 0.025;
    LatticeBox box;

    std::string frame = "odom";  ///< name of the frame that the lattice and the heights are in
    /// When that frame was placed: the stamp of the run's first image. Every run has an odom of its
    /// own, so a frame is the same only if name and time are.
    std::int64_t frame_since_ns = 0;
    std::int64_t stamp_ns = 0;
    Pose T_frame_body;  ///< base_link at `stamp_ns`
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
    /// First reason why this is no region, with the cell and the value; or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// What a layer is called and measured in, in files and tables alike.
struct RegionLayer {
    const char* name;
    const char* unit;  ///< empty = a pure number
};

/// Calls visit(RegionLayer, member, value of unknown cells) for every layer: the one list of
/// layers. A member is a pointer to one of the members of MapRegion.
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

/// What `region` knows of another box; cells that it does not reach are unknown. `box.problem()`
/// must be empty.
[[nodiscard]] MapRegion cut(MapRegion region, const LatticeBox& box);

/// Makes a cell unknown, named by iy * nx + ix.
void forget(MapRegion& region, std::size_t cell);

}  // namespace surefoot::grid
