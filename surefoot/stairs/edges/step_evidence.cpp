// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/edges/step_evidence.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/geometry/statistics.hpp"
#include "surefoot/stairs/edges/edge_cells.hpp"
#include "surefoot/stairs/edges/slice_mean.hpp"

namespace surefoot::stairs {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kNothing = std::numeric_limits<double>::infinity();
/// Depth of ground used on either side. With more depth, one plane would have to fit several
/// treads.
constexpr double kWindow_m = 0.35;
constexpr double kLeastShare = 0.25;  ///< smallest share of known cells in a slice
constexpr int kLeastSlices = 2;       ///< smallest number of slices on either side
/// Longest lag [cells]: 0.15 m for cells of 25 mm; `evidence_shared_m` covers errors that reach
/// farther.
constexpr int kLags = 6;
constexpr double kClip_sigma = 3.0;
/// Prior: one sigma of the slope of ground (19 deg). It bounds the slopes of short pieces.
constexpr double kUsualSlope = 0.35;
constexpr int kCreaseStep = 2;  ///< distance between tested creases [slices]
constexpr int kLargestDegree = 5;
/// Smallest fall as a share of the smallest edge height. The fit assigns a part of a low step to
/// the slopes.
constexpr double kLeastFall = 0.75;
constexpr double kMostLogRatio = 690.0;  ///< ratio 1e300; larger values are all equal

constexpr double square(double value) {
    return value * value;
}

}  // namespace

bool is_step_of(const StairsConfig& config, const Edge& edge) {
    return !(config.step_ratio > 0.0) || edge.log_step_ratio >= std::log(config.step_ratio);
}

void StepEvidenceFinder::gather(const Terrain& terrain,
                                const Edge& edge,
                                double upper_m,
                                double lower_m) {
    resolution_m_ = terrain.geometry.resolution_m;
    // Each depth is about a metre or less, which is tens of cells.
    const int upper = saturated_integer<int>(std::ceil(upper_m / resolution_m_));
    const int slices = upper + saturated_integer<int>(std::ceil(lower_m / resolution_m_));
    cells_.clear();
    stated_var_m2_ = 0.0;
    std::vector<int>& all = all_in_slice_;
    all.assign(static_cast<std::size_t>(slices), 0);
    int x0 = terrain.geometry.nx, y0 = terrain.geometry.ny, x1 = 0, y1 = 0;
    const auto visit = [&](int ix, int iy, double s_cells, double t_cells) {
        // in range: for_each_cell_about() gives 0 <= s_cells < slices
        ++all[static_cast<std::size_t>(s_cells)];
        const auto z_m = static_cast<double>(terrain.height_m.row(iy)[ix]);
        if (!std::isfinite(z_m)) return;
        cells_.push_back({.slice = static_cast<int>(s_cells),  // in range: as above
                          .x = ix,
                          .y = iy,
                          .s_m = (s_cells - upper) * resolution_m_,
                          .t_m = t_cells * resolution_m_,
                          .z_m = z_m - edge.upper_m});
        if (!terrain.height_var_m2.empty())
            stated_var_m2_ += static_cast<double>(terrain.height_var_m2.row(iy)[ix]);
        x0 = std::min(x0, ix);
        y0 = std::min(y0, iy);
        x1 = std::max(x1, ix);
        y1 = std::max(y1, iy);
    };
    for_each_cell_about(terrain.geometry, edge, upper, slices, visit);
    if (cells_.empty()) return;
    stated_var_m2_ /= static_cast<double>(cells_.size());
    box_width_ = x1 - x0 + 1;
    box_height_ = y1 - y0 + 1;
    for (Cell& cell : cells_) {
        cell.x -= x0;
        cell.y -= y0;
    }
}

/// Returns the slope along the edge that all slices share. The slope of a slice is the slope
/// between the medians of its two halves; the result is the median over the slices. Objects on the
/// line and slices across a riser are few and have no effect.
double StepEvidenceFinder::slope_along(double length_m) {
    slopes_.clear();
    std::sort(cells_.begin(), cells_.end(), [](const Cell& a, const Cell& b) {
        if (a.slice != b.slice) return a.slice < b.slice;
        return a.y != b.y ? a.y < b.y : a.x < b.x;
    });
    for (std::size_t begin = 0; begin < cells_.size();) {
        std::size_t end = begin;
        std::array<std::vector<double>, 2>& z_m = halves_;
        std::array<double, 2> t_m{};
        for (std::vector<double>& half : z_m) half.clear();
        for (; end < cells_.size() && cells_[end].slice == cells_[begin].slice; ++end) {
            const std::size_t half = cells_[end].t_m < 0.5 * length_m ? 0 : 1;
            z_m[half].push_back(cells_[end].z_m);
            t_m[half] += cells_[end].t_m;
        }
        begin = end;
        if (std::min(z_m[0].size(), z_m[1].size()) < 3) continue;
        const double apart_m = t_m[1] / static_cast<double>(z_m[1].size()) -
                               t_m[0] / static_cast<double>(z_m[0].size());
        slopes_.push_back((upper_median_in_place(z_m[1]) - upper_median_in_place(z_m[0])) /
                          apart_m);
    }
    return slopes_.empty() ? 0.0 : upper_median_in_place(slopes_);
}

void StepEvidenceFinder::measure_slices(double length_m) {
    const double slope = slope_along(length_m);
    for (Cell& cell : cells_) cell.z_m -= slope * cell.t_m;
    slices_.clear();
    slice_of_.assign(all_in_slice_.size(), -1);
    for (std::size_t begin = 0; begin < cells_.size();) {
        std::size_t end = begin;
        values_.clear();
        for (; end < cells_.size() && cells_[end].slice == cells_[begin].slice; ++end)
            values_.push_back(cells_[end].z_m);
        const auto k = static_cast<std::size_t>(cells_[begin].slice);
        const auto known = static_cast<double>(values_.size());
        if (known >= kLeastShare * all_in_slice_[k]) {
            const double middle_m = upper_median_in_place(values_);
            const double most_m = kClip_sigma * robust_sigma_about(middle_m, values_) + 1e-4;
            Slice slice;
            for (std::size_t i = begin; i < end; ++i) {
                if (std::abs(cells_[i].z_m - middle_m) > most_m) continue;
                slice.cells += 1.0;
                slice.s_m += cells_[i].s_m;
                slice.z_m += cells_[i].z_m;
            }
            slice.s_m /= slice.cells;
            slice.z_m /= slice.cells;
            slice_of_[k] = static_cast<int>(slices_.size());
            slices_.push_back(slice);
        }
        begin = end;
    }
}

/// Computes the weights of the slices from the residuals of the cells. A residual is the height
/// above the profile, which is linear between the slices.
void StepEvidenceFinder::weigh_slices() {
    residual_m_.assign(static_cast<std::size_t>(box_width_) * static_cast<std::size_t>(box_height_),
                       std::numeric_limits<float>::quiet_NaN());
    values_.clear();
    double count = 0.0;
    for (const Cell& cell : cells_) {
        const int k = slice_of_[static_cast<std::size_t>(cell.slice)];
        if (k < 0) continue;
        const Slice& here = slices_[static_cast<std::size_t>(k)];
        const int other = cell.s_m < here.s_m ? k - 1 : k + 1;
        double z_m = here.z_m;
        if (other >= 0 && other < static_cast<int>(slices_.size())) {
            const Slice& next = slices_[static_cast<std::size_t>(other)];
            z_m += (cell.s_m - here.s_m) / (next.s_m - here.s_m) * (next.z_m - here.z_m);
        }
        const double left_m = cell.z_m - z_m;
        residual_m_[static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(box_width_) +
                    static_cast<std::size_t>(cell.x)] = static_cast<float>(left_m);
        values_.push_back(left_m);
        count += 1.0;
    }
    const double scatter_m = robust_sigma_about(0.0, values_);
    // The mean of each slice uses one degree of freedom.
    const double taken = std::max(1.0, count - static_cast<double>(slices_.size()));
    const double cell_var_m2 = std::max(square(scatter_m) * count / taken, stated_var_m2_);
    const double shared_var_m2 = square(config_.evidence_shared_m);
    const double shared_slices = std::max(1.0, kCorrelation_m / resolution_m_);
    const double variance_m2 = cell_var_m2 * cells_per_error(scatter_m);
    double independent = 0.0;
    for (Slice& slice : slices_) {
        const double own_var_m2 = variance_m2 / slice.cells;
        const double shared_m2 = shared_var_m2 * shared_slices;
        slice.weight_per_m2 = 1.0 / (own_var_m2 + shared_m2);
        independent += (own_var_m2 + shared_var_m2) * slice.weight_per_m2;
    }
    independent_ = std::max(2.0, independent);
}

/// Returns the number of cells that count as one independent cell: the sum of the autocorrelation
/// over the lags along rows, times the sum along columns.
double StepEvidenceFinder::cells_per_error(double scatter_m) const {
    if (!(scatter_m > 0.0)) return 1.0;
    const auto most = static_cast<float>(kClip_sigma * scatter_m);
    const auto at = [&](int x, int y) {
        const float left = residual_m_[static_cast<std::size_t>(y * box_width_ + x)];
        return left == left ? std::clamp(left, -most, most) : left;
    };
    double product = 1.0;
    for (const bool rows : {true, false}) {
        std::array<double, kLags + 1> sum{};
        std::array<double, kLags + 1> pairs{};
        for (int y = 0; y < box_height_; ++y) {
            for (int x = 0; x < box_width_; ++x) {
                const float here = at(x, y);
                if (here != here) continue;
                for (int lag = 0; lag <= kLags; ++lag) {
                    const int other_x = rows ? x + lag : x;
                    const int other_y = rows ? y : y + lag;
                    if (other_x >= box_width_ || other_y >= box_height_) break;
                    const float other = at(other_x, other_y);
                    if (other != other) continue;
                    const auto i = static_cast<std::size_t>(lag);
                    sum[i] += static_cast<double>(here) * static_cast<double>(other);
                    pairs[i] += 1.0;
                }
            }
        }
        double cells = 1.0;
        for (std::size_t lag = 1; lag <= kLags; ++lag) {
            if (!(pairs[lag] >= 0.25 * pairs[0]) || !(sum[0] > 0.0)) break;
            const double correlation = (sum[lag] / pairs[lag]) / (sum[0] / pairs[0]);
            if (correlation <= 0.0) break;
            cells += 2.0 * correlation;
        }
        product *= cells;
    }
    return product;
}

/// Fits two planes and the transition between them. Parameters: height of the upper plane at
/// `from_m`, its slope, the rise from `from_m` to `to_m`, the slope of the lower plane.
StepEvidenceFinder::Fit StepEvidenceFinder::fit_planes(double from_m,
                                                       double to_m,
                                                       bool is_step) const {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    double squares = 0.0;
    const double width_m = to_m - from_m;
    for (const Slice& slice : slices_) {
        const double s_m = slice.s_m;
        const double share = s_m < from_m  ? 0.0
                             : s_m >= to_m ? 1.0
                                           : (s_m - from_m) / std::max(width_m, 1e-9);
        const Eigen::Vector4d basis(
            1.0, std::min(s_m - from_m, 0.0), share, std::max(s_m - to_m, 0.0));
        normal.noalias() += slice.weight_per_m2 * basis * basis.transpose();
        right += slice.weight_per_m2 * slice.z_m * basis;
        squares += slice.weight_per_m2 * square(slice.z_m);
    }
    const double usual = 1.0 / square(kUsualSlope);
    normal(1, 1) += usual;
    normal(3, 3) += usual;
    normal(2, 2) += is_step ? 1e-9 : usual / square(width_m);
    normal(0, 0) += 1e-12;
    const Eigen::Vector4d found = normal.ldlt().solve(right);
    Fit fit;
    // This sum includes the penalty of the slopes.
    fit.squares = std::max(0.0, squares - found.dot(right));
    fit.upper_slope = found[1];
    fit.lower_slope = found[3];
    fit.rise_m = found[2];
    return fit;
}

double StepEvidenceFinder::cost(double squares, int parameters) const {
    return 0.5 * squares + 0.5 * parameters * std::log(independent_);
}

/// Returns the lowest cost of two planes with a crease, or with a slope between them.
double StepEvidenceFinder::cost_of_creases() const {
    double least = kNothing;
    const auto is_walked = [](double slope) { return std::abs(slope) <= kSteepest; };
    const auto count = static_cast<int>(slices_.size());
    const double least_m = 2.0 * config_.smear_m;
    // A crease may also lie between the centres of two slices.
    for (int a = 2; a < 2 * count - 2; ++a) {
        const Slice& before = slices_[static_cast<std::size_t>((a - 1) / 2)];
        const Slice& behind = slices_[static_cast<std::size_t>(a / 2)];
        const Fit crease = fit_crease(0.5 * (before.s_m + behind.s_m));
        if (is_walked(crease.upper_slope) && is_walked(crease.lower_slope))
            least = std::min(least, cost(crease.squares, 4));
    }
    for (int a = 1; a + 1 < count; a += kCreaseStep) {
        const double from_m = slices_[static_cast<std::size_t>(a)].s_m;
        for (int b = a + 1; b < count; b += kCreaseStep) {
            const double to_m = slices_[static_cast<std::size_t>(b)].s_m;
            if (to_m - from_m < least_m - 1e-6) continue;
            const Fit fit = fit_planes(from_m, to_m, false);
            if (is_walked(fit.upper_slope) && is_walked(fit.lower_slope) &&
                is_walked(fit.rise_m / (to_m - from_m)))
                least = std::min(least, cost(fit.squares, 6));
        }
    }
    return least;
}

/// Fits two planes that meet at `at_m`.
StepEvidenceFinder::Fit StepEvidenceFinder::fit_crease(double at_m) const {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double squares = 0.0;
    for (const Slice& slice : slices_) {
        const double s_m = slice.s_m - at_m;
        const Eigen::Vector3d basis(1.0, std::min(s_m, 0.0), std::max(s_m, 0.0));
        normal.noalias() += slice.weight_per_m2 * basis * basis.transpose();
        right += slice.weight_per_m2 * slice.z_m * basis;
        squares += slice.weight_per_m2 * square(slice.z_m);
    }
    const double usual = 1.0 / square(kUsualSlope);
    normal(1, 1) += usual;
    normal(2, 2) += usual;
    const Eigen::Vector3d found = normal.ldlt().solve(right);
    return {.squares = std::max(0.0, squares - found.dot(right)),
            .upper_slope = found[1],
            .lower_slope = found[2],
            .rise_m = 0.0};
}

/// Returns the cost of a polynomial; infinite if it is too steep or too bent for walkable ground.
double StepEvidenceFinder::cost_of_polynomial(int degree) const {
    constexpr int kMost = kLargestDegree + 1;
    using Square = Eigen::Matrix<double, kMost, kMost>;
    using Column = Eigen::Matrix<double, kMost, 1>;
    Square normal = Square::Identity() * 1e-12;
    Column right = Column::Zero();
    const double middle_m = 0.5 * (slices_.front().s_m + slices_.back().s_m);
    const double half_m = std::max(0.5 * (slices_.back().s_m - slices_.front().s_m), 1e-6);
    double squares = 0.0;
    for (const Slice& slice : slices_) {
        const double x = (slice.s_m - middle_m) / half_m;
        Column basis = Column::Zero();
        double power = 1.0;
        for (int i = 0; i <= degree; ++i, power *= x) basis[i] = power;
        normal.noalias() += slice.weight_per_m2 * basis * basis.transpose();
        right += slice.weight_per_m2 * slice.z_m * basis;
        squares += slice.weight_per_m2 * square(slice.z_m);
    }
    for (int i = degree + 1; i < kMost; ++i) normal(i, i) = 1.0;
    normal(1, 1) += 1.0 / square(kUsualSlope * half_m);
    const Column found = normal.ldlt().solve(right);
    for (const Slice& slice : slices_) {
        const double x = (slice.s_m - middle_m) / half_m;
        double slope = 0.0, bend = 0.0;
        for (int i = degree; i >= 1; --i) slope = slope * x + i * found[i];
        for (int i = degree; i >= 2; --i) bend = bend * x + i * (i - 1) * found[i];
        if (std::abs(slope) / half_m > kSteepest ||
            std::abs(bend) / square(half_m) > kMostBend_per_m)
            return kNothing;
    }
    return cost(std::max(0.0, squares - found.dot(right)), degree + 1);
}

double StepEvidenceFinder::cost_of_smooth_ground(bool is_hidden) const {
    double least = cost_of_creases();
    // Over unknown ground nothing constrains a polynomial of higher degree.
    const int most = is_hidden ? 1 : kLargestDegree;
    for (int degree = 1; degree <= most; ++degree)
        least = std::min(least, cost_of_polynomial(degree));
    return least;
}

double StepEvidenceFinder::cost_of_step(const Gap& gap, double& fall_m) const {
    double least = kNothing;
    const double widest_m = std::max(config_.smear_m, gap.to_m - gap.from_m);
    for (std::size_t a = 0; a + 1 < slices_.size(); ++a) {
        // A position in the middle between two slices.
        const double from_m = 0.5 * (slices_[a].s_m + slices_[a + 1].s_m);
        if (from_m < -config_.smear_m || from_m > std::max(config_.smear_m, gap.to_m)) continue;
        for (std::size_t b = a; b + 1 < slices_.size(); ++b) {
            const double to_m = 0.5 * (slices_[b].s_m + slices_[b + 1].s_m);
            if (to_m - from_m > widest_m + 1e-6) break;
            const Fit fit = fit_planes(from_m, to_m, true);
            const double mine = cost(fit.squares, 6);
            const double falls_m =
                0.5 * (fit.upper_slope + fit.lower_slope) * (to_m - from_m) - fit.rise_m;
            if (mine >= least || falls_m < kLeastFall * config_.min_height_m) continue;
            least = mine;
            fall_m = falls_m;
        }
    }
    return least;
}

/// Finds the longest unknown interval at the edge or below it.
StepEvidenceFinder::Gap StepEvidenceFinder::find_gap() const {
    Gap gap;
    for (std::size_t k = 0; k + 1 < slices_.size(); ++k) {
        const double from_m = slices_[k].s_m + 0.5 * resolution_m_;
        const double to_m = slices_[k + 1].s_m - 0.5 * resolution_m_;
        if (to_m < -config_.smear_m || to_m - from_m <= gap.to_m - gap.from_m + 1e-6) continue;
        gap = {from_m, to_m};
    }
    return gap;
}

StepEvidence StepEvidenceFinder::weigh(const Terrain& terrain,
                                       const Edge& edge,
                                       double upper_m,
                                       double lower_m) {
    StepEvidence evidence{.log_ratio = kNone};
    gather(terrain, edge, std::min(upper_m, kWindow_m), lower_m);
    if (cells_.empty()) return evidence;
    measure_slices(edge.length_m());
    if (slices_.size() < 2 * kLeastSlices) return evidence;
    Gap gap = find_gap();
    if (gap.to_m - gap.from_m < resolution_m_) gap = {};
    evidence.is_hidden = gap.to_m - gap.from_m > config_.smear_m;
    const double last_m = std::max(0.0, gap.to_m) + kWindow_m;
    weigh_slices();
    std::erase_if(slices_, [&](const Slice& slice) { return slice.s_m > last_m; });
    const double middle_m = 0.5 * (gap.from_m + gap.to_m);
    const auto above = std::count_if(
        slices_.begin(), slices_.end(), [&](const Slice& slice) { return slice.s_m < middle_m; });
    if (above < kLeastSlices || static_cast<int>(slices_.size()) - above < kLeastSlices)
        return evidence;
    const double step = cost_of_step(gap, evidence.fall_m);
    const double smooth = cost_of_smooth_ground(evidence.is_hidden);
    evidence.log_ratio = std::isfinite(step) && std::isfinite(smooth)
                             ? std::clamp(smooth - step, -kMostLogRatio, kMostLogRatio)
                         : std::isfinite(step) ? kMostLogRatio
                                               : -kMostLogRatio;
    return evidence;
}

}  // namespace surefoot::stairs
