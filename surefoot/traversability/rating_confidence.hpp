// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/traversability/disc.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::traversability {

/// Confidence of the ratings of a map; NaN where a cell has no value.
struct ConfidenceLayers {
    /// Lower bound, 0 ... 1, of the probability that the true rating lies on the same side of
    /// `confidence.safe_threshold`. NaN where the rating is unknown.
    grid::Layer confidence;
    /// Smallest step that exceeds the noise: 3.4 sigma of the mean height of the patch around the
    /// cell [m]. NaN where the height is unknown.
    grid::Layer smallest_step_m;
    /// 1 where an obstacle of `resolve.step_m` may hide in the noise, else 0. NaN: height unknown.
    grid::Layer not_resolvable;
};

/// Propagates the uncertainty of the heights to the ratings.
///
/// The patch is that of the gate (foot_support.hpp). The variance of a mean of n cells is
///   (mean of their variances) / k,   k = min(n, independent_cells),
/// because neighbouring errors are partly the same error. A normal error exceeds 3.4 sigma with
/// probability 3e-4. So a step of 10 mm needs a sigma of at most 2.94 mm; the gate allows 3 mm.
///
/// Confidence, with v = mean variance in the disc of the normals, n = its known cells, f = their
/// share of all its cells, k as above, and n_z = z of the normal:
///   - slope: a fitted gradient has variance v / (k m) along each axis, m = mean square of the
///     distances along x in the disc. A strip of share f keeps f^2 of m (half a disc 0.28). The
///     slope changes by no more than the gradient: sigma_slope = n_z^2 sqrt(2 v / (k m)) / f.
///   - roughness R = standard deviation of heights around the plane; R0 = R without noise:
///     E[R^2] = R0^2 + v. R is at most sqrt(v) too large; its sigma is below sqrt(1.5 v / (k - 1)):
///     sigma_roughness^2 = v (1 + 1.5 / (k - 1)).
///   - step: a step height x = highest - lowest of a disc is too small by at most the error of the
///     true pair, sqrt(2 v). It is too large by at most the range of the disc's errors, with mean
///     d sqrt(v) and deviation below 0.87 sqrt(v) (d after Tippett 1925). So a critical step may be
///     wrong, or may be missed, with q = P(that error > |x - critical|). Q = sum of q over the
///     second disc bounds the probability of a wrong count of critical cells, for any correlation;
///     otherwise the rating t < 1 errs by (1 - t) (error of x) / critical.
///   - rating: the weighted sum of these sigmas, an upper bound for any correlation:
///     confidence = P(normal error < |rating - threshold| / sigma) - Q, at least 0.
/// With `zero_dominates`, a slope or roughness that reaches 0 counts as a wrong side too. If only
/// that rule makes a cell unsafe, its distance beyond 0 is unknown, and the confidence is 0.5.
///
/// No libm: the normal distribution is a polynomial (Abramowitz and Stegun 26.2.19). Sums of
/// variances are exact integers. Allocates only to grow. Not thread-safe.
class RatingConfidence {
  public:
    /// `config`: the config of the ratings, with radii of at least one cell.
    RatingConfidence(const TraversabilityConfig& config, double resolution_m);

    struct Input {
        ImageView<const float> height_m;  ///< NaN = unknown
        /// Rounded up to whole 1e-9 m2. Values above 0.1 m2 or not finite count as 0.1 m2.
        ImageView<const float> height_var_m2;
        const PaddedLayer&
            step_height_m;  ///< Traversability::rated_step_heights() of the whole map
        const TraversabilityLayers& rating;
    };
    /// Computes all cells; the layers of `out` take the size of the map.
    void compute(const Input& input, ConfidenceLayers& out);

  private:
    /// The cells of a disc as runs along x, one for each row -reach ... reach.
    struct RunDisc {
        RunDisc(double radius_m, double resolution_m);
        std::vector<int> half_width;
        int cells = 0;
        [[nodiscard]] int reach() const noexcept { return static_cast<int>(half_width.size()) / 2; }
    };

    void add_up_rows(const Input& input);
    void sum_disc(const RunDisc& disc, int iy);
    void find_sigmas(int iy);
    void find_patches(const Input& input, int iy, ConfidenceLayers& out);
    void find_flips(const Input& input);
    void spread_flip(float probability, int ix, int iy);
    void find_confidence(const TraversabilityLayers& rating, int iy, float* confidence) const;

    TraversabilityConfig config_;
    RunDisc surface_;
    RunDisc steps_;  ///< second disc of the step filter
    RunDisc patch_;
    float inverse_moment_m2_;  ///< 1 / m of the disc of the normals
    float error_range_;        ///< d
    int nx_ = 0;
    int ny_ = 0;
    int margin_ = 0;                     ///< cells beyond the map that runs may cover
    std::vector<std::uint64_t> before_;  ///< packed sums of the cells before a cell in its row
    std::vector<std::uint64_t> sum_;     ///< sums of one row of discs
    std::vector<float> known_;           ///< number of known cells in `sum_`
    std::vector<float> variance_m2_;
    grid::Layer sigma_m_;          ///< sqrt(v)
    grid::Layer slope_sigma_rad_;  ///< sigma of the slope of level ground
    grid::Layer roughness_sigma_m_;
    grid::Layer flips_;  ///< Q
};

/// Returns P(x < z) of a standard normal x; |error| < 1.2e-6, the same bits everywhere.
[[nodiscard]] float normal_cdf(float z) noexcept;

}  // namespace surefoot::traversability
