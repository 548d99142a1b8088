// SPDX-License-Identifier: Apache-2.0
#include "surefoot/geometry/alignment_solution.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "surefoot/core/pieces.hpp"

namespace surefoot::geometry {
namespace {

using Eigen::Vector3d;

double median_of(std::vector<double> values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

template <typename Value>
double median_over(std::span<const Pair> pairs, const Value& value) {
    std::vector<double> values;
    for (const Pair& pair : pairs) {
        if (pair.counts) values.push_back(value(pair));
    }
    return median_of(std::move(values));
}

/// Pairs of one neighbourhood, by the cube that they lie in.
class Blocks {
  public:
    explicit Blocks(double edge_m) : edge_m_(edge_m) {}

    void add(const Pair& pair, const Vector6d& gradient) {
        std::array<double, 3> cube{};  // whole numbers: no conversion could overflow
        for (std::size_t i = 0; i < 3; ++i)
            cube[i] = std::floor(pair.at_m[static_cast<Eigen::Index>(i)] / edge_m_);
        auto [at, fresh] = sums_.try_emplace(cube, Vector6d::Zero());
        at->second += gradient;
    }
    [[nodiscard]] Matrix6d squares() const {
        Matrix6d sum = Matrix6d::Zero();
        for (const auto& [cube, gradient] : sums_) sum += gradient * gradient.transpose();
        return sum;
    }
    [[nodiscard]] double count() const { return static_cast<double>(sums_.size()); }

  private:
    double edge_m_;
    std::map<std::array<double, 3>, Vector6d> sums_;
};

/// Of the sum of the pairs' gradients, from their scatter.
Matrix6d scatter_of(std::span<const Pair> pairs, const Lever& lever, const Matrix6d& gain) {
    const double ball_m = median_over(pairs, [](const Pair& p) { return p.ball_m; });
    if (!(ball_m > 0.0)) return Matrix6d::Zero();
    Blocks blocks(2.0 * ball_m);
    Matrix6d alone = Matrix6d::Zero();
    double count = 0.0;
    for (const Pair& pair : pairs) {
        if (!pair.counts) continue;
        const Vector6d gradient = pair.weight * pair.across_m * lever.row(pair);
        alone += gradient * gradient.transpose();
        blocks.add(pair, gradient);
        count += 1.0;
    }
    // Six unknowns took their part of the scatter away.
    constexpr double kUnknowns = 6.0;
    alone *= count / std::max(count - kUnknowns, 1.0);
    const Matrix6d together =
        blocks.squares() * (blocks.count() / std::max(blocks.count() - kUnknowns, 1.0));
    const double expected = (gain * alone).trace();
    const double shared = expected > 0.0 ? (gain * together).trace() / expected : 1.0;
    return std::max(shared, 1.0) * alone;
}

/// Sums over the pairs that lie at an edge between surfaces, not on one.
Matrix6d edges_of(std::span<const Pair> pairs, const Lever& lever, double spacing_m) {
    // Thicker than the noise of the surfaces, by more than a share of the spacing.
    constexpr double kNoise = 2.0;
    constexpr double kShare = 0.125;
    const double noise_m = median_over(pairs, [](const Pair& p) { return p.thickness_m; });
    Matrix6d sum = Matrix6d::Zero();
    if (!(spacing_m > 0.0)) return sum;
    for (const Pair& pair : pairs) {
        if (!pair.counts) continue;
        const double edge =
            std::clamp((pair.thickness_m - kNoise * noise_m) / (kShare * spacing_m), 0.0, 1.0);
        if (edge == 0.0) continue;
        const Vector6d row = lever.row(pair);
        sum += edge * pair.weight * row * row.transpose();
    }
    return sum;
}

double sq(double value) noexcept {
    return value * value;
}

}  // namespace

Vector6d Lever::row(const Pair& pair) const {
    Vector6d j;
    j << pair.normal, (pair.at_m - pivot_m).cross(pair.normal) / length_m;
    return j;
}

void Normals6::add(const Pair& pair, const Lever& lever) {
    const Vector6d j = lever.row(pair);
    left += pair.weight * j * j.transpose();
    right -= pair.weight * pair.across_m * j;
    sq_across_m2 += pair.across_m * pair.across_m;
    sq_apart_m2 += pair.sq_apart_m2;
    ++pairs;
}

void Normals6::add(const Normals6& other) {
    left += other.left;
    right += other.right;
    sq_across_m2 += other.sq_across_m2;
    sq_apart_m2 += other.sq_apart_m2;
    pairs += other.pairs;
}

Normals6 sum_up(std::span<const Pair> pairs, const Lever& lever, Executor& executor) {
    std::vector<Normals6> parts(pieces_of(pairs.size(), kAlignmentPiece));
    in_pieces(
        pairs.size(), kAlignmentPiece, executor, [&](auto begin, auto end, std::size_t piece) {
            for (std::size_t i = begin; i < end; ++i) {
                if (pairs[i].counts) parts[piece].add(pairs[i], lever);
            }
        });
    Normals6 all;
    for (const Normals6& part : parts) all.add(part);
    return all;
}

AlignmentSolution solve(const Normals6& surface, const Normals6& border) {
    // Normals of noisy points are off by some degrees: what they seem to hold of a direction along
    // the surface is the square of that. A wall across it holds as much with one point in 200.
    constexpr double kHeld = 5e-3;
    constexpr double kHeldByBorders = 5e-2;
    constexpr std::int64_t kFewestBorders = 30;
    AlignmentSolution solution;
    const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(surface.left);
    int along = 0;  // eigenvalues ascend
    for (int i = 0; i < 6; ++i) {
        const double value = eigen.eigenvalues()[i];
        if (!(value > kHeld * static_cast<double>(surface.pairs))) {
            ++along;
            continue;
        }
        const Vector6d v = eigen.eigenvectors().col(i);
        solution.surface_gain += v * v.transpose() / value;
    }
    solution.x = solution.surface_gain * surface.right;
    solution.free_directions = along;
    if (along == 0 || border.pairs < kFewestBorders) return solution;
    const Eigen::MatrixXd rest = eigen.eigenvectors().leftCols(along);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> inner(rest.transpose() * border.left *
                                                               rest);
    for (int i = 0; i < along; ++i) {
        const double value = inner.eigenvalues()[i];
        if (!(value > kHeldByBorders * static_cast<double>(border.pairs))) continue;
        const Vector6d v = rest * inner.eigenvectors().col(i);
        solution.border_gain += v * v.transpose() / value;
        ++solution.border_directions;
        --solution.free_directions;
    }
    solution.x += solution.border_gain * (border.right - border.left * solution.x);
    return solution;
}

Sampling sampling_of(const KdTree& cloud) {
    constexpr std::size_t kAsked = 2000;
    constexpr std::size_t kNeighbours = 31;
    const auto points_m = cloud.points_m();
    const std::size_t asked = std::min(points_m.size(), kAsked);
    std::vector<double> ratios;
    std::vector<double> balls_m;
    std::vector<Neighbour> near(kNeighbours);
    for (std::size_t i = 0; i < asked; ++i) {
        const Eigen::Vector3f& p_m = points_m[i * points_m.size() / asked];
        const std::size_t count = cloud.nearest(p_m, near);
        balls_m.push_back(std::sqrt(static_cast<double>(near[count - 1].sq_distance_m2)));
        std::vector<std::size_t> places;  // the two nearest other places: copies are one place
        for (std::size_t k = 1; k < count && places.size() < 2; ++k) {
            const Eigen::Vector3f& other_m = points_m[near[k].index];
            const bool copy =
                other_m == p_m || (!places.empty() && points_m[near[places[0]].index] == other_m);
            if (!copy) places.push_back(k);
        }
        if (places.size() < 2) continue;
        ratios.push_back(std::sqrt(static_cast<double>(near[places[0]].sq_distance_m2) /
                                   static_cast<double>(near[places[1]].sq_distance_m2)));
    }
    // At random the ratio's median is 0.71 on a surface; on a lattice 1, less its noise.
    constexpr double kRandom = 0.75;
    constexpr double kLattice = 0.95;
    const double ratio = median_of(std::move(ratios));
    return {median_of(std::move(balls_m)) * std::sqrt(M_PI / static_cast<double>(kNeighbours)),
            std::clamp((ratio - kRandom) / (kLattice - kRandom), 0.0, 1.0)};
}

AlignmentSigma alignment_sigma(std::span<const Pair> surface,
                               std::span<const Pair> border,
                               const Lever& lever,
                               const AlignmentSolution& solution,
                               const Sampling& reference,
                               const Sampling& moved) {
    const double lattice_m2 =
        (reference.regularity * sq(reference.spacing_m) + moved.regularity * sq(moved.spacing_m)) /
        12.0;
    const Matrix6d& gain = solution.surface_gain;
    const Matrix6d shifted =
        gain * edges_of(surface, lever, std::max(reference.spacing_m, moved.spacing_m));
    Matrix6d covariance =
        gain * scatter_of(surface, lever, gain) * gain + lattice_m2 * shifted * shifted.transpose();
    if (solution.border_directions > 0) {
        Matrix6d left = Matrix6d::Zero();
        for (const Pair& pair : border) {
            if (!pair.counts) continue;
            const Vector6d row = lever.row(pair);
            left += pair.weight * row * row.transpose();
        }
        constexpr double kEnds = 0.05;  // one sigma of at most a tenth
        const double ends_m =
            kEnds * median_over(border, [](const Pair& pair) { return pair.ball_m; });
        const Matrix6d& border_gain = solution.border_gain;
        const Matrix6d rest = Matrix6d::Identity() - border_gain * left;
        const Matrix6d drawn = border_gain * left;
        covariance = rest * covariance * rest.transpose() +
                     border_gain * scatter_of(border, lever, border_gain) * border_gain +
                     (lattice_m2 + sq(ends_m)) * drawn * drawn.transpose();
    }
    return {
        std::sqrt(std::max(covariance.topLeftCorner<3, 3>().trace(), 0.0)),
        std::sqrt(std::max(covariance.bottomRightCorner<3, 3>().trace(), 0.0)) / lever.length_m};
}

}  // namespace surefoot::geometry
