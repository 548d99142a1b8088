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

/// Data that all observations of one frame share.
struct FrameObservation {
    const ViewpointHistory& views;
    ViewpointHistory::Id view = ViewpointHistory::kNever;  ///< viewpoint of the frame
    std::int64_t time_ns = 0;
};

/// Observation of one cell by one frame.
struct CellObservation {
    CellMeasurement measured;
    float density_ratio = 0.0F;  ///< see ElevationLayers::density_ratio; NaN = unknown
    /// Lower end of the observed surface. A face seen from the side reaches down to its lowest
    /// points; every other surface begins at its height.
    float bottom_m = 0.0F;
    /// True if the cell was matched in a larger image than the others of the frame. From a known
    /// viewpoint such a match replaces coarse ones if its variance is smaller.
    bool is_fine = false;
};

/// The cells of an elevation map, and their update by observations. Cells are independent: threads
/// may update different cells at the same time. A cell has the index iy * nx + ix.
class ElevationCells {
  public:
    ElevationCells(const ElevationConfig& config, int nx, int ny);

    [[nodiscard]] const ElevationLayers& layers() const noexcept { return layers_; }
    void clear();
    void shift(grid::Shift shift);

    /// Remembered cells of a row, into which `MotionNoise` writes: the body's motion increases
    /// their height variance and drift.
    struct Memory {
        const float* height_m;
        float* height_var_m2;
        float* horizontal_drift_m;
    };
    [[nodiscard]] Memory memory_of_row(int iy) noexcept;
    /// Call once for every uncertain motion (with a covariance that is not zero).
    void count_motion() noexcept { ++motions_; }
    [[nodiscard]] std::uint32_t motions() const noexcept { return motions_; }
    [[nodiscard]] CellAlignment alignment() noexcept {
        return {aligned_var_m2_.data(), aligned_step_.data(), is_asked_.data()};
    }
    /// Raises a known cell, and all that was observed in it, by `offset_m`, and aligns the cell
    /// with the present body. `var_m2`: variance of the offset.
    void lift(std::size_t cell, double offset_m, double var_m2);

    /// Fuses an observation. Its height and its variance must be finite.
    void update(std::size_t cell,
                const CellObservation& seen,
                const FrameObservation& look,
                FusionCounts& counts);
    /// True if the line is below the cell's height by more than the margin of `visibility`.
    [[nodiscard]] bool is_above(std::size_t cell, float line_z_m) const;
    /// Counts one frame whose line of sight passes through the surface of the cell. Returns true
    /// after enough such frames without an agreeing observation: the surface is gone. Call only for
    /// cells without an agreeing observation in this frame.
    bool see_through(std::size_t cell);
    /// Notes a line of sight over an unknown cell: the ground there is lower.
    void see_over(std::size_t cell, float line_z_m);
    /// Lower end of the remembered surface of a cell, see `CellObservation`.
    [[nodiscard]] float bottom_m(std::size_t cell) const noexcept { return bottom_m_.data()[cell]; }
    /// Height of the lowest object observed above a cell, or of the lower end of a surface that was
    /// removed from the cell; NaN if there is neither.
    [[nodiscard]] float overhead_m(std::size_t cell) const noexcept {
        return overhead_m_.data()[cell];
    }
    /// Writes the surface of each cell: its height, or the lowest observed top of an object that
    /// stands on known ground (a person) and that two frames observed. Leaves out objects that hang
    /// over the ground (a table top). NaN = unknown cell. `out_m` takes the size of the layers.
    void surface(grid::Layer& out_m) const;
    /// Notes that a line of sight passed through the lowest object above a cell.
    void see_no_more_above(std::size_t cell);
    /// Makes the cell unknown. Its former surface may still count as an overhead object.
    void forget(std::size_t cell);

    /// Copies cell `from` of a region into an unknown cell. The cell counts as not observed in this
    /// run, so its first observation is new information.
    void recall(std::size_t cell, const grid::MapRegion& region, std::size_t from);

  private:
    /// Calls f(layer, value of unknown cells) for each layer that is also read in unknown cells.
    template <typename F>
    void for_each_layer(const F& f);
    /// Calls f(layer, value) for each layer that is first written when a cell becomes known.
    template <typename F>
    void for_each_layer_of_known(const F& f);

    [[nodiscard]] bool is_same_scan(std::int64_t since_seen_ns) const;
    void start(std::size_t cell, const CellObservation& seen, const FrameObservation& look);
    void agree(std::size_t cell,
               const Height& fused,
               const CellObservation& seen,
               const FrameObservation& look);
    void repeat(std::size_t cell, const CellObservation& seen, const FrameObservation& look);
    void set_confidence(std::size_t cell, float confidence);
    void remember_density(std::size_t cell, float ratio);
    /// Returns the trust that the present height gets when it becomes an overhead object.
    [[nodiscard]] int trust_in(std::size_t cell) const;
    void see_above(std::size_t cell, float z_m, int trust, bool hangs);
    [[nodiscard]] bool is_sure_of_overhead(std::size_t cell) const;
    void forget_overhead(std::size_t cell);
    /// Forgets the overhead object if it does not hang over the height of the cell.
    void forget_overhead_near(std::size_t cell);
    void set_clearance(std::size_t cell);
    void align(std::size_t cell);
    [[nodiscard]] bool aligns() const noexcept { return config_.height_drift.enabled; }

    ElevationConfig config_;
    ElevationLayers layers_;
    /// Variance after the last fusion that brought new information; repeated views of the same
    /// errors never lower a cell's variance below this value.
    ElevationLayers::Layer settled_var_m2_;
    // See CellAlignment; empty unless height drift is corrected.
    ElevationLayers::Layer aligned_var_m2_;
    grid::SlidingLayer<std::uint32_t> aligned_step_;
    grid::SlidingLayer<std::uint8_t> is_asked_;
    std::uint32_t motions_ = 0;
    /// Last viewpoint with new information; elevation_cells.cpp marks fine observations.
    grid::SlidingLayer<ViewpointHistory::Id> viewpoint_;
    /// Lowest surface observed above the height, and the trust in it.
    ElevationLayers::Layer overhead_m_;
    grid::SlidingLayer<std::uint8_t> overhead_trust_;
    grid::SlidingLayer<std::uint8_t> overhead_hangs_;  ///< 0: the object stands on the ground
    /// Known cell: lower end of its surface. Unknown cell: lowest line of sight over the cell.
    ElevationLayers::Layer bottom_m_;
    /// If a share s of the observations shows a surface, the probability of n misses in a row is at
    /// most exp(-s n). So it takes 1/s times as many frames as with s = 1 to remove the surface.
    grid::SlidingLayer<std::uint8_t> steady_;         ///< share s at the last agreement [1/16]
    grid::SlidingLayer<std::uint16_t> seen_through_;  ///< sum of `steady_` in contradicting frames
};

}  // namespace surefoot::elevation
