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

/// Where the whole foot may stand. The figures are those of the REX's machine file and of the
/// gate's rule for flat ground (design.md): the gate judges one foot in one pose of one movement,
/// this one every cell, for a foot turned in any way.
struct FootholdConfig {
    double foot_radius_m = 0.206;  ///< half the diagonal of a foot of 0.366 x 0.190 m
    double foot_width_m = 0.190;   ///< its shorter side
    double margin_m = 0.05;        ///< edges may lie two cells beside where the map has them
    double band_m = 0.10;          ///< solid ground wanted beyond the foot
    /// Where two edges meet, a matcher puts the nearer ground up to three cells too far over the
    /// lower: drops that begin so far beyond the band may reach into it.
    double corner_m = 0.075;
    double drop_m = 0.05;       ///< ground lower than the foot by more is a drop
    double max_slope = 0.1051;  ///< rise over run: tan 6 deg
    double patch_side_m = 0.05;
    double max_residual_m = 0.025;   ///< of the mean of a patch to the plane under the foot
    double sigma_factor = 3.4;       ///< one-sided 3e-4
    double independent_cells = 4.0;  ///< at most so many independent errors in a patch
    /// Errors of a semi-global matcher are shared over 30-50 px: 0.1 m of floor 1 m away.
    double correlation_m = 0.1;
    double clearance_m = 2.05;  ///< of the tallest user on the foot plates
    /// ASSUMPTION: single wrong matches over the floor cover one to three cells of 25 mm.
    double overhead_side_m = 0.05;

    void describe(ConfigVisitor& visitor);
    /// First reason why this cannot be used, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
    /// Cells are neither larger than a foot nor so small that it covers more of them than there is
    /// memory for: nothing is known about other grids.
    [[nodiscard]] bool fits(double resolution_m) const noexcept;
};

enum class Foothold : std::uint8_t {
    unknown,      ///< not all cells under the foot and around it are known
    safe,         ///< shown at `sigma_factor`
    unsure,       ///< neither safe nor unsafe can be shown: the heights are not sure enough
    unreachable,  ///< safe as such, but no way is known that leads there from the stance
    drop,         ///< this and the following: shown to be unsafe, and by what
    tilted,
    rough,
    low,  ///< too little room above
};
[[nodiscard]] std::string_view to_string(Foothold foothold) noexcept;

/// What is known of the ground; all layers have one size, row iy, column ix.
struct FootholdGround {
    ImageView<const float> height_m;       ///< NaN = unknown
    ImageView<const float> height_var_m2;  ///< empty = 0
    ImageView<const float> clearance_m;    ///< empty or NaN = open
    /// Of unknown cells: the ground there, if any, is lower, because lines of sight passed. Empty
    /// or NaN = nothing is known.
    ImageView<const float> free_above_m;
    ImageView<const float> reach_step_m;  ///< see Reachability; empty = everything is reachable
    double resolution_m = 0.0;
    /// Looks that agree on the height; empty = more than one.
    ImageView<const std::uint32_t> looks = {};
};

/// Finds the footholds of a map. Around a cell let F be the disc of the foot plus margin, B the one
/// wider by the band, p the least-squares plane through F, and k = `sigma_factor`.
/// - unknown: F or B hold unknown cells (if a drop is shown in B it counts all the same);
/// - drop: ground in B lies more than `drop_m` below the middle of p (of the cell, where F is not
///   known), at k sigma of the ground. What one look alone saw may be a wrong match, and is unsure;
/// - tilted: p rises by more than `max_slope`, at k sigma: those of a disc that holds an
///   independent error in each square of `correlation_m`, whose points lie half the radius from its
///   diameter (rms);
/// - rough: the mean of a patch within F is more than `max_residual_m` from p, at k sigma of the
///   mean (variance of the cells over their number, at most `independent_cells`);
/// - low: `clearance_m` is less than wanted over as many cells of F as a square of
///   `overhead_side_m` has (over fewer it is unsure: wrong matches are as small, cables are not;
///   and over any of B: the far rim of a table top is seen too flat to be measured);
/// - unreachable: the cell has no `reach_step_m`.
/// What is only beyond a limit when k sigma are added is unsure. So are
/// - what has ground in B, or within `corner_m` beyond it, that is shown to lie by more than half
/// of
///   `drop_m` below all of p there (not asked for if `corner_m` is 0);
/// - where p rises by more than half of `max_slope`: what has a plane steeper than that under the
///   foot itself, no margin, at one of kYaws yaws. The narrow foot tilts more than the disc does
///   where a ramp begins or ends. Its sigma is not asked for: it would doubt every ramp of 1:12.
///
/// Holds the working memory: maps of one size allocate nothing after the first. The same bytes for
/// every executor. Cost: cells times rows of B.
class FootholdFinder {
  public:
    explicit FootholdFinder(const FootholdConfig& config);
    FootholdFinder(FootholdFinder&&) noexcept;
    FootholdFinder& operator=(FootholdFinder&&) noexcept;
    ~FootholdFinder();
    [[nodiscard]] const FootholdConfig& config() const noexcept { return config_; }
    /// Yaws of the foot, as far apart as each other; half a turn exchanges heel and toe.
    static constexpr int kYaws = 8;
    /// `out` gets the size of the map; `config().problem()` is empty.
    void find(const FootholdGround& ground, Executor& executor, Image<Foothold>& out);

  private:
    /// Running sums along the rows; element ix = sum over the cells before column ix.
    struct Sums {
        double z = 0.0;
        double xz = 0.0;  ///< x in cells from column 0
        double var = 0.0;
        double unknown = 0.0;
        double tight = 0.0;  ///< cells whose clearance is not open
    };
    struct Row;
    /// The cells under a foot turned by one of the yaws, row by row, and their second moments about
    /// its middle [cells^2].
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
    /// Minus the lowest that is shown in B.
    [[nodiscard]] float low_in_band(int ix, int iy) const;
    /// Ground within `corner_m` of B is shown to be lower than p by half a drop; `low_near` is
    /// minus the lowest that is shown there.
    [[nodiscard]] bool drop_begins(double middle_m, double slope, float low_near) const;
    /// A plane under the foot is steeper than allowed at one of the yaws; F is known.
    [[nodiscard]] bool tilts_at_a_yaw(int ix, int iy) const;

    FootholdConfig config_;
    int nx_ = 0;
    int ny_ = 0;
    double resolution_m_ = 0.0;
    std::vector<int> foot_;  ///< half widths of the rows 0 ... reach of F [cells]
    std::vector<int> band_;  ///< of B
    std::vector<int> near_;  ///< of B and the corners beyond it
    std::array<TurnedFoot, kYaws> turned_;
    int patch_cells_ = 1;
    double overhead_cells_ = 0.0;    ///< of a square of `overhead_side_m`
    double foot_cells_ = 0.0;        ///< of F
    double foot_moment_ = 0.0;       ///< sum of x^2 over F [cells^2]
    double slope_sigmas_per_m_ = 0;  ///< k sigma of the slope for each metre of sigma of a cell
    std::vector<Sums> sums_;         ///< (nx + 1) a row
    Image<float> patch_m_;           ///< mean of the patch that begins at a cell; NaN = unknown
    Image<float> patch_doubt_m_;     ///< k sigma of it
    RunMaxima patch_high_;           ///< mean + k sigma
    RunMaxima patch_low_;            ///< -(mean - k sigma)
    RunMaxima low_shown_;            ///< -(height + k sigma) that looks agree on, or -free_above
    RunMaxima low_possible_;         ///< -(height - k sigma)
    std::vector<Row> rows_;
};

}  // namespace surefoot::traversability
