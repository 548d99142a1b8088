// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "surefoot/core/camera_state.hpp"

namespace surefoot::grid {

/// Origin of the height of a cell.
enum class EvidenceSource : std::uint8_t { unknown = 0, measured = 1, attested = 2 };

/// Source of the gravity direction; `assumed` makes the gate answer ERROR.
enum class GravitySource : std::uint8_t { assumed = 0, plane = 1, imu = 2 };

/// Health of the motion estimate at the time of the snapshot (like core Health, fixed width).
enum class SnapshotHealth : std::uint8_t { lost = 0, degraded = 1, ok = 2 };

/// A line where the ground drops. Seen from the first end to the second, the lower ground lies on
/// the right. Plain integers. Edges of a snapshot from index `edge_count` on are 0.
struct SnapshotEdge {
    std::int32_t from_x_tenth_mm = 0;  ///< relative to the snapshot's origin, like the next three
    std::int32_t from_y_tenth_mm = 0;
    std::int32_t to_x_tenth_mm = 0;
    std::int32_t to_y_tenth_mm = 0;
    std::int32_t upper_tenth_mm = 0;  ///< height of the ground above the edge
    /// Height of the ground below the edge, or an upper bound if it was not visible.
    std::int32_t lower_tenth_mm = 0;
    std::int32_t height_sigma_tenth_mm = 0;  ///< sigma of upper minus lower, rounded up
    std::int32_t across_sigma_tenth_mm = 0;  ///< sigma of the position across the line, rounded up
    friend bool operator==(const SnapshotEdge&, const SnapshotEdge&) = default;
};

/// All map data of the step gate: a plain block of memory that can be copied, stored and shared
/// between processes. Lengths are integers in units of 0.1 mm ("tenth_mm"), so that every computer
/// decides the same. Layer element = iy * nx + ix. Cell (ix, iy) covers [origin + i * resolution,
/// origin + (i + 1) * resolution) in odom.
struct MapSnapshot {
    static constexpr std::uint32_t kMagic = 0x54465253;  // "SRFT"
    static constexpr std::uint32_t kLayout = 5;
    static constexpr int kMaxSide = 256;
    static constexpr int kMaxCells = kMaxSide * kMaxSide;
    static constexpr int kBlockCells = 1024;  ///< consecutive cells with a common checksum
    static constexpr int kBlocks = kMaxCells / kBlockCells;
    static constexpr int kMaxEdges = 128;
    static constexpr std::int32_t kUnknownHeight = std::numeric_limits<std::int32_t>::min();
    static constexpr std::uint16_t kNoCeiling = 0xffff;
    static constexpr std::uint32_t kUnknownTilt = 0xffffffff;
    static constexpr std::uint16_t kNoComponent = 0;

    std::uint32_t magic = kMagic;
    std::uint32_t layout = kLayout;
    std::uint64_t version = 0;  ///< grows with every published map
    std::uint64_t config_hash = 0;
    std::int64_t frame_time_ns = 0;  ///< time of the last integrated depth frame
    std::int64_t pose_time_ns = 0;   ///< time of the last pose
    std::int32_t resolution_tenth_mm = 0;
    std::int32_t nx = 0;
    std::int32_t ny = 0;
    std::int32_t edge_count = 0;
    std::int64_t origin_x_tenth_mm = 0;
    std::int64_t origin_y_tenth_mm = 0;
    /// Position of base_link in odom.
    std::int64_t body_x_tenth_mm = 0;
    std::int64_t body_y_tenth_mm = 0;
    std::int64_t body_z_tenth_mm = 0;
    double body_cos_yaw = 1.0;
    double body_sin_yaw = 0.0;
    GravitySource gravity_source = GravitySource::assumed;
    SnapshotHealth health = SnapshotHealth::lost;
    CameraState camera = CameraState::unknown;
    std::array<std::uint8_t, 1> padding{};
    /// One sigma, about any horizontal axis, of the angle between odom's z axis and the vertical
    /// [1e-6 rad], rounded up. kUnknownTilt makes the gate answer ERROR.
    std::uint32_t tilt_sigma_urad = kUnknownTilt;

    /// Measured cell: ground height. Unknown cell: height of rays over it; its ground lies lower.
    /// kUnknownHeight = no information.
    std::array<std::int32_t, kMaxCells> height_tenth_mm{};
    std::array<std::uint16_t, kMaxCells> sigma_tenth_mm{};  ///< one sigma of the height, saturated
    std::array<std::uint16_t, kMaxCells>
        drift_tenth_mm{};  ///< 1-sigma horizontal drift since the cell was last seen
    std::array<std::uint16_t, kMaxCells>
        clearance_tenth_mm{};                          ///< free height above; kNoCeiling = open
    std::array<std::uint16_t, kMaxCells> component{};  ///< label of the connected surface, 0 = none
    std::array<std::uint8_t, kMaxCells>
        drop_evidence{};  ///< 0 to 255; 255 = a drop is proven beside this cell
    std::array<EvidenceSource, kMaxCells> source{};
    /// Edges, nearest to the body first. The cells are valid without the edges: a drop that was not
    /// detected as a line is still a drop in the cells.
    std::array<SnapshotEdge, kMaxEdges> edges{};

    /// One checksum for all layers of a block of cells, so that readers of a part of the map check
    /// only this part.
    std::array<std::uint64_t, kBlocks> block_checksum{};
    std::uint64_t checksum = 0;  ///< covers the header, the edges and the checksums of the blocks

    /// True if the ground height of the cell (element of the layers) was measured.
    [[nodiscard]] bool is_measured(std::size_t cell) const noexcept {
        return source[cell] == EvidenceSource::measured && height_tenth_mm[cell] != kUnknownHeight;
    }
};
static_assert(std::is_trivially_copyable_v<MapSnapshot>);

/// Sets all checksums: FNV-1a (Fowler, Noll, Vo) in 64-bit words. Layers use four lanes, combined
/// at the end. Each step is a bijection of its lane, so every single changed word is detected. The
/// 0.9 MB of a whole map take some tens of microseconds.
void seal(MapSnapshot& snapshot) noexcept;
/// True if magic, layout, size, finite pose and the checksum of header, edges and blocks are
/// correct. Does not read the cells.
[[nodiscard]] bool is_sealed(const MapSnapshot& snapshot) noexcept;
/// True if the cells of these rows, limited to the map, are unchanged. Requires is_sealed().
[[nodiscard]] bool are_rows_intact(const MapSnapshot& snapshot,
                                   std::int64_t first_row,
                                   std::int64_t last_row) noexcept;
/// True if the snapshot is sealed and all cells are unchanged: then it may be used.
[[nodiscard]] bool is_intact(const MapSnapshot& snapshot) noexcept;

}  // namespace surefoot::grid
