// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/depth_image.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/elevation/elevation_cells.hpp"
#include "surefoot/elevation/elevation_config.hpp"
#include "surefoot/elevation/fusion/cell_groups.hpp"
#include "surefoot/elevation/fusion/cell_reduction.hpp"
#include "surefoot/elevation/motion/motion_update.hpp"
#include "surefoot/elevation/sampling/cloud_points.hpp"
#include "surefoot/elevation/sampling/depth_samples.hpp"
#include "surefoot/elevation/sampling/expected_points.hpp"
#include "surefoot/elevation/sampling/prefilter.hpp"
#include "surefoot/elevation/visibility/viewpoint_history.hpp"
#include "surefoot/elevation/visibility/visibility_cleanup.hpp"
#include "surefoot/grid/map_region.hpp"
#include "surefoot/grid/moving_window.hpp"

namespace surefoot::elevation {

/// A depth image and the camera that it belongs to. Both must outlive the call that receives the
/// view.
struct DepthView {
    const camera::RectifiedRig& rig;
    const DepthImage& depth;
};

/// A cell takes the measurement of a finer view only if this view has at least this share of the
/// point density of the coarser view. Otherwise the finer matches failed there. ASSUMPTION.
inline constexpr float kLeastShareOfCoarser = 0.5F;
inline constexpr std::size_t kMostViews = 2;  ///< largest number of views of one frame

/// Robot-centric elevation map in odom (Fankhauser 2014): one height with its variance per cell, in
/// a window that moves with the body. Call `follow` for every motion, then `add` for a frame that
/// has depth. Variances are relative to the present body: `follow` increases them by the drift of
/// the body.
///
/// Not thread-safe. After the first frames of one size, neither call allocates. `config.problem()`
/// must be empty.
class ElevationMap {
  public:
    explicit ElevationMap(const ElevationConfig& config);

    /// Moves the window with the body and adds the uncertainty of the motion to every remembered
    /// cell. `relative_covariance` describes the motion since the last call, see `MotionEstimate`.
    /// Clears the map if the covariance is not bounded (`MotionNoise::is_bounded`) or the pose is
    /// not finite, because the position of the cells is then unknown.
    void follow(const Pose& T_odom_body, const Matrix6& relative_covariance);

    /// Fuses a depth image taken at the pose of the last `follow`. Each cell takes at most one
    /// measurement.
    FusionCounts add(const camera::RectifiedRig& rig,
                     const Pose& T_odom_body,
                     const DepthImage& depth,
                     std::int64_t time_ns,
                     Executor& executor = serial());
    /// Fuses one or two depth images of one instant: if there are two, the first is the part in
    /// which a finer image was matched, and the last is the whole image. Each cell takes one
    /// measurement: that of the finer view if it is better (see `is_better`), else that of the
    /// whole image.
    FusionCounts add(std::span<const DepthView> views,
                     const Pose& T_odom_body,
                     std::int64_t time_ns,
                     Executor& executor = serial());
    /// Fuses a cloud, as `add` fuses an image. Skips invalid points (see `points_from_cloud`).
    FusionCounts add_points(std::span<const MeasuredPoint> points,
                            const Pose& T_body_sensor,
                            const Pose& T_odom_body,
                            std::int64_t time_ns,
                            Executor& executor = serial());
    /// Fills only unknown cells, from an earlier map in this odom. Returns the number of filled
    /// cells.
    ///
    /// Every cell gets the errors of the placement. `placement_covariance` belongs to the body at
    /// `T_odom_body` in the region's frame (right perturbation, see pose.hpp). It blurs every cell
    /// like a motion does. `min_height_var_m2` and the horizontal variance of rounding to a cell
    /// (resolution^2 / 12 per axis) are always added. `seen_ns` of the cells becomes 0, because
    /// clocks differ. Allocates; do not call it for every frame.
    [[nodiscard]] Result<std::int64_t> insert(const grid::MapRegion& region,
                                              const Pose& T_odom_body,
                                              const Matrix6& placement_covariance);
    /// Forgets every cell; the window stays.
    void clear();

    [[nodiscard]] const grid::GridGeometry& geometry() const noexcept { return window_.geometry(); }
    [[nodiscard]] const ElevationLayers& layers() const noexcept { return cells_.layers(); }
    /// Writes the surface of each cell in odom, for display and rating: `height_m`, or the top of
    /// an object that stands on known ground and that two frames observed. `height_m` is still the
    /// ground until enough frames contradict it; `clearance_m` is the distance from the ground to
    /// this top. NaN = unknown. Does not allocate if `out_m` has the size of the map.
    void surface(grid::Layer& out_m) const { cells_.surface(out_m); }
    [[nodiscard]] const ElevationConfig& config() const noexcept { return config_; }
    [[nodiscard]] std::int64_t known_cells() const noexcept;
    /// Result of the height drift check of the last frame.
    [[nodiscard]] const HeightDriftReport& height_drift() const noexcept { return height_drift_; }

  private:
    void inflate(const MotionNoise& noise, const Eigen::Vector3d& body_m);
    /// Samples of one view, grouped by cell.
    struct Samples {
        DepthSampler sampler;
        CellSamples of_image;
        CellGroups groups;
        std::optional<ExpectedPoints> expected;  ///< empty for clouds
        ReductionConfig reduction;               ///< with the point counts of this view
        /// Number of pixels of a surface in this view per pixel in the last (coarsest) view.
        float pixel_ratio = 1.0F;
        /// One row per block; used if a frame has more than one view.
        std::vector<CellMeasurement> measured;
    };

    void sample_points(Samples& samples, FusionCounts& counts);
    void fuse_samples(const Pose& T_odom_body,
                      const Eigen::Vector3d& camera_m,
                      std::int64_t time_ns,
                      Executor& executor,
                      FusionCounts& counts);
    /// Corrects the height of old cells by the drift, if the frame shows the drift.
    void align_heights(const Pose& T_odom_body,
                       const Eigen::Vector3d& camera_m,
                       Executor& executor);
    void reduce_block(int block);
    /// Measures the cells of a row.
    void reduce_row(int iy);
    /// True if the cell should take the measurement of the finer view. False if the coarser view
    /// measures a higher surface, or one that reaches out of the finer view, or if the finer view
    /// has too few points.
    [[nodiscard]] bool is_better(const Samples& fine,
                                 const CellMeasurement& finer,
                                 const Samples& coarse,
                                 const CellMeasurement& coarser,
                                 int ix,
                                 int iy) const;
    /// Number of points in a cell, divided by that of level ground; NaN = unknown.
    [[nodiscard]] float density_ratio(const Samples& samples, int ix, int iy, float z_m) const;
    /// True if the cell reaches beyond the image and has too few points (see `border_share`).
    [[nodiscard]] bool reaches_out(const Samples& samples,
                                   int ix,
                                   int iy,
                                   const CellMeasurement& measured) const;
    [[nodiscard]] std::uint32_t points_of(const Samples& samples, int ix, int iy) const;
    /// First element of a row in `measured_` and `view_`. Rows of a block share it unless heights
    /// are aligned.
    [[nodiscard]] std::ptrdiff_t row_start(int iy) const;
    void fuse_block(int block, const FrameObservation& look);

    ElevationConfig config_;
    grid::MovingWindow window_;
    ViewpointHistory views_;
    ElevationCells cells_;
    CloudFilter filter_;
    std::vector<GridPoint> points_;
    std::array<Samples, kMostViews> samples_;  ///< in the order of the views
    std::size_t view_count_ = 0;               ///< number of views of this frame
    /// One row of cells per block, or all cells if heights are aligned.
    std::vector<CellMeasurement> measured_;
    std::vector<std::uint8_t> view_;  ///< view of each element of `measured_`
    VisibilityCleanup sight_;
    float lowest_z_m_ = 0.0F;                 ///< lower height limit of this frame, in odom
    std::vector<FusionCounts> block_counts_;  ///< one count per block
    HeightResiduals residuals_;
    HeightDrift drift_;
    HeightDriftReport height_drift_;
};

}  // namespace surefoot::elevation
