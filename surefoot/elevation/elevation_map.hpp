// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/camera/depth_image.hpp"
#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/elevation/cell_reduction.hpp"
#include "surefoot/elevation/cloud_points.hpp"
#include "surefoot/elevation/elevation_config.hpp"
#include "surefoot/elevation/motion_update.hpp"
#include "surefoot/elevation/prefilter.hpp"
#include "surefoot/elevation/viewpoint_history.hpp"
#include "surefoot/grid/moving_window.hpp"

namespace surefoot::elevation {

/// What the map knows, cell by cell (column = ix along +x, row = iy along +y of `geometry()`). A
/// cell is unknown when its height is NaN; then count is 0 and the other layers say nothing.
struct ElevationLayers {
    grid::Layer height_m;        ///< highest surface seen, in odom
    grid::Layer height_var_m2;   ///< of the height as seen from the present body
    Image<std::uint32_t> count;  ///< measurements fused since the height was first set
    Image<std::int64_t>
        seen_ns;  ///< last time that a measurement agreed with the height; 0 = never
    grid::Layer horizontal_drift_m;  ///< 1 sigma of the body's horizontal drift since then; NaN
    grid::Layer highest_m;           ///< robust extremes of all points in the cell since the height
    grid::Layer lowest_m;            ///<   was first set: a wall or an edge spans more than a floor
    grid::Layer clearance_m;  ///< from the height to the lowest thing seen above it; NaN = none
};

/// Robot-centric elevation map in odom (Fankhauser 2014): one height with its variance per cell, in
/// a window that moves with the body. Call `follow` for every motion, then `add` for a frame that
/// has depth. Variances are relative to the present body: what the body's drift blurs, `follow`
/// inflates.
///
/// Not thread-safe. After the first frames of a size neither call allocates. `config.problem()`
/// must be empty.
class ElevationMap {
  public:
    explicit ElevationMap(const ElevationConfig& config);

    /// Moves the window with the body and lets every remembered cell pay for the motion.
    /// `relative_covariance`: of the motion since the last call, see `MotionEstimate`. If it is not
    /// finite nothing is known about where the cells are now: the map is cleared. A pose that is
    /// not finite clears too.
    void follow(const Pose& T_odom_body, const Matrix6& relative_covariance);

    /// Fuses a depth image taken at the pose last followed; every cell takes one measurement at
    /// most.
    FusionCounts add(const camera::RectifiedRig& rig,
                     const Pose& T_odom_body,
                     const camera::DepthImage& depth,
                     std::int64_t time_ns);
    /// Fuses a cloud in the same way. Points that are not finite are not counted.
    FusionCounts add_points(std::span<const MeasuredPoint> points,
                            const Pose& T_body_sensor,
                            const Pose& T_odom_body,
                            std::int64_t time_ns);
    /// Forgets every cell; the window stays.
    void clear();

    [[nodiscard]] const grid::GridGeometry& geometry() const noexcept { return window_.geometry(); }
    [[nodiscard]] const ElevationLayers& layers() const noexcept { return layers_; }
    [[nodiscard]] const ElevationConfig& config() const noexcept { return config_; }
    [[nodiscard]] std::int64_t known_cells() const noexcept;

  private:
    void shift(grid::Shift shift);
    void inflate(const MotionNoise& noise, const Eigen::Vector3d& body_m);
    FusionCounts fuse_points(const Pose& T_odom_body, std::int64_t time_ns, FusionCounts counts);
    void measure(std::size_t cell,
                 const CellMeasurement& measured,
                 std::int64_t time_ns,
                 FusionCounts& counts);
    [[nodiscard]] bool is_same_scan(std::int64_t since_seen_ns) const;
    void start(std::size_t cell, const CellMeasurement& measured, std::int64_t time_ns);
    void agree(std::size_t cell,
               const Height& fused,
               const CellMeasurement& measured,
               std::int64_t time_ns);
    void see_above(std::size_t cell, float z_m, int trust);
    void see_no_more_above(std::size_t cell);
    void set_clearance(std::size_t cell);

    ElevationConfig config_;
    grid::MovingWindow window_;
    ElevationLayers layers_;
    void repeat(std::size_t cell, const CellMeasurement& measured);

    /// Variance after the last fusion that brought new information; repeated views of the same
    /// errors never lower a cell's variance below it.
    grid::Layer settled_var_m2_;
    Image<ViewpointHistory::Id> viewpoint_;  ///< of that fusion
    /// Lowest surface seen above the height, and how far it is believed: see elevation_map.cpp.
    grid::Layer overhead_m_;
    Image<std::uint8_t> overhead_trust_;
    ViewpointHistory views_;
    ViewpointHistory::Id present_view_ = ViewpointHistory::kNever;
    CloudFilter filter_;
    CellGroups groups_;
    std::vector<GridPoint> points_;
};

}  // namespace surefoot::elevation
