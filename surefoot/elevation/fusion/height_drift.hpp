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

/// When the map is moved by what the body's height has drifted. ASSUMPTION, all of them.
struct HeightDriftConfig {
    bool enabled = false;
    /// Cells are old when so many uncertain motions lie between them and the frame: younger ones
    /// belong to the same look, and tell the frame's own error ...
    int min_motions = 10;
    double min_drift_m = 0.003;   ///< ... and these may have moved them by this (1 sigma)
    double level_m = 0.03;        ///< two cells beside a cell the map differs by no more
    int kept_motions = 15;        ///< residuals of old cells are kept for so many uncertain motions
    int min_cells = 40;           ///< old cells on which an offset rests, of every fourth
    int min_tiles = 8;            ///< squares of 8 x 8 cells among them: matcher errors span a tile
    double min_spread_m = 0.3;    ///< standard deviation of their places along the longer axis
    double agreeing_share = 0.8;  ///< of the old cells must have the offset within their noise
    double significance_sigmas = 3.0;  ///< an offset that stands out this far is moved by
    double motion_sigmas = 3.0;        ///< an offset beyond this many sigma of the motion is none
    double depth_scale_sigma = 0.002;  ///< of one frame: over level ground it looks like an offset

    void describe(ConfigVisitor& visitor);
};

/// Why the map was moved, or why not; in the order of the questions.
enum class HeightDriftReason : std::uint8_t {
    off,
    no_old_ground,  ///< the frame saw no ground that the motion could have moved
    few_cells,      ///< too few cells or tiles, or too close together to tell an offset from tilt
    no_common_offset,  ///< the cells disagree: ground that changed, not a drift
    not_significant,   ///< the frame's own error could be the offset; also where there is none
    tilted,            ///< the offsets lean: an error of the camera's tilt says nothing of height
    frame_is_off,      ///< ground aligned lately is off as well: the frame is, not the map
    beyond_motion,     ///< the motion cannot have drifted so far: other ground, or a lost pose
    moved,
};
[[nodiscard]] std::string_view to_string(HeightDriftReason reason) noexcept;

/// What a frame says about the height of the map's older part.
struct HeightDriftReport {
    double offset_m = 0.0;   ///< frame - map
    double sigma_m = 0.0;    ///< of the offset, with the frame's common errors
    std::int64_t cells = 0;  ///< on which it rests
    std::int64_t moved_cells = 0;
    HeightDriftReason reason = HeightDriftReason::off;
};

/// Height drift of the body relative to what the map remembers. odom drifts slowly in height, so
/// remembered cells stand at the height that odom had when they were seen. A frame that sees old
/// ground again shows by how much: all its heights are off from the map's by the same.
///
/// The offset is the median of measurement - map over old, level cells, weighted by the variances
/// of both without the motion's. It rests on the older half of these cells (by alignment), and
/// vouches for cells that were aligned no later than the last of that half: they drifted together,
/// and what they drifted before has mean zero. For younger cells it says nothing.
///
/// What a frame may do wrong to all its heights is in sigma: `systematic_sigma_m` (in the frame and
/// in the map), tilt times distance, depth scale times camera height, and where the ground slopes,
/// its slope times the horizontal drift; and what the motion may have added since the residuals
/// were seen. Its stochastic part comes from the scatter of tiles, in
/// which cells share the errors of the matcher.
class HeightDrift {
  public:
    struct Frame {
        const grid::GridGeometry& geometry;
        double camera_z_m = 0.0;  ///< in odom
        double systematic_sigma_m = 0.0;
        double tilt_sigma_rad = 0.0;
        std::uint32_t motions = 0;  ///< uncertain ones so far
    };
    struct Verdict {
        HeightDriftReport report;
        /// Cells aligned by this step may be moved if the report says so.
        std::uint32_t last_step = 0;
    };

    explicit HeightDrift(const HeightDriftConfig& config) : config_(config) {}
    /// Takes the memory for a map of this size; nothing allocates afterwards.
    void reserve(const grid::GridGeometry& geometry);
    /// `old` and `recent` as in HeightResiduals. Serial: the same bytes
    /// however the map is fused.
    [[nodiscard]] Verdict judge(std::span<const HeightResidual> old,
                                std::span<const HeightResidual> recent,
                                const Frame& frame);

    /// Whether the motion may have moved a cell with this share of the variance by an offset.
    [[nodiscard]] bool allows(double offset_m, double motion_var_m2) const noexcept;

  private:
    /// Mean of the agreeing cells of a tile.
    struct Tile {
        int cells = 0;
        double sum_m = 0.0;
        Eigen::Vector2d sum_from_m = Eigen::Vector2d::Zero();
    };
    /// Tiles as points (x, y, offset), x and y from the camera's foot.
    struct Field {
        int tiles = 0;
        Eigen::Vector2d mean_m = Eigen::Vector2d::Zero();
        double offset_m = 0.0;
        double scatter_m2 = 0.0;  ///< of the offsets
        double spread_m = 0.0;
        Eigen::Vector2d slope = Eigen::Vector2d::Zero();
        double slope_chi2 = 0.0;  ///< of no slope, 2 degrees of freedom
    };

    /// What the older half of the old cells has in common.
    struct Evidence {
        std::int64_t asked = 0;
        std::int64_t agreeing = 0;  ///< within their noise of the offset; the rest is of these
        Eigen::Vector2d ground_slope = Eigen::Vector2d::Zero();
        double drift_m = 0.0;  ///< horizontal, 1 sigma
        double motion_var_m2 = 0.0;
        double later_var_m2 = 0.0;  ///< of the height, from the motion since the residuals
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
    /// Of the offset, with what the frame may do wrong to all its heights.
    [[nodiscard]] double variance_m2(const Evidence& evidence, const Frame& frame) const;
    [[nodiscard]] HeightDriftReason reason_of(const HeightDriftReport& report,
                                              const Evidence& evidence,
                                              std::span<const HeightResidual> recent,
                                              const Frame& frame);
    /// What the frame makes of lately aligned ground, continued as a plane to `at_m` (from the
    /// camera's foot); 0 where it saw too little of it.
    [[nodiscard]] double frame_error_m(std::span<const HeightResidual> recent,
                                       const Eigen::Vector2d& at_m,
                                       const Frame& frame);

    HeightDriftConfig config_;
    std::vector<std::uint32_t> steps_;
    std::vector<double> weights_;  ///< histogram of offsets
    std::vector<Tile> tiles_;
};

}  // namespace surefoot::elevation
