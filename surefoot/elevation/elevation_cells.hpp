// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "surefoot/core/report.hpp"
#include "surefoot/elevation/elevation_config.hpp"
#include "surefoot/elevation/elevation_layers.hpp"
#include "surefoot/elevation/fusion/cell_reduction.hpp"
#include "surefoot/elevation/fusion/height_residuals.hpp"
#include "surefoot/elevation/visibility/viewpoint_history.hpp"
#include "surefoot/grid/map_region.hpp"

namespace surefoot::elevation {

/// What the looks of one frame share.
struct FrameObservation {
    const ViewpointHistory& views;
    ViewpointHistory::Id view = ViewpointHistory::kNever;  ///< where it was taken from
    std::int64_t time_ns = 0;
};

/// What one frame says about one cell.
struct CellObservation {
    CellMeasurement measured;
    float density_ratio = 0.0F;  ///< see ElevationLayers; NaN = not known
    /// Where what has the height begins: a face that is seen from the side reaches down to its
    /// lowest points, anything else begins at the height.
    float bottom_m = 0.0F;
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
    /// Call once for every uncertain motion.
    void count_motion() noexcept { ++motions_; }
    [[nodiscard]] std::uint32_t motions() const noexcept { return motions_; }
    [[nodiscard]] CellAlignment alignment() noexcept {
        return {aligned_var_m2_.data(), aligned_step_.data(), is_asked_.data()};
    }
    /// A known cell, and all that was seen in it, stands `offset_m` higher than it was thought to;
    /// it is aligned with the present body. `var_m2`: of the offset.
    void lift(std::size_t cell, double offset_m, double var_m2);

    /// Fuses a measurement; its height and variance are finite.
    void update(std::size_t cell,
                const CellObservation& seen,
                const FrameObservation& look,
                FusionCounts& counts);
    /// The height of the cell is clearly above a line of sight over it.
    [[nodiscard]] bool is_above(std::size_t cell, float line_z_m) const;
    /// A line of sight passes through the surface of the cell: often enough, without a look that
    /// agrees, and it is gone. Returns whether it is. For cells that no look agreed with in this
    /// frame.
    bool see_through(std::size_t cell);
    /// The same over an unknown cell: whatever is there is lower.
    void see_over(std::size_t cell, float line_z_m);
    /// Where the remembered surface of a cell begins, see `Seen`.
    [[nodiscard]] float bottom_m(std::size_t cell) const noexcept { return bottom_m_.data()[cell]; }
    /// The lowest thing that was seen above the height of a cell, or where a surface was that is
    /// gone; NaN if there is none.
    [[nodiscard]] float overhead_m(std::size_t cell) const noexcept {
        return overhead_m_.data()[cell];
    }
    /// The highest surface of each cell as a person sees it: the height, or the lowest top that was
    /// seen of a thing that stands on known ground, in two frames (somebody stepped in). NaN =
    /// unknown cell. `out_m` gets the size of the layers.
    void surface(grid::Layer& out_m) const;
    /// A line of sight passed through the lowest thing above a cell.
    void see_no_more_above(std::size_t cell);
    /// The cell is unknown; what its height was may still hang over it.
    void forget(std::size_t cell);

    /// An unknown cell takes what cell `from` of a region knew: as never seen in this run, so that
    /// the first look at it is new information.
    void recall(std::size_t cell, const grid::MapRegion& region, std::size_t from);

  private:
    /// Calls f(layer, value of unknown cells) for those that are read in unknown cells too ...
    template <typename F>
    void for_each_layer(const F& f);
    /// ... and for those that are written whenever a cell becomes known, and not read before.
    template <typename F>
    void for_each_layer_of_known(const F& f);

    [[nodiscard]] bool is_same_scan(std::int64_t since_seen_ns) const;
    void start(std::size_t cell, const CellObservation& seen, const FrameObservation& look);
    void agree(std::size_t cell,
               const Height& fused,
               const CellObservation& seen,
               const FrameObservation& look);
    void repeat(std::size_t cell, const CellMeasurement& measured, const FrameObservation& look);
    void set_confidence(std::size_t cell, float confidence);
    void remember_density(std::size_t cell, float ratio);
    /// In the height of a cell, should it turn out to hang over ground.
    [[nodiscard]] int trust_in(std::size_t cell) const;
    void see_above(std::size_t cell, float z_m, int trust, bool hangs);
    [[nodiscard]] bool is_sure_of_overhead(std::size_t cell) const;
    void forget_overhead(std::size_t cell);
    /// If it does not hang over the height of the cell, but is that surface, or below it.
    void forget_overhead_near(std::size_t cell);
    void set_clearance(std::size_t cell);
    void align(std::size_t cell);
    [[nodiscard]] bool aligns() const noexcept { return config_.height_drift.enabled; }

    ElevationConfig config_;
    ElevationLayers layers_;
    /// Variance after the last fusion that brought new information; repeated views of the same
    /// errors never lower a cell's variance below it.
    ElevationLayers::Layer settled_var_m2_;
    // See CellAlignment; empty unless the height drift is looked after.
    ElevationLayers::Layer aligned_var_m2_;
    grid::SlidingLayer<std::uint32_t> aligned_step_;
    grid::SlidingLayer<std::uint8_t> is_asked_;
    std::uint32_t motions_ = 0;
    grid::SlidingLayer<ViewpointHistory::Id> viewpoint_;  ///< of that fusion
    /// Lowest surface seen above the height, and how far it is believed.
    ElevationLayers::Layer overhead_m_;
    grid::SlidingLayer<std::uint8_t> overhead_trust_;
    grid::SlidingLayer<std::uint8_t> overhead_hangs_;  ///< 0: it stands on the ground
    /// Of a known cell, see `Seen`; of an unknown one the lowest line of sight over it.
    ElevationLayers::Layer bottom_m_;
    /// A surface seen in a share s of the looks is missed in n of them by chance with (1 - s)^n: so
    /// that 1/s times as many frames are asked of it before it counts as gone.
    grid::SlidingLayer<std::uint8_t> steady_;         ///< s at the last look that agreed, in 1/16
    grid::SlidingLayer<std::uint16_t> seen_through_;  ///< its sum over frames since then
};

}  // namespace surefoot::elevation
