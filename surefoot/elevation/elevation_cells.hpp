// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "surefoot/core/report.hpp"
#include "surefoot/elevation/cell_reduction.hpp"
#include "surefoot/elevation/elevation_config.hpp"
#include "surefoot/elevation/elevation_layers.hpp"
#include "surefoot/elevation/viewpoint_history.hpp"
#include "surefoot/grid/map_region.hpp"

namespace surefoot::elevation {

/// What the looks of one frame share.
struct Look {
    const ViewpointHistory& views;
    ViewpointHistory::Id view = ViewpointHistory::kNever;  ///< where it was taken from
    std::int64_t time_ns = 0;
};

/// What one frame says about one cell.
struct Seen {
    CellMeasurement measured;
    float density_ratio = 0.0F;  ///< see ElevationLayers; NaN = not known
};

/// The cells of an elevation map and what a look does to one of them. Cells do not know of each
/// other: different ones may be updated side by side. A cell is named by iy * nx + ix.
class ElevationCells {
  public:
    ElevationCells(const ElevationConfig& config, int nx, int ny);

    [[nodiscard]] const ElevationLayers& layers() const noexcept { return layers_; }
    void clear();
    void shift(grid::Shift shift);

    /// Remembered cells of a row pay for the body's motion, see `MotionNoise`: writes height
    /// variance and drift.
    struct Memory {
        const float* height_m;
        float* height_var_m2;
        float* horizontal_drift_m;
    };
    [[nodiscard]] Memory memory_of_row(int iy) noexcept;

    /// Fuses a measurement.
    void update(std::size_t cell, const Seen& seen, const Look& look, FusionCounts& counts);
    /// A line of sight passes at `line_z_m` over the cell, or the look at it ended there: often
    /// enough below the height, without a look that agrees, and it is gone. Returns whether it is.
    /// For cells that no look agreed with in this frame.
    bool see_through(std::size_t cell, float line_z_m);
    /// The same over an unknown cell: whatever is there is lower.
    void see_over(std::size_t cell, float line_z_m);
    /// The cell is unknown; what its height was may still hang over it.
    void forget(std::size_t cell);

    /// An unknown cell takes what cell `from` of a region knew: as never seen in this run, so that
    /// the first look at it is new information.
    void recall(std::size_t cell, const grid::MapRegion& region, std::size_t from);

  private:
    template <typename F>
    void for_each_layer(const F& f);

    [[nodiscard]] bool is_same_scan(std::int64_t since_seen_ns) const;
    void start(std::size_t cell, const Seen& seen, const Look& look);
    void agree(std::size_t cell, const Height& fused, const Seen& seen, const Look& look);
    void repeat(std::size_t cell, const CellMeasurement& measured, const Look& look);
    void set_confidence(std::size_t cell, float confidence);
    void remember_density(std::size_t cell, float ratio);
    void see_above(std::size_t cell, float z_m, int trust);
    void see_no_more_above(std::size_t cell);
    void set_clearance(std::size_t cell);

    ElevationConfig config_;
    ElevationLayers layers_;
    /// Variance after the last fusion that brought new information; repeated views of the same
    /// errors never lower a cell's variance below it.
    ElevationLayers::Layer settled_var_m2_;
    grid::SlidingLayer<ViewpointHistory::Id> viewpoint_;  ///< of that fusion
    /// Lowest surface seen above the height, and how far it is believed.
    ElevationLayers::Layer overhead_m_;
    grid::SlidingLayer<std::uint8_t> overhead_trust_;
    /// A surface seen in a share s of the looks is missed in n of them by chance with (1 - s)^n: so
    /// that 1/s times as many frames are asked of it before it counts as gone.
    grid::SlidingLayer<std::uint8_t> steady_;         ///< s at the last look that agreed, in 1/16
    grid::SlidingLayer<std::uint16_t> seen_through_;  ///< its sum over frames since then
};

}  // namespace surefoot::elevation
