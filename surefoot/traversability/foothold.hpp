// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/traversability/run_maxima.hpp"

namespace surefoot::traversability {

/// Limits for a position where the whole foot may stand. The figures are those of the REX's machine
/// file and of the gate's rule for flat ground (foot_support.hpp). The gate judges one foot in one
/// pose of one movement. This search judges every cell, for a foot with any yaw.
struct FootholdConfig {
    double foot_radius_m = 0.206;  ///< half the diagonal of a foot of 0.366 x 0.190 m
    double foot_width_m = 0.190;   ///< shorter side of the foot
    double margin_m = 0.05;        ///< position error of an edge: up to two cells
    double band_m = 0.10;          ///< width of the solid ground that is required around the foot
    /// Where two edges meet, a matcher puts the nearer ground up to three cells too far over the
    /// lower ground. So a drop that begins up to this far beyond the band may reach into it.
    double corner_m = 0.075;
    double drop_m = 0.05;       ///< ground that is lower than the foot by more than this is a drop
    double max_slope = 0.1051;  ///< rise over run: tan 6 deg
    double patch_side_m = 0.05;
    double max_residual_m = 0.025;   ///< largest distance of a patch mean from the foot's plane
    double sigma_factor = 3.4;       ///< one-sided error probability 3e-4
    double independent_cells = 4.0;  ///< largest number of independent errors in a patch
    /// A semi-global matcher shares its errors over 30-50 px: over 0.1 m of floor 1 m away.
    double correlation_m = 0.1;
    double clearance_m = 2.05;  ///< height of the tallest user who stands on the foot plates
    /// ASSUMPTION: single wrong matches over the floor cover one to three cells of 25 mm.
    double overhead_side_m = 0.05;

    void describe(ConfigVisitor& visitor);
    /// Returns the first reason why this config cannot be used, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
    /// True if cells are at most as large as `foot_radius_m`, and the foot with margin, band and
    /// corner reaches at most 63 cells from its middle. On other grids every cell is unknown.
    [[nodiscard]] bool fits(double resolution_m) const noexcept;
};

enum class Foothold : std::uint8_t {
    unknown,      ///< not all cells under the foot and around it are known
    safe,         ///< proven safe at `sigma_factor`
    unsure,       ///< neither proven safe nor proven unsafe
    unreachable,  ///< safe, but no known way leads there from the stance
    drop,         ///< `drop` and the following values: proven unsafe, with the cause
    tilted,
    rough,
    low,  ///< too little free height above
};
[[nodiscard]] std::string_view to_string(Foothold foothold) noexcept;

/// Input layers; all have one size, row iy, column ix.
struct FootholdGround {
    ImageView<const float> height_m;       ///< NaN = unknown
    ImageView<const float> height_var_m2;  ///< empty = 0
    ImageView<const float> clearance_m;    ///< empty or NaN = open
    /// Unknown cells: lines of sight passed at this height, so any ground there is lower. Empty or
    /// NaN = nothing is known.
    ImageView<const float> free_above_m;
    ImageView<const float> reach_step_m;  ///< see Reachability; empty = everything is reachable
    double resolution_m = 0.0;
    /// Number of observations that agree on the height; empty = more than one.
    ImageView<const std::uint32_t> observations = {};
};

/// Finds the footholds of a map. Around a cell, F is the disc of the foot plus margin, B is F plus
/// the band, p is the least-squares plane through F, and k = `sigma_factor`. Results:
/// - unknown: F or B contain unknown cells, and B shows no drop;
/// - drop: ground in B lies more than `drop_m` below the middle of p (of the cell, if F is not
///   known), at k sigma of the ground. Ground with a single observation may be a wrong match:
///   unsure;
/// - tilted: p is steeper than `max_slope` at k sigma. The disc has one independent error per
///   square of `correlation_m`, at an rms distance of half the radius from its diameter;
/// - rough: the mean of a patch within F is more than `max_residual_m` from p, at k sigma of the
///   mean. Its variance is that of a cell over the number of cells (at most `independent_cells`);
/// - low: the free height is below `clearance_m` over as many cells of F as fit in a square of
///   `overhead_side_m`. Fewer such cells (wrong matches, but also cables), or any in B (the far rim
///   of a table top is often not measured), are unsure;
/// - unreachable: the cell has no `reach_step_m`.
/// A limit that is only exceeded when k sigma are added gives unsure. Also unsure are
/// - cells with ground in B, or within `corner_m` beyond B, that is proven to lie more than half of
///   `drop_m` below all of p there (skipped if `corner_m` is 0);
/// - if p is steeper than half of `max_slope`: cells with a plane steeper than `max_slope` under
///   the foot itself, without margin, at one of kYaws yaws. The narrow foot tilts more than the
///   disc where a ramp begins or ends. This test ignores sigma, because otherwise every ramp of
///   1:12 would be unsure.
///
/// Keeps its working memory: maps of one size allocate nothing after the first. Every executor
/// gives the same bytes. Cost: cells times rows of B. Not thread-safe.
class FootholdFinder {
  public:
    explicit FootholdFinder(const FootholdConfig& config);
    FootholdFinder(FootholdFinder&&) noexcept;
    FootholdFinder& operator=(FootholdFinder&&) noexcept;
    ~FootholdFinder();
    [[nodiscard]] const FootholdConfig& config() const noexcept { return config_; }
    /// Evenly spaced yaws of the foot over half a turn; the other half exchanges heel and toe.
    static constexpr int kYaws = 8;
    /// `out` takes the size of the map. `config().problem()` must be empty.
    void find(const FootholdGround& ground, Executor& executor, Image<Foothold>& out);

  private:
    /// Running sums along the rows; element ix = sum over the cells before column ix.
    struct Sums {
        double z = 0.0;
        double xz = 0.0;  ///< x in cells from column 0
        double var = 0.0;
        double unknown = 0.0;
        double tight = 0.0;  ///< cells with too little clearance
    };
    struct Row;
    /// Cells under a foot at one of the yaws, row by row, and their second moments about the middle
    /// of the foot [cells^2].
    struct TurnedFoot {
        struct Run {
            int dy = 0;
            int first_dx = 0;
            int last_dx = 0;
        };
        std::vector<Run> runs;
        double xx = 0.0;
        double xy = 0.0;
        double yy = 0.0;
    };

    void shape(double resolution_m);
    void sum_row(const FootholdGround& ground, int iy);
    void patch_row(const FootholdGround& ground, int iy);
    void judge_row(const FootholdGround& ground, int iy, Foothold* out);
    void gather(int iy, Row& row) const;
    [[nodiscard]] Foothold judge(const FootholdGround& ground,
                                 int ix,
                                 int iy,
                                 const Row& row) const;
    [[nodiscard]] Foothold judge_patches(
        int ix, int iy, double mean_m, double slope_x, double slope_y) const;
    [[nodiscard]] int patch_half_width(int dy) const;
    [[nodiscard]] TurnedFoot turned_foot(int yaw) const;
    /// Returns minus the lowest proven height in B.
    [[nodiscard]] float low_in_band(int ix, int iy) const;
    /// True if ground in B or within `corner_m` of it is proven lower than p by half of `drop_m`;
    /// `low_near` is minus the lowest proven height there.
    [[nodiscard]] bool drop_begins(double middle_m, double slope, float low_near) const;
    /// True if a plane under the foot is too steep at one of the yaws. F must be known.
    [[nodiscard]] bool tilts_at_a_yaw(int ix, int iy) const;

    FootholdConfig config_;
    int nx_ = 0;
    int ny_ = 0;
    double resolution_m_ = 0.0;
    std::vector<int> foot_;  ///< half widths of the rows 0 ... reach of F [cells]
    std::vector<int> band_;  ///< half widths of the rows of B [cells]
    std::vector<int> near_;  ///< half widths of the rows of B and the corners beyond it
    std::array<TurnedFoot, kYaws> turned_;
    int patch_cells_ = 1;
    double overhead_cells_ = 0.0;    ///< cells of a square of `overhead_side_m`
    double foot_cells_ = 0.0;        ///< number of cells of F
    double foot_moment_ = 0.0;       ///< sum of x^2 over F [cells^2]
    double slope_sigmas_per_m_ = 0;  ///< k sigma of the slope for each metre of sigma of a cell
    std::vector<Sums> sums_;         ///< nx + 1 elements per row
    Image<float> patch_m_;           ///< mean of the patch that begins at a cell; NaN = unknown
    Image<float> patch_k_sigma_m_;   ///< k sigma of the patch mean
    RunMaxima patch_high_;           ///< patch mean + k sigma
    RunMaxima patch_low_;            ///< -(patch mean - k sigma)
    RunMaxima low_shown_;            ///< -(height + k sigma), observations agree; or -free_above
    RunMaxima low_possible_;         ///< -(height - k sigma)
    std::vector<Row> rows_;
};

}  // namespace surefoot::traversability
