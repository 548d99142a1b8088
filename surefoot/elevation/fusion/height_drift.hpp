// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/elevation/fusion/height_residuals.hpp"

namespace surefoot::elevation {

/// Conditions for a correction of the map by the body's height drift. All are an ASSUMPTION.
struct HeightDriftConfig {
    bool enabled = false;
    /// A cell is old if at least this many uncertain motions lie between its alignment and the
    /// frame, and if their error reaches `min_drift_m`. Younger cells show the frame's own error.
    int min_motions = 10;
    double min_drift_m = 0.003;        ///< smallest height error of these motions (1 sigma)
    double level_m = 0.03;             ///< largest height difference to the map two cells away
    int kept_motions = 15;             ///< residuals of old cells are kept for this many motions
    int min_cells = 40;                ///< fewest checked cells (the older half of the old cells)
    int min_tiles = 8;                 ///< fewest tiles of 8 x 8 cells; matcher errors span a tile
    double min_spread_m = 0.3;         ///< smallest spread of the tiles, longer axis (1 sigma)
    double agreeing_share = 0.8;       ///< smallest share of these cells with the same offset
    double significance_sigmas = 3.0;  ///< smallest significant offset [sigma]
    double motion_sigmas = 3.0;        ///< a larger offset is not a drift [sigma of the motion]
    double depth_scale_sigma = 0.002;  ///< relative depth error of one frame (1 sigma)

    void describe(ConfigVisitor& visitor);
};

/// Reason why the map was corrected or not corrected, in the order of the checks.
enum class HeightDriftReason : std::uint8_t {
    off,
    no_old_ground,     ///< the frame shows no ground that may have drifted
    few_cells,         ///< too few cells or tiles, or too close to tell offset and tilt apart
    no_common_offset,  ///< the cells disagree, because the ground changed
    not_significant,   ///< the frame's own error explains the offset, or it is below 0.1 mm
    tilted,            ///< the offsets slope, because the camera has a tilt error
    frame_is_off,      ///< recently aligned ground shows an offset too: the frame is wrong
    beyond_motion,     ///< the offset exceeds the motion's drift: other ground, or a lost pose
    moved,
};
[[nodiscard]] std::string_view to_string(HeightDriftReason reason) noexcept;

/// Result of the height drift check of one frame.
struct HeightDriftReport {
    double offset_m = 0.0;   ///< height in the frame minus height in the map
    double sigma_m = 0.0;    ///< sigma of the offset, with the common errors of the frame
    std::int64_t cells = 0;  ///< number of cells that support the offset
    std::int64_t moved_cells = 0;
    HeightDriftReason reason = HeightDriftReason::off;
};

/// Height drift of the body relative to the remembered map. odom drifts slowly in height, so
/// remembered cells keep the height that odom had when they were observed. A frame that
/// observes old ground again shows the drift: all its heights differ from the map's by the same
/// offset.
///
/// The offset is the median of measurement - map over old, level cells, weighted by the inverse
/// variance without the motion's part. It uses the older half of these cells (by alignment). It
/// holds for all cells aligned no later than the last cell of that half: they drifted together, and
/// their earlier drift has mean zero. It does not hold for younger cells.
///
/// Sigma covers the errors that all heights of a frame share. These are `systematic_sigma_m` (of
/// frame and map), tilt times distance, and depth scale times camera height. Sigma also covers the
/// ground slope times the horizontal drift, and the motion since the residuals were taken. The
/// random part comes from the scatter of tiles; cells of a tile share the errors of the matcher.
class HeightDrift {
  public:
    struct Frame {
        const grid::GridGeometry& geometry;
        double camera_z_m = 0.0;  ///< camera height in odom
        double systematic_sigma_m = 0.0;
        double tilt_sigma_rad = 0.0;
        std::uint32_t motions = 0;  ///< number of uncertain motions so far
    };
    struct Verdict {
        HeightDriftReport report;
        /// Cells aligned at this step or earlier may be corrected, if the report allows it.
        std::uint32_t last_step = 0;
    };

    explicit HeightDrift(const HeightDriftConfig& config) : config_(config) {}
    /// Allocates the memory for a map of this size; nothing allocates afterwards.
    void reserve(const grid::GridGeometry& geometry);
    /// Computes the offset and decides about the correction. `old` and `recent`: see
    /// HeightResiduals. Runs in one thread, so every executor of the map gives the same bytes.
    [[nodiscard]] Verdict judge(std::span<const HeightResidual> old,
                                std::span<const HeightResidual> recent,
                                const Frame& frame);

    /// True if a motion of variance `motion_var_m2` may have moved a cell by `offset_m`.
    [[nodiscard]] bool allows(double offset_m, double motion_var_m2) const noexcept;

  private:
    /// Sums over the agreeing cells of a tile.
    struct Tile {
        int cells = 0;
        double sum_m = 0.0;
        Eigen::Vector2d sum_from_m = Eigen::Vector2d::Zero();
    };
    /// Tiles as points (x, y, offset); x and y count from the point below the camera.
    struct Field {
        int tiles = 0;
        Eigen::Vector2d mean_m = Eigen::Vector2d::Zero();
        double offset_m = 0.0;
        double scatter_m2 = 0.0;  ///< scatter of the offsets
        double spread_m = 0.0;
        Eigen::Vector2d slope = Eigen::Vector2d::Zero();
        double slope_chi2 = 0.0;  ///< chi^2 of the test for "no slope", 2 degrees of freedom
    };

    /// Evidence of the older half of the old cells for a common offset.
    struct Evidence {
        std::int64_t asked = 0;
        std::int64_t agreeing = 0;  ///< cells with the offset; the next fields are their means
        Eigen::Vector2d ground_slope = Eigen::Vector2d::Zero();
        double drift_m = 0.0;  ///< horizontal drift (1 sigma)
        double motion_var_m2 = 0.0;
        double later_var_m2 = 0.0;  ///< height variance of the motion since the residuals
        double height_m = 0.0;
        Field field;
    };

    [[nodiscard]] std::uint32_t middle_step(std::span<const HeightResidual> old);
    [[nodiscard]] double median_m(std::span<const HeightResidual> residuals,
                                  std::uint32_t last_step);
    void add_agreeing(const HeightResidual& residual, const grid::GridGeometry& geometry);
    [[nodiscard]] Field field_of_tiles() const;
    [[nodiscard]] Evidence collect(std::span<const HeightResidual> residuals,
                                   double offset_m,
                                   std::uint32_t last_step,
                                   const Frame& frame);
    /// Variance of the offset, including the errors that all heights of the frame share.
    [[nodiscard]] double variance_m2(const Evidence& evidence, const Frame& frame) const;
    [[nodiscard]] HeightDriftReason reason_of(const HeightDriftReport& report,
                                              const Evidence& evidence,
                                              std::span<const HeightResidual> recent,
                                              const Frame& frame);
    /// Returns the offset of the frame on recently aligned ground, continued as a plane to `at_m`
    /// (from the point below the camera). Returns 0 if the frame shows too little of that ground.
    [[nodiscard]] double frame_error_m(std::span<const HeightResidual> recent,
                                       const Eigen::Vector2d& at_m,
                                       const Frame& frame);

    HeightDriftConfig config_;
    std::vector<std::uint32_t> steps_;
    std::vector<double> weights_;  ///< histogram of offsets
    std::vector<Tile> tiles_;
};

}  // namespace surefoot::elevation
