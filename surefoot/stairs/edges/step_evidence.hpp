// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// Evidence of the heights beside an edge for one of two explanations: "step" or "smooth
/// ground".
struct StepEvidence {
    /// Natural logarithm of the likelihood ratio "step" over "smooth ground". NaN = the map knows
    /// too little of one side.
    double log_ratio = 0.0;
    /// Fall of the ground at the edge that the slopes of both sides do not explain [m].
    double fall_m = 0.0;
    /// True if the ground between both sides is unknown over more than `StairsConfig::smear_m`.
    bool is_hidden = false;
};

/// Compares two explanations of the ground beside an edge:
/// - Step: two planes with a fall between them. The fall is no wider than the larger of `smear_m`
///   and the unknown gap. Both slopes and the position of the fall near the edge are free.
/// - Smooth ground, the best of four models: one plane; two planes with a crease; two planes and a
///   slope between them of at least twice `smear_m`; a polynomial of degree 2 to 5 with a bend of
///   at most kMostBend_per_m. No smooth model is steeper than kSteepest. Both explanations may fall
///   along the edge.
///
/// The likelihood is a Gaussian composite likelihood (Varin, Reid and Firth 2011). Cells count
/// as independent, and the sum is divided by the number of cells that share one error. This
/// number is the summed autocorrelation of the residuals along rows, times the sum along
/// columns. The variance of a cell is the variance of the residuals, or the mean variance in
/// the map if the latter is larger. In addition, all cells of a slice share an error of
/// `evidence_shared_m`, and so do slices within kCorrelation_m of each other. A longer edge
/// does not average this error away. A model pays for each of its parameters (BIC, Schwarz
/// 1978).
///
/// Owns the working memory; not thread-safe. The same map gives the same result.
class StepEvidenceFinder {
  public:
    static constexpr double kSteepest = 0.84;       ///< rise over run of 40 deg
    static constexpr double kMostBend_per_m = 4.0;  ///< radius of curvature 0.25 m

    explicit StepEvidenceFinder(const StairsConfig& config) : config_(config) {}
    /// `upper_m`, `lower_m`: largest depth of the ground used above and below the edge [m].
    [[nodiscard]] StepEvidence weigh(const Terrain& terrain,
                                     const Edge& edge,
                                     double upper_m,
                                     double lower_m);

  private:
    struct Cell {
        int slice = 0;
        int x = 0;  ///< column and row in the box of all cells
        int y = 0;
        double s_m = 0.0;  ///< position across the edge; positive below it
        double t_m = 0.0;  ///< position along the edge
        double z_m = 0.0;  ///< height relative to the upper ground
    };
    /// All cells at one distance from the edge.
    struct Slice {
        double s_m = 0.0;  ///< mean position across the edge
        double cells = 0.0;
        double z_m = 0.0;  ///< mean height, without the slope along the edge
        double weight_per_m2 = 0.0;
    };
    struct Gap {
        double from_m = 0.0;
        double to_m = 0.0;
    };
    struct Fit {
        double squares = 0.0;  ///< sum of (residual / sigma)^2, plus the penalty of the slopes
        double upper_slope = 0.0;
        double lower_slope = 0.0;
        double rise_m = 0.0;  ///< height difference between both planes
    };
    void gather(const Terrain& terrain, const Edge& edge, double upper_m, double lower_m);
    [[nodiscard]] double slope_along(double length_m);
    void measure_slices(double length_m);
    void weigh_slices();
    [[nodiscard]] double cells_per_error(double scatter_m) const;
    [[nodiscard]] Gap find_gap() const;
    [[nodiscard]] Fit fit_planes(double from_m, double to_m, bool is_step) const;
    [[nodiscard]] Fit fit_crease(double at_m) const;
    [[nodiscard]] double cost(double squares, int parameters) const;
    [[nodiscard]] double cost_of_creases() const;
    [[nodiscard]] double cost_of_polynomial(int degree) const;
    [[nodiscard]] double cost_of_smooth_ground(bool is_hidden) const;
    [[nodiscard]] double cost_of_step(const Gap& gap, double& fall_m) const;

    StairsConfig config_;
    double resolution_m_ = 0.0;
    double stated_var_m2_ = 0.0;
    double independent_ = 2.0;  ///< number of independent errors in all cells
    int box_width_ = 0;
    int box_height_ = 0;
    std::vector<Cell> cells_;
    std::vector<int> all_in_slice_;  ///< number of cells, known or not
    std::vector<int> slice_of_;      ///< index in `slices_`; -1 = too few known cells
    std::vector<Slice> slices_;      ///< slices, from the upper side on
    std::vector<float> residual_m_;  ///< residuals of the cells in the box; NaN = no cell
    std::vector<double> values_;
    std::vector<double> slopes_;
    std::array<std::vector<double>, 2> halves_;  ///< heights of the two halves of a slice
};

/// True if the likelihood ratio of the edge reaches `StairsConfig::step_ratio`, or if that is 0.
[[nodiscard]] bool is_step_of(const StairsConfig& config, const Edge& edge);

}  // namespace surefoot::stairs
