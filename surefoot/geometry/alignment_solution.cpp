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

constexpr std::array kKinds{HeldBy::surfaces, HeldBy::edges, HeldBy::borders};

/// Groups pairs into cubes of space, to find errors that neighbouring pairs share.
class Blocks {
  public:
    explicit Blocks(double edge_m) : edge_m_(edge_m) {}

    void add(const Pair& pair, const Vector6d& gradient) {
        std::array<double, 3> cube{};  // whole numbers
        for (std::size_t i = 0; i < 3; ++i)
            cube[i] = std::floor(pair.at_m[static_cast<Eigen::Index>(i)] / edge_m_);
        sums_.try_emplace(cube, Vector6d::Zero()).first->second += gradient;
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

/// Covariance of `Normals6::right` for one kind of evidence, from the scatter of its pairs.
Matrix6d scatter_of(HeldBy kind,
                    std::span<const Pair> pairs,
                    const Lever& lever,
                    const Matrix6d& gain) {
    const double ball_m = median_over(pairs, &Pair::ball_m);
    if (!(ball_m > 0.0)) return Matrix6d::Zero();
    Blocks blocks(2.0 * ball_m);
    Matrix6d alone = Matrix6d::Zero();
    double count = 0.0;
    for (const Pair& pair : pairs) {
        const double weight = weight_as(kind, pair);
        if (weight == 0.0) continue;
        const Vector6d gradient = weight * pair.across_m * lever.row(pair);
        alone += gradient * gradient.transpose();
        blocks.add(pair, gradient);
        count += 1.0;
    }
    // The fit of six unknowns has reduced the scatter.
    constexpr double kUnknowns = 6.0;
    alone *= count / std::max(count - kUnknowns, 1.0);
    const Matrix6d together =
        blocks.squares() * (blocks.count() / std::max(blocks.count() - kUnknowns, 1.0));
    const double expected = (gain * alone).trace();
    const double shared = expected > 0.0 ? (gain * together).trace() / expected : 1.0;
    return std::max(shared, 1.0) * alone;
}

/// Variance of each direction that edges or borders fix. It does not fall with the number of pairs.
double systematic_var_m2(HeldBy kind, std::span<const Pair> pairs, double cell_var_m2) {
    if (kind == HeldBy::edges) return cell_var_m2;
    constexpr double kEnds = 0.05;  // one sigma of an error of at most 0.1 ball radii
    const double ends_m = kEnds * median_over(pairs, &Pair::ball_m);
    return cell_var_m2 + ends_m * ends_m;
}

}  // namespace

double weight_as(HeldBy kind, const Pair& pair) noexcept {
    if (!pair.counts) return 0.0;
    switch (kind) {
        case HeldBy::surfaces: return pair.edge == 0.0 ? pair.weight : 0.0;
        case HeldBy::edges: return pair.weight * pair.edge;
        case HeldBy::borders: return pair.weight;
    }
    return 0.0;
}

Vector6d Lever::row(const Pair& pair) const {
    Vector6d j;
    j << pair.normal, (pair.at_m - pivot_m).cross(pair.normal) / length_m;
    return j;
}

void Normals6::add(HeldBy kind, const Pair& pair, const Lever& lever) {
    if (!pair.counts) return;
    sq_across_m2 += pair.across_m * pair.across_m;
    sq_apart_m2 += pair.sq_apart_m2;
    ++pairs;
    const double weight = weight_as(kind, pair);
    if (weight == 0.0) return;
    const Vector6d j = lever.row(pair);
    left += weight * j * j.transpose();
    right -= weight * pair.across_m * j;
}

void Normals6::add(const Normals6& other) {
    left += other.left;
    right += other.right;
    sq_across_m2 += other.sq_across_m2;
    sq_apart_m2 += other.sq_apart_m2;
    pairs += other.pairs;
}

Normals6 sum_up(HeldBy kind, std::span<const Pair> pairs, const Lever& lever, Executor& executor) {
    std::vector<Normals6> parts(pieces_of(pairs.size(), kAlignmentPiece));
    in_pieces(
        pairs.size(), kAlignmentPiece, executor, [&](auto begin, auto end, std::size_t piece) {
            for (std::size_t i = begin; i < end; ++i) parts[piece].add(kind, pairs[i], lever);
        });
    Normals6 all;
    for (const Normals6& part : parts) all.add(part);
    return all;
}

AlignmentSolution solve(const std::array<Normals6, kHolds>& sums) {
    // Normals of noisy points are wrong by some degrees. So a surface seems to fix a direction
    // along itself, with a share that is the square of this error [rad]. So the limit for surfaces
    // and edges is 5e-3: a wall across that direction fixes it if it has one point in 200.
    constexpr std::array kLeastShare{5e-3, 5e-3, 5e-2};
    constexpr std::array<std::int64_t, kHolds> kFewest{0, 0, 30};
    AlignmentSolution solution;
    Eigen::MatrixXd rest = Matrix6d::Identity();  // columns: directions that are still free
    for (std::size_t kind = 0; kind < kHolds && rest.cols() > 0; ++kind) {
        const Normals6& sum = sums[kind];
        if (sum.pairs < kFewest[kind]) continue;
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(rest.transpose() * sum.left *
                                                                   rest);
        Eigen::Index left_free = 0;  // eigenvalues ascend
        for (Eigen::Index i = 0; i < rest.cols(); ++i) {
            const double value = eigen.eigenvalues()[i];
            if (!(value > kLeastShare[kind] * static_cast<double>(sum.pairs))) {
                ++left_free;
                continue;
            }
            const Vector6d v = rest * eigen.eigenvectors().col(i);
            solution.gain[kind] += v * v.transpose() / value;
            ++solution.directions[kind];
        }
        solution.x += solution.gain[kind] * (sum.right - sum.left * solution.x);
        rest = (rest * eigen.eigenvectors().leftCols(left_free)).eval();
    }
    solution.free_directions = static_cast<int>(rest.cols());
    return solution;
}

AlignmentSigma alignment_sigma(std::span<const Pair> surface,
                               std::span<const Pair> border,
                               const Lever& lever,
                               const AlignmentSolution& solution,
                               double cell_var_m2) {
    constexpr double kWeakShare = 0.02;
    Matrix6d covariance = Matrix6d::Zero();
    for (const HeldBy kind : kKinds) {
        const auto number = static_cast<std::size_t>(kind);
        if (solution.directions[number] == 0) continue;
        const std::span<const Pair> pairs = kind == HeldBy::borders ? border : surface;
        const Matrix6d& gain = solution.gain[number];
        Matrix6d left = Matrix6d::Zero();
        double pair_weight = 0.0;
        for (const Pair& pair : pairs) {
            const double weight = weight_as(kind, pair);
            if (weight == 0.0) continue;
            pair_weight += weight;
            const Vector6d row = lever.row(pair);
            left += weight * row * row.transpose();
        }
        const Matrix6d rest = Matrix6d::Identity() - gain * left;
        // Projects onto the directions that this kind fixes: the eigenvectors of its gain.
        const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(gain);
        Matrix6d held = Matrix6d::Zero();
        double var_m2 = systematic_var_m2(kind, pairs, cell_var_m2);
        for (int i = 6 - solution.directions[number]; i < 6; ++i) {
            // A few pairs that alone fix a direction may lie at undetected edges.
            const bool weak = kWeakShare * pair_weight * eigen.eigenvalues()[i] > 1.0;
            if (kind == HeldBy::surfaces) var_m2 = weak ? cell_var_m2 : 0.0;
            held += var_m2 * eigen.eigenvectors().col(i) * eigen.eigenvectors().col(i).transpose();
        }
        covariance = rest * covariance * rest.transpose() +
                     gain * scatter_of(kind, pairs, lever, gain) * gain + held;
    }
    return {
        std::sqrt(std::max(covariance.topLeftCorner<3, 3>().trace(), 0.0)),
        std::sqrt(std::max(covariance.bottomRightCorner<3, 3>().trace(), 0.0)) / lever.length_m};
}

}  // namespace surefoot::geometry
