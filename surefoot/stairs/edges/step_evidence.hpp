// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "surefoot/stairs/features.hpp"
#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stairs/terrain.hpp"

namespace surefoot::stairs {

/// What the heights on both sides of an edge say of the two explanations "step" and "smooth
/// ground".
struct StepEvidence {
    /// Natural logarithm of the likelihood ratio, step over smooth ground. NaN = the map knows too
    /// little of one side.
    double log_ratio = 0.0;
    /// What the ground falls by at the edge, beyond what the slopes of both sides explain [m].
    double fall_m = 0.0;
    /// The ground between both sides is unknown over more than `StairsConfig::smear_m`.
    bool is_hidden = false;
};

/// Compares two explanations of the ground about an edge:
/// - step: two planes with a fall between them that is no wider than `smear_m` (or than what is
///   unknown there). Their slopes are free, and so is the place of the fall, near the edge.
/// - smooth ground, the best of: one plane; two planes that meet in a crease; two planes with a
///   slope between them that is at least twice `smear_m` wide; a polynomial of degree 2 to 5 that
///   is nowhere bent more than kMostBend_per_m. None of them is steeper than kSteepest.
/// Both may fall along the edge too.
///
/// The likelihood is Gaussian, a composite one (Varin, Reid and Firth 2011): cells count as
/// independent, and the sum is divided by the number of cells that share one error. That number is
/// measured: the sum of the autocorrelation of what the best profile leaves, along rows and along
/// columns of the map. The variance is the measured scatter of cells along the edge, or what the
/// map states where that is more. Beside it all cells of a slice along the edge, and slices within
/// kCorrelation_m of each other, share an error of `evidence_shared_m`: what neither a map nor a
/// plane is true to, however long the edge. Explanations with more parameters pay for them (Schwarz
/// 1978, BIC).
///
/// Holds the working memory; not thread-safe. The same result for the same map.
class StepEvidenceFinder {
  public:
    static constexpr double kSteepest = 0.84;       ///< rise over run of 40 deg
    static constexpr double kMostBend_per_m = 4.0;  ///< radius of 0.25 m

    explicit StepEvidenceFinder(const StairsConfig& config) : config_(config) {}
    /// `upper_m` and `lower_m`: how much ground is looked at above and below the edge [m].
    [[nodiscard]] StepEvidence weigh(const Terrain& terrain,
                                     const Edge& edge,
                                     double upper_m,
                                     double lower_m);

  private:
    struct Cell {
        int slice = 0;
        int x = 0;  ///< column and row in the box of all cells
        int y = 0;
        double s_m = 0.0;  ///< below the edge
        double t_m = 0.0;  ///< along it
        double z_m = 0.0;  ///< above the edge's upper ground
    };
    /// Cells at one distance from the edge.
    struct Slice {
        double s_m = 0.0;  ///< mean
        double cells = 0.0;
        double z_m = 0.0;  ///< mean, without the slope along the edge
        double weight_per_m2 = 0.0;
    };
    struct Gap {
        double from_m = 0.0;
        double to_m = 0.0;
    };
    struct Fit {
        double squares = 0.0;  ///< of the residuals, in sigma
        double upper_slope = 0.0;
        double lower_slope = 0.0;
        double rise_m = 0.0;  ///< between both planes
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
    double independent_ = 2.0;  ///< errors in all cells
    int box_width_ = 0;
    int box_height_ = 0;
    std::vector<Cell> cells_;
    std::vector<int> all_in_slice_;  ///< cells, known or not
    std::vector<int> slice_of_;      ///< index in `slices_`; -1 = too little is known of it
    std::vector<Slice> slices_;      ///< from the upper side on
    std::vector<float> residual_m_;  ///< of the box; NaN = no cell
    std::vector<double> values_;
    std::vector<double> slopes_;
    std::array<std::vector<double>, 2> halves_;  ///< heights of a slice
};

/// The ratio of the edge reaches `StairsConfig::step_ratio`.
[[nodiscard]] bool is_step_of(const StairsConfig& config, const Edge& edge);

}  // namespace surefoot::stairs
