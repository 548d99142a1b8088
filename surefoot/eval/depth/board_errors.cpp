// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/depth/board_errors.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "surefoot/geometry/statistics.hpp"

namespace surefoot::eval {
namespace {

constexpr std::size_t kMinPoints = 100;
constexpr int kRounds = 3;
constexpr double kGate_sigma = 4.0;
constexpr double kSigmaPerMad = 1.4826;  ///< sigma / MAD of a normal distribution

Eigen::Vector3d direction_of(const Eigen::Vector3d& p_m) {
    return {p_m.x() / p_m.z(), p_m.y() / p_m.z(), 1.0};
}

std::optional<Eigen::Vector3d> solve(std::span<const Eigen::Vector3d> points_m,
                                     const std::vector<double>& residuals,
                                     double gate) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < points_m.size(); ++i) {
        if (std::abs(residuals[i]) > gate) continue;
        const Eigen::Vector3d a = direction_of(points_m[i]);
        normal += a * a.transpose();
        right += a / points_m[i].z();
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    const Eigen::Vector3d pivots = solver.vectorD();
    constexpr double kMinRatio = 1e-10;  // collinear points: a pivot is a rounding error
    if (!(pivots.minCoeff() > kMinRatio * pivots.maxCoeff())) return std::nullopt;
    return Eigen::Vector3d(solver.solve(right));
}

double median_abs(std::vector<double> values) {
    for (double& value : values) value = std::abs(value);
    return upper_median_in_place(values);
}

}  // namespace

std::optional<BoardPlane> fit_board(std::span<const Eigen::Vector3d> points_m) {
    if (points_m.size() < kMinPoints) return std::nullopt;
    std::vector<double> residuals(points_m.size(), 0.0);
    double gate = std::numeric_limits<double>::infinity();
    BoardPlane plane;
    for (int round = 0; round < kRounds; ++round) {
        const auto solved = solve(points_m, residuals, gate);
        if (!solved) return std::nullopt;
        plane.inverse_depth_1_m = *solved;
        for (std::size_t i = 0; i < points_m.size(); ++i) {
            residuals[i] =
                1.0 / points_m[i].z() - plane.inverse_depth_1_m.dot(direction_of(points_m[i]));
        }
        // Points exactly on a plane leave only rounding errors. The least gate keeps these points.
        gate = std::max(kGate_sigma * kSigmaPerMad * median_abs(residuals), 1e-12);
    }
    if (!(plane.inverse_depth_1_m.z() > 0.0)) return std::nullopt;
    return plane;
}

std::optional<BoardErrors> board_errors(std::span<const Eigen::Vector3d> points_m,
                                        double distance_m) {
    const auto plane = fit_board(points_m);
    if (!plane) return std::nullopt;
    double sum_m2 = 0.0;
    for (const Eigen::Vector3d& p_m : points_m) {
        const double off_m = p_m.z() - plane->depth_m(p_m.x() / p_m.z(), p_m.y() / p_m.z());
        sum_m2 += off_m * off_m;
    }
    BoardErrors errors;
    errors.axial_m = plane->distance_m() - distance_m;
    errors.std_m = std::sqrt(sum_m2 / static_cast<double>(points_m.size()));
    errors.scale_share = errors.axial_m / distance_m;
    errors.points = static_cast<std::int64_t>(points_m.size());
    return errors;
}

BoardErrors mean_of(std::span<const BoardErrors> looks) {
    BoardErrors mean;
    if (looks.empty()) return mean;
    const auto count = static_cast<double>(looks.size());
    double variance_m2 = 0.0;
    for (const BoardErrors& look : looks) {
        mean.axial_m += look.axial_m / count;
        mean.scale_share += look.scale_share / count;
        variance_m2 += look.std_m * look.std_m / count;
        mean.points += look.points;
    }
    mean.std_m = std::sqrt(variance_m2);
    return mean;
}

}  // namespace surefoot::eval
